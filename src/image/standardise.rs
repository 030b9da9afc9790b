//! Standardised luma: what networks see of a crop.

use super::Crop;
use crate::math::isqrt;

/// Added to the standard deviation of a crop before the division by it \[grey levels\]: limits the
/// amplification of noise in flat crops.
const DEVIATION_OFFSET: i64 = 8;
/// Units per standard deviation, around 128.
const SCALE: i64 = 32;

impl Crop {
    /// Moves and stretches the luma to a mean of 128 and a standard deviation of about 32, in
    /// integers.
    pub fn standardise(&mut self) {
        let luma = self.luma_mut();
        let n = luma.len().max(1) as i64;
        // The squares of 128² bytes add up to less than 2³².
        let sum = i64::from(luma.iter().map(|v| u32::from(*v)).sum::<u32>());
        let squares = luma.iter().map(|v| u32::from(*v) * u32::from(*v));
        let squares = i64::from(squares.fold(0, u32::wrapping_add));
        // Mean and variance in units of 1/256; the deviation is in units of 1/16.
        let mean = (sum * 256 + n / 2) / n;
        let variance = ((squares * n - sum * sum) * 256 / (n * n)).max(0);
        let deviation = isqrt(variance as u32) as i64 + 16 * DEVIATION_OFFSET;
        // (v − mean)·32/deviation, with 28 bits of fraction below.
        let gain = (SCALE << 20) * 16 / deviation.max(1);
        let mut table = [0u8; 256];
        for (v, out) in table.iter_mut().enumerate() {
            let value = (((v as i64 * 256 - mean) * gain + (1 << 27)) >> 28) + 128;
            *out = value.clamp(0, 255) as u8;
        }
        let look_up = |v: &mut u8| *v = table.get(usize::from(*v)).copied().unwrap_or(0);
        let (by_eight, last) = luma.as_chunks_mut::<8>();
        for luma in by_eight {
            luma.iter_mut().for_each(look_up);
        }
        last.iter_mut().for_each(look_up);
    }
}
