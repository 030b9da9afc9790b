//! Area under the receiver operating characteristic.

/// How often a true value is larger than a false one; equal values count half. `None` when there
/// are only true or only false values.
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
    fn areas_by_hand() {
        let pairs = [(0.1, false), (0.4, true), (0.4, false), (0.9, true)];
        assert_eq!(auc(&pairs), Some((1.5 + 2.0) / 4.0));
        assert_eq!(auc(&[(0.3, true)]), None);
        assert_eq!(auc(&[(0.1, false), (0.2, true), (0.3, true)]), Some(1.0));
        assert_eq!(auc(&[(0.5, false), (0.5, true)]), Some(0.5));
    }
}
