//! The pixels of a window that trees compare: a grid of 40×40 over its square.

/// A pixel of the grid, row by row: `< GRID²`.
pub type Pixel = u16;

/// Pixels along each side of a window; finer than the smallest face's own.
pub const GRID: usize = 40;

/// Where a column or a row of the grid lies, from the window's centre \[1/256 of its side\].
#[inline]
pub(super) fn offset(line: usize) -> i32 {
    (2 * line as i32 + 1 - GRID as i32) * 128 / GRID as i32
}

/// The pixel as far on the other side of the window's vertical axis.
pub(super) fn mirrored(pixel: Pixel) -> Pixel {
    let column = pixel % GRID as u16;
    pixel - column + (GRID as u16 - 1 - column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_pixel_lies_on_the_other_side() {
        for pixel in 0..(GRID * GRID) as Pixel {
            let at = |pixel: Pixel| [pixel as usize / GRID, pixel as usize % GRID].map(offset);
            let ([y, x], [there_y, there_x]) = (at(pixel), at(mirrored(pixel)));
            assert_eq!([y, x], [there_y, -there_x]);
        }
    }
}
