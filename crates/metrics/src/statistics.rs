//! Mean, median and correlation of plain numbers.

/// Mean of the values; `None` of none.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Median of the values (mean of the middle two when even); `None` of none.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let middle = sorted.get((n.max(1) - 1) / 2..n / 2 + 1)?;
    mean(middle)
}

/// Pairs less their means.
pub fn centred(pairs: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> {
    let n = pairs.len().max(1) as f64;
    let (x, y) = pairs
        .iter()
        .fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    pairs.iter().map(move |p| (p.0 - x, p.1 - y))
}

/// Pearson's correlation coefficient; `None` when either side does not vary.
pub fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in centred(pairs) {
        xy += x * y;
        xx += x * x;
        yy += y * y;
    }
    (xx > 1e-12 && yy > 1e-12).then(|| xy / (xx * yy).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_medians() {
        assert_eq!(mean(&[]), None);
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[3.0, 1.0]), Some(2.0));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
    }

    #[test]
    fn correlation_of_a_line_is_one() {
        let line = (0..9).map(|k| (f64::from(k), 3.0 * f64::from(k) - 1.0));
        let line: Vec<(f64, f64)> = line.collect();
        assert!((correlation(&line).expect("it varies") - 1.0).abs() < 1e-12);
        assert_eq!(correlation(&[(1.0, 2.0), (1.0, 3.0)]), None);
    }
}
