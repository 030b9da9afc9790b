//! A square window on the frame.

use super::grid::{GRID, Pixel, offset};
use crate::image::{Frame, MAX_SIDE};

/// Bits after the point of a pixel coordinate while an offset is rotated and scaled.
const FRACTION: u32 = 14;
/// Units of sizes and centres \[1/px\]: 4 bits after the point.
pub(super) const Q4: i32 = 16;
/// Largest side of a window \[px\]; with it no sum below leaves i32.
const SIDE_MAX: i32 = 4 * MAX_SIDE as i32;

/// A rotated square of the frame: maps the pixels of its grid to pixels of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    // Centre [px, Q14], rounding included.
    x: i32,
    y: i32,
    // One unit of offset (1/256 side) along the rotated axes [px, Q14].
    cos: i32,
    sin: i32,
    // 1, or −1 for a mirrored window.
    flip: i32,
}

impl Window {
    /// The window of `side_px_q4` (1/16 px) around (`x_px_q4`, `y_px_q4`), rotated clockwise by
    /// `roll` \[rad\]. Values beyond any frame are clamped; a `roll` that is not finite is taken as
    /// 0.
    pub fn new(x_px_q4: i32, y_px_q4: i32, side_px_q4: i32, roll: f32) -> Self {
        let roll = if roll.is_finite() { roll } else { 0.0 };
        let side = side_px_q4.clamp(0, SIDE_MAX * Q4);
        // Q14 · Q4 / 256, with the last shift to Q14: (cos · 2^14) · (side · 2^4) / 2^(8 + 4).
        let unit = |v: f32| {
            let q14 = libm::roundf(v * (1 << FRACTION) as f32) as i64;
            ((q14 * side as i64) >> 12) as i32
        };
        Window {
            cos: unit(libm::cosf(roll)),
            sin: unit(libm::sinf(roll)),
            flip: 1,
            ..Window::default()
        }
        .at(x_px_q4, y_px_q4)
    }

    /// The same window around another centre \[1/16 px\].
    #[inline]
    pub fn at(self, x_px_q4: i32, y_px_q4: i32) -> Self {
        let limit = 2 * MAX_SIDE as i32 * Q4;
        let half = 1 << (FRACTION - 1);
        Window {
            x: (x_px_q4.clamp(-limit, limit) << (FRACTION - 4)) + half,
            y: (y_px_q4.clamp(-limit, limit) << (FRACTION - 4)) + half,
            ..self
        }
    }

    /// The window of the same square whose grid is mirrored left to right along its own axes.
    pub fn mirrored(self) -> Self {
        Window {
            flip: -self.flip,
            ..self
        }
    }

    /// The same window around a pixel of the frame.
    #[inline]
    pub(super) fn at_pixel(self, x: i32, y: i32) -> Self {
        self.at(x * Q4, y * Q4)
    }

    /// Luma of the frame's pixel that a pixel of the grid falls into.
    #[inline]
    pub fn read(&self, frame: &Frame<'_>, pixel: Pixel) -> u8 {
        let [x, y] = self.frame_pixel(pixel as usize / GRID, pixel as usize % GRID);
        frame.luma(x, y)
    }

    /// The frame's pixel (x, y) that a pixel of the grid falls into.
    #[inline]
    pub(super) fn frame_pixel(&self, row: usize, column: usize) -> [i32; 2] {
        let (x, y) = (offset(column) * self.flip, offset(row));
        let px = self.x.wrapping_add(x * self.cos).wrapping_sub(y * self.sin);
        let py = self.y.wrapping_add(x * self.sin).wrapping_add(y * self.cos);
        [px >> FRACTION, py >> FRACTION]
    }
}
