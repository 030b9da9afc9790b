//! Quantiles of a histogram.

/// Where the quantile of a share of the time in the bins lies, in bins from the start of the first
/// one, linear within its bin; `None` for empty bins. One function for all histograms, because code
/// is to stay small.
#[inline(never)]
pub(super) fn quantile(bins: &[u32], share: f32) -> Option<f32> {
    let total: u32 = bins.iter().sum();
    let wanted = share * total as f32;
    let mut sum = 0;
    for (bin, time_us) in bins.iter().enumerate() {
        let before = sum as f32;
        sum += time_us;
        if *time_us > 0 && sum as f32 >= wanted {
            return Some(bin as f32 + (wanted - before) / *time_us as f32);
        }
    }
    None
}

/// Adds a time to the bin at this place, or to the last one.
pub(super) fn add(bins: &mut [u32], at: f32, time_us: u32) {
    // Not below 0: the conversion of a negative number gives 0.
    let bin = (at as usize).min(bins.len().saturating_sub(1));
    if let Some(sum) = bins.get_mut(bin) {
        *sum += time_us;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_by_hand() {
        let mut bins = [0; 4];
        assert_eq!(quantile(&bins, 0.5), None);
        add(&mut bins, 1.5, 10);
        add(&mut bins, 9.0, 10);
        add(&mut bins, -3.0, 20);
        assert_eq!(bins, [20, 10, 0, 10]);
        assert_eq!(quantile(&bins, 0.5), Some(1.0));
        assert_eq!(quantile(&bins, 0.75), Some(2.0));
        assert_eq!(quantile(&bins, 1.0), Some(4.0));
    }
}
