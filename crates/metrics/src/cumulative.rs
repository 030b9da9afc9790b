//! The cumulative error distribution (CED): the share of pictures whose error is at most e.

/// Area under the CED from 0 to `limit`, over `limit`: 1 when every error is 0. Pictures without an
/// error (no face found) are in `pictures` only and count as an infinite error.
pub fn area_under_ced(errors: &[f64], pictures: usize, limit: f64) -> f64 {
    // ∫ CED from 0 to τ over τ is the mean of max(0, 1 − e/τ).
    let sum: f64 = errors.iter().map(|e| (1.0 - e / limit).max(0.0)).sum();
    sum.max(0.0) / pictures.max(1) as f64
}

/// Corners of the CED from 0 to `limit`: error and share of pictures. Pictures without an error
/// count as an infinite one.
pub fn ced(errors: &[f64], pictures: usize, limit: f64) -> Vec<(f64, f64)> {
    let mut sorted: Vec<f64> = errors.iter().copied().filter(|e| *e <= limit).collect();
    sorted.sort_by(f64::total_cmp);
    let share = |count: usize| count as f64 / pictures.max(1) as f64;
    let mut corners = vec![(0.0, 0.0)];
    for (count, error) in sorted.iter().enumerate() {
        corners.extend([(*error, share(count)), (*error, share(count + 1))]);
    }
    corners.push((limit, share(sorted.len())));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_by_hand() {
        let curve = ced(&[0.04, 0.02, 0.12], 4, 0.08);
        let corners = [
            (0.0, 0.0),
            (0.02, 0.0),
            (0.02, 0.25),
            (0.04, 0.25),
            (0.04, 0.5),
        ];
        assert_eq!(curve[..5], corners);
        assert_eq!(curve[5..], [(0.08, 0.5)]);
    }

    #[test]
    fn area_by_hand() {
        // (0.75 + 0.5 + 0 + 0) / 4
        let area = area_under_ced(&[0.02, 0.04, 0.12], 4, 0.08);
        assert!((area - 0.3125).abs() < 1e-12);
        assert_eq!(area_under_ced(&[], 0, 0.08), 0.0);
    }
}
