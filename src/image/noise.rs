//! The share of camera noise in a frame's luma.

use super::Frame;

/// Number of sampled pixels across the frame.
const COLUMNS: i32 = 24;
/// Number of sampled pixels down the frame.
const ROWS: i32 = 18;
/// Luma outside this range is not sampled: dark pixels lose their noise, bright ones are clipped.
const SAMPLED_LUMA: core::ops::Range<u8> = 8..248;
/// Median of [`Frame::noise_response`] under Gaussian noise of deviation 1: the filter's gain, 6,
/// times the median of a standard normal variable's absolute value.
const UNIT_NOISE_MEDIAN: f32 = 6.0 * 0.6745;
/// Fewest samples that give an estimate.
const SAMPLES_MIN: u32 = 64;

/// Ratio of the deviation of the noise to the deviation of the luma, estimated at up to 432 pixels
/// of the frame; 0 where fewer than 64 of them are neither dark nor clipped.
///
/// The filter is that of Immerkær, "Fast Noise Variance Estimation", 1996, which responds to noise
/// and hardly to smooth content. The median replaces the paper's mean: edges do not move it.
pub fn noise_share(frame: &Frame<'_>) -> f32 {
    let mut histogram = [0u16; 256];
    let (mut samples, mut sum, mut squares) = (0u32, 0u32, 0u32);
    for k in 0..COLUMNS * ROWS {
        let (column, row) = (k % COLUMNS, k / COLUMNS);
        let x = (2 * column + 1) * frame.width() / (2 * COLUMNS);
        let y = (2 * row + 1) * frame.height() / (2 * ROWS);
        let luma = frame.luma(x, y);
        if !SAMPLED_LUMA.contains(&luma) {
            continue;
        }
        samples += 1;
        sum += u32::from(luma);
        squares += u32::from(luma) * u32::from(luma);
        let response = frame.noise_response(x, y).min(255) as usize;
        if let Some(count) = histogram.get_mut(response) {
            *count += 1;
        }
    }
    if samples < SAMPLES_MIN {
        return 0.0;
    }
    let mut below = 0;
    let median = histogram.iter().position(|count| {
        below += u32::from(*count);
        2 * below >= samples
    });
    let mean = sum as f32 / samples as f32;
    let variance = squares as f32 / samples as f32 - mean * mean;
    let deviation = libm::sqrtf(variance.max(1.0));
    median.unwrap_or(0) as f32 / UNIT_NOISE_MEDIAN / deviation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::FrameLayout;

    const SIDE: usize = 96;

    /// Slopes and edges, plus uniform noise of this deviation from a hash of the pixel's index.
    fn image(deviation: f32) -> [u8; SIDE * SIDE] {
        core::array::from_fn(|k| {
            let (x, y) = (k % SIDE, k / SIDE);
            let content = 60.0 + x as f32 + if y / 24 % 2 == 0 { 40.0 } else { 0.0 };
            let mut hash = (k as u32).wrapping_mul(0x9e37_79b9);
            hash ^= hash >> 15;
            hash = hash.wrapping_mul(0x85eb_ca6b);
            hash ^= hash >> 13;
            let uniform = (hash & 0xffff) as f32 / 65_535.0 - 0.5;
            (content + 3.46 * deviation * uniform) as u8
        })
    }

    #[test]
    fn noise_is_separated_from_content() {
        let share = |deviation| {
            let bytes = image(deviation);
            let layout = FrameLayout::grey(SIDE as u32, SIDE as u32);
            noise_share(&Frame::new(&layout, &bytes).unwrap())
        };
        // The deviation of the luma without noise is about 34.
        assert!(share(0.0) < 0.02, "{}", share(0.0));
        assert!((0.1..0.2).contains(&share(5.0)), "{}", share(5.0));
        assert!((0.4..0.6).contains(&share(20.0)), "{}", share(20.0));
    }

    #[test]
    fn clipped_luma_gives_no_estimate() {
        let bytes = [255; SIDE * SIDE];
        let layout = FrameLayout::grey(SIDE as u32, SIDE as u32);
        assert_eq!(noise_share(&Frame::new(&layout, &bytes).unwrap()), 0.0);
        let one = Frame::new(&FrameLayout::grey(1, 1), &[100]).unwrap();
        assert_eq!(noise_share(&one), 0.0);
    }
}
