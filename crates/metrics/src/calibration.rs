//! How far probabilities agree with frequencies.

/// Bins of [`calibration_error`].
const BINS: usize = 10;

/// Expected calibration error: the mean over ten equal bins of the probability, weighted by the
/// number of pairs in each, of |mean probability − share of truths|. `None` of none.
pub fn calibration_error(pairs: &[(f64, bool)]) -> Option<f64> {
    let mut bins = [0.0; BINS];
    for (p, truth) in pairs {
        let bin = ((p * BINS as f64) as usize).min(BINS - 1);
        bins[bin] += p - f64::from(*truth);
    }
    let sum: f64 = bins.iter().map(|b| b.abs()).sum();
    (!pairs.is_empty()).then(|| sum / pairs.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calibration_by_hand() {
        assert_eq!(calibration_error(&[]), None);
        let even = [(0.25, false), (0.25, false), (0.25, false), (0.25, true)];
        assert_eq!(calibration_error(&even), Some(0.0));
        // Two bins: 0.9 − 0.5 over two pairs, 0.1 − 0 over one.
        let off = [(0.9, true), (0.9, false), (0.1, false)];
        assert!((calibration_error(&off).unwrap() - (2.0 * 0.4 + 0.1) / 3.0).abs() < 1e-12);
    }
}
