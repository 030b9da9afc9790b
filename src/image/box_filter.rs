//! The box filter of a crop, which stands for that of the frame.

use super::crop::{CROP_MAX, Crop};

/// Largest half width of the box filter in the crop \[crop px\].
pub(super) const RADIUS_MAX: usize = 3;

/// Box filter of `2·radius + 1` crop pixels along each axis; the edge pixels repeat.
pub(super) fn box_filter(crop: &mut Crop, radius: usize) {
    let side = crop.side();
    let width = 2 * radius as u32 + 1;
    // Reciprocal in 1/65536, rounded up: means of the widths 3, 5 and 7 are off by less than one.
    let share = (1 << 16) / width + 1;
    // The rows, then the columns.
    for (next, step) in [(side, 1), (1, side)] {
        for k in 0..side {
            box_filter_line(crop, k * next, step, radius, |sum| {
                (((sum + radius as u32) * share) >> 16) as u8
            });
        }
    }
}

/// Box filter along one row or column: the pixels `first`, `first + step`, … of the crop. `mean`
/// divides a sum of `2·radius + 1` pixels.
fn box_filter_line(
    crop: &mut Crop,
    first: usize,
    step: usize,
    radius: usize,
    mean: impl Fn(u32) -> u8,
) {
    let side = crop.side();
    let mut line = [0u8; CROP_MAX + 2 * RADIUS_MAX];
    let Some(pixels) = crop.luma_mut().get_mut(first..) else {
        return;
    };
    for (k, v) in line.iter_mut().enumerate().take(side + 2 * radius) {
        let at = k.saturating_sub(radius).min(side.saturating_sub(1));
        *v = pixels.get(at * step).copied().unwrap_or(0);
    }
    let mut sum: u32 = line.iter().take(2 * radius).map(|v| u32::from(*v)).sum();
    let ends = line.iter().skip(2 * radius).zip(&line);
    for (pixel, (new, old)) in pixels.iter_mut().step_by(step.max(1)).take(side).zip(ends) {
        sum += u32::from(*new);
        *pixel = mean(sum);
        sum -= u32::from(*old);
    }
}
