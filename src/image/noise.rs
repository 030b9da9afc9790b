//! How much of what a frame shows is its camera's noise.

use super::Frame;

/// Places that are looked at, across and down.
const ACROSS: i32 = 24;
const DOWN: i32 = 18;
/// Luma that a sensor neither lost in the dark nor clipped.
const MEASURED: core::ops::Range<u8> = 8..248;
/// Median of [`Frame::roughness`] where a frame is nothing but noise of deviation 1: 6 times that of a
/// normal distribution's absolute values.
const MEDIAN: f32 = 6.0 * 0.6745;
/// Fewest places that say anything.
const FEWEST: u32 = 64;

/// The noise's deviation over that of the luma as a whole, over a few hundred places of the frame; 0 where
/// there is nothing to tell it by. What a picture shows is mostly smooth from a pixel to the next, noise
/// is not (Immerkær, "Fast Noise Variance Estimation", 1996); of its measure the median is taken, which
/// edges do not move.
pub fn noise_share(frame: &Frame<'_>) -> f32 {
    let mut counts = [0u16; 256];
    let (mut number, mut sum, mut squares) = (0u32, 0u32, 0u32);
    for k in 0..ACROSS * DOWN {
        let (column, row) = (k % ACROSS, k / ACROSS);
        let x = (2 * column + 1) * frame.width() / (2 * ACROSS);
        let y = (2 * row + 1) * frame.height() / (2 * DOWN);
        let luma = frame.luma(x, y);
        if !MEASURED.contains(&luma) {
            continue;
        }
        number += 1;
        sum += u32::from(luma);
        squares += u32::from(luma) * u32::from(luma);
        let rough = frame.roughness(x, y).min(255) as usize;
        if let Some(count) = counts.get_mut(rough) {
            *count += 1;
        }
    }
    if number < FEWEST {
        return 0.0;
    }
    let mut below = 0;
    let median = counts.iter().position(|count| {
        below += u32::from(*count);
        2 * below >= number
    });
    let mean = sum as f32 / number as f32;
    let variance = squares as f32 / number as f32 - mean * mean;
    let deviation = libm::sqrtf(variance.max(1.0));
    median.unwrap_or(0) as f32 / MEDIAN / deviation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::FrameLayout;

    const SIDE: usize = 96;

    /// Slopes and edges, and noise of a deviation, uniform from a hash of the place.
    fn picture(deviation: f32) -> [u8; SIDE * SIDE] {
        core::array::from_fn(|k| {
            let (x, y) = (k % SIDE, k / SIDE);
            let shown = 60.0 + x as f32 + if y / 24 % 2 == 0 { 40.0 } else { 0.0 };
            let mut hash = (k as u32).wrapping_mul(0x9e37_79b9);
            hash ^= hash >> 15;
            hash = hash.wrapping_mul(0x85eb_ca6b);
            hash ^= hash >> 13;
            let uniform = (hash & 0xffff) as f32 / 65_535.0 - 0.5;
            (shown + 3.46 * deviation * uniform) as u8
        })
    }

    #[test]
    fn noise_is_told_from_what_is_shown() {
        let share = |deviation| {
            let bytes = picture(deviation);
            let layout = FrameLayout::grey(SIDE as u32, SIDE as u32);
            noise_share(&Frame::new(&layout, &bytes).unwrap())
        };
        // The picture's own deviation is about 34.
        assert!(share(0.0) < 0.02, "{}", share(0.0));
        assert!((0.1..0.2).contains(&share(5.0)), "{}", share(5.0));
        assert!((0.4..0.6).contains(&share(20.0)), "{}", share(20.0));
    }

    #[test]
    fn what_is_clipped_says_nothing() {
        let bytes = [255; SIDE * SIDE];
        let layout = FrameLayout::grey(SIDE as u32, SIDE as u32);
        assert_eq!(noise_share(&Frame::new(&layout, &bytes).unwrap()), 0.0);
        let one = Frame::new(&FrameLayout::grey(1, 1), &[100]).unwrap();
        assert_eq!(noise_share(&one), 0.0);
    }
}
