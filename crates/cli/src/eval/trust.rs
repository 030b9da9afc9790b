//! How far probabilities can be believed.

/// Bins of [`calibration_error`].
const BINS: usize = 10;

/// Expected calibration error: mean over ten equal bins of the probability, weighted by how many
/// fall there, of the distance between mean probability and share of truths. `None` of none.
pub fn calibration_error(pairs: &[(f64, bool)]) -> Option<f64> {
    let mut bins = [0.0; BINS];
    for (p, truth) in pairs {
        let bin = ((p * BINS as f64) as usize).min(BINS - 1);
        bins[bin] += p - f64::from(*truth);
    }
    let sum: f64 = bins.iter().map(|b| b.abs()).sum();
    (!pairs.is_empty()).then(|| sum / pairs.len() as f64)
}

/// Area under the receiver operating characteristic: how often a true one has the larger value;
/// equal values count half. `None` when one kind is missing.
pub fn auc(pairs: &[(f64, bool)]) -> Option<f64> {
    let mut sorted: Vec<&(f64, bool)> = pairs.iter().collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut below, mut sum) = (0.0, 0.0);
    for equal in sorted.chunk_by(|a, b| a.0 == b.0) {
        let truths = equal.iter().filter(|p| p.1).count() as f64;
        let others = equal.len() as f64 - truths;
        sum += truths * (below + others / 2.0);
        below += others;
    }
    let truths = pairs.len() as f64 - below;
    (truths > 0.0 && below > 0.0).then(|| sum / truths / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calibration_by_hand() {
        assert_eq!(calibration_error(&[]), None);
        let even = [(0.25, false), (0.25, false), (0.25, false), (0.25, true)];
        assert_eq!(calibration_error(&even), Some(0.0));
        // Two bins: 0.9 − 0.5 over two, 0.1 − 0 over one.
        let off = [(0.9, true), (0.9, false), (0.1, false)];
        assert!((calibration_error(&off).unwrap() - (2.0 * 0.4 + 0.1) / 3.0).abs() < 1e-12);
    }

    #[test]
    fn auc_by_hand() {
        let pairs = [(0.1, false), (0.4, true), (0.4, false), (0.9, true)];
        assert_eq!(auc(&pairs), Some((1.5 + 2.0) / 4.0));
        assert_eq!(auc(&[(0.3, true)]), None);
    }
}
