//! The pixels of a window that trees compare: a grid of 40×40 over its square.

/// A pixel of the grid: row · [`GRID`] + column.
pub type Pixel = u16;

/// Pixels along each side of a window; finer than the frame's pixels in the smallest face.
pub const GRID: usize = 40;

/// Offset of a column or row of the grid from the window's centre \[1/256 of the window's side\].
#[inline]
pub(super) fn offset(line: usize) -> i32 {
    (2 * line as i32 + 1 - GRID as i32) * 128 / GRID as i32
}

/// The pixel mirrored at the window's vertical axis.
pub(super) fn mirrored(pixel: Pixel) -> Pixel {
    let column = pixel % GRID as u16;
    pixel - column + (GRID as u16 - 1 - column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirroring_negates_the_horizontal_offset() {
        for pixel in 0..(GRID * GRID) as Pixel {
            let at = |pixel: Pixel| [pixel as usize / GRID, pixel as usize % GRID].map(offset);
            let ([y, x], [mirrored_y, mirrored_x]) = (at(pixel), at(mirrored(pixel)));
            assert_eq!([y, x], [mirrored_y, -mirrored_x]);
        }
    }
}
