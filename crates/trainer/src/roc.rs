//! Areas under the receiver operating characteristic.

/// Area under the ROC of (score, label): how often a true one scores higher than a false one.
pub fn area(mut pairs: Vec<(f32, bool)>) -> f64 {
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let positives = pairs.iter().filter(|p| p.1).count() as f64;
    let negatives = pairs.len() as f64 - positives;
    let (mut sum, mut below) = (0.0, 0.0);
    for equal in pairs.chunk_by(|a, b| a.0 == b.0) {
        let up = equal.iter().filter(|p| p.1).count() as f64;
        let down = equal.len() as f64 - up;
        sum += up * (below + down / 2.0);
        below += down;
    }
    sum / (positives * negatives).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_by_hand() {
        assert_eq!(area(vec![(0.1, false), (0.2, true), (0.3, true)]), 1.0);
        assert_eq!(area(vec![(0.5, false), (0.5, true)]), 0.5);
        assert_eq!(
            area(vec![(0.4, true), (0.2, false), (0.3, true), (0.35, false)]),
            0.75
        );
    }
}
