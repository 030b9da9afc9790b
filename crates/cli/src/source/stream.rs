//! What every source of frames offers.

use anyhow::Result;

use crate::picture::Picture;

/// A stream of pictures with increasing timestamps.
pub trait Source {
    /// The next picture, `None` at the end.
    fn next(&mut self) -> Result<Option<Picture>>;

    /// Frames per second; of a camera, the nominal value.
    fn fps(&self) -> f64;

    /// Frames to come in all, where that is known beforehand.
    fn total(&self) -> Option<u64> {
        None
    }

    /// Whether frames come as they happen, so that output must not be held back.
    fn is_live(&self) -> bool {
        false
    }

    /// Something that went wrong without ending the stream, once it has ended.
    fn warning(&self) -> Option<String> {
        None
    }
}

/// Time of frame `index` at `num / den` frames per second \[µs\].
pub fn timestamp_us(index: u64, num: u64, den: u64) -> i64 {
    (u128::from(index) * 1_000_000 * u128::from(den) / u128::from(num.max(1))) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timestamps_follow_the_rate() {
        assert_eq!(timestamp_us(0, 30, 1), 0);
        assert_eq!(timestamp_us(1, 30, 1), 33_333);
        assert_eq!(timestamp_us(30, 30, 1), 1_000_000);
        assert_eq!(timestamp_us(30_000, 30_000, 1001), 1_001_000_000);
    }
}
