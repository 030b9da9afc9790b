//! Oriented-gradient cells by box sums (after Dalal and Triggs 2005, with wide overlapping cells).
//!
//! Each pixel's gradient is split exactly between the two of eight directions that enclose it
//! (a parallelogram split, no trigonometry); a cell is the sum over a box, read from one integral
//! image per direction; the 3×3 cells around a point are normalised together.

use crate::image::{CROP_MAX, Crop};
use crate::math::isqrt;

/// Directions, 45° apart, signed.
pub const BINS: usize = 8;
/// Cells per point: 3×3.
pub const CELLS: usize = 9;
/// Values per point.
pub const VALUES: usize = BINS * CELLS;

/// Placement of the cells around a point \[crop px\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HogGrid {
    /// Distance between the centres of neighbouring cells.
    pub spacing: i32,
    /// A cell reaches from −`radius` to +`radius` around its centre.
    pub radius: i32,
}

const ROW: usize = CROP_MAX + 1;

/// Working memory: gradients of one crop and the integral image of one direction.
#[derive(Clone)]
pub struct Hog {
    side: usize,
    /// Per pixel: share along the nearest axis, and along the nearest diagonal.
    axis: [u8; CROP_MAX * CROP_MAX],
    diagonal: [u8; CROP_MAX * CROP_MAX],
    /// Per pixel: which axis (bits 0–1), which diagonal (bits 2–3).
    code: [u8; CROP_MAX * CROP_MAX],
    integral: [u32; ROW * ROW],
    /// Cell sums of every point, before they are normalised together.
    sums: [[u32; VALUES]; MAX_POINTS],
}

impl Default for Hog {
    fn default() -> Self {
        Self::new()
    }
}

impl Hog {
    /// Empty working memory.
    pub const fn new() -> Self {
        Hog {
            side: 0,
            axis: [0; CROP_MAX * CROP_MAX],
            diagonal: [0; CROP_MAX * CROP_MAX],
            code: [0; CROP_MAX * CROP_MAX],
            integral: [0; ROW * ROW],
            sums: [[0; VALUES]; MAX_POINTS],
        }
    }

    /// Descriptors of the crop at `points` (crop px, whole; outside reads as flat): `VALUES`
    /// values per point, 0..=255, into `out`, cell by cell, [`BINS`] to a cell.
    ///
    /// Work: 8 `side`² additions and 288 reads per point.
    pub fn describe(
        &mut self,
        crop: &Crop,
        grid: HogGrid,
        points: &[[i32; 2]],
        out: &mut [[u8; VALUES]],
    ) {
        self.gradients(crop);
        for bin in 0..BINS {
            self.integrate(bin);
            let (integral, side) = (&self.integral, self.side as i32);
            for (point, sums) in points.iter().zip(self.sums.iter_mut()) {
                for ([dx, dy], cell) in CELL_OFFSETS.iter().zip(sums.chunks_exact_mut(BINS)) {
                    let centre = [point[0] + dx * grid.spacing, point[1] + dy * grid.spacing];
                    if let Some(sum) = cell.get_mut(bin) {
                        *sum = box_sum(integral, side, centre, grid.radius);
                    }
                }
            }
        }
        for ((sums, out), _) in self.sums.iter().zip(out.iter_mut()).zip(points) {
            normalise(sums, out);
        }
    }

    /// Splits every inner pixel's gradient between an axis and a diagonal.
    fn gradients(&mut self, crop: &Crop) {
        let side = crop.side();
        self.side = side;
        let luma = crop.luma();
        let row = |y: usize| luma.get(y * side..(y + 1) * side).unwrap_or(&[]);
        for y in 0..side {
            let (above, here, below) =
                (row(y.saturating_sub(1)), row(y), row((y + 1).min(side - 1)));
            let at = y * side..(y + 1) * side;
            let (Some(axis), Some(diagonal), Some(code)) = (
                self.axis.get_mut(at.clone()),
                self.diagonal.get_mut(at.clone()),
                self.code.get_mut(at),
            ) else {
                continue;
            };
            let inner = axis
                .iter_mut()
                .zip(diagonal.iter_mut())
                .zip(code.iter_mut())
                .skip(1);
            let vertical = above.iter().zip(below).skip(1);
            for (((axis, diagonal), code), ((above, below), window)) in
                inner.zip(vertical.zip(here.windows(3)))
            {
                let &[left, _, right] = window else { continue };
                let gx = right as i32 - left as i32;
                let gy = *below as i32 - *above as i32;
                let (mx, my) = (gx.abs(), gy.abs());
                let (major, minor) = (mx.max(my), mx.min(my));
                // A vector of length √2·minor on the diagonal and major − minor on the axis; both
                // halved so that the diagonal's share fits a byte (181/256 = √2/2).
                *axis = ((major - minor) / 2) as u8;
                *diagonal = ((minor * 181) >> 8) as u8;
                let (right, down) = ((gx > 0) as u8, (gy > 0) as u8);
                let nearest = if mx >= my { right } else { 2 + down };
                *code = nearest | (right << 2) | (down << 3);
            }
            for edge in [0, side.saturating_sub(1)] {
                if let (Some(a), Some(d)) = (axis.get_mut(edge), diagonal.get_mut(edge)) {
                    (*a, *d) = (0, 0);
                }
            }
        }
    }

    /// Builds the integral image of one direction: `integral[y][x]` sums all rows < y, columns < x.
    fn integrate(&mut self, bin: usize) {
        let side = self.side;
        let (values, mask, wanted) = if bin < 4 {
            (&self.axis, 3, bin as u8)
        } else {
            (&self.diagonal, 12, ((bin - 4) << 2) as u8)
        };
        let mut columns = [0u32; CROP_MAX];
        let (first, rest) = self.integral.split_at_mut(ROW);
        first.fill(0);
        let rows = values
            .chunks_exact(side.max(1))
            .zip(self.code.chunks_exact(side.max(1)));
        for ((values, codes), out) in rows.take(side).zip(rest.chunks_exact_mut(ROW)) {
            for ((column, value), code) in columns.iter_mut().zip(values).zip(codes) {
                *column += if code & mask == wanted {
                    *value as u32
                } else {
                    0
                };
            }
            let mut sum = 0u32;
            for (out, column) in out.iter_mut().skip(1).zip(&columns) {
                sum += column;
                *out = sum;
            }
        }
    }
}

/// Sum over the box around a centre, cut off at the crop's edges.
#[inline]
fn box_sum(integral: &[u32; ROW * ROW], side: i32, [x, y]: [i32; 2], radius: i32) -> u32 {
    // `clamp` would panic for a negative side.
    let inside = |v: i32| v.max(0).min(side);
    let (x0, x1) = (inside(x - radius), inside(x + radius + 1));
    let (y0, y1) = (inside(y - radius), inside(y + radius + 1));
    let at = |x: i32, y: i32| {
        integral
            .get(y as usize * ROW + x as usize)
            .copied()
            .unwrap_or(0)
    };
    at(x1, y1)
        .wrapping_add(at(x0, y0))
        .wrapping_sub(at(x1, y0))
        .wrapping_sub(at(x0, y1))
}

/// Most points described at once.
pub(crate) const MAX_POINTS: usize = 68;

const CELL_OFFSETS: [[i32; 2]; CELLS] = [
    [-1, -1],
    [0, -1],
    [1, -1],
    [-1, 0],
    [0, 0],
    [1, 0],
    [-1, 1],
    [0, 1],
    [1, 1],
];

/// Root of the share of the total (RootSIFT, Arandjelović and Zisserman 2012): the vector's
/// Euclidean length is the same for every point, and strong edges do not drown weak ones.
fn normalise(sums: &[u32; VALUES], out: &mut [u8; VALUES]) {
    // Crop noise of about one grey level in every pixel; keeps flat patches near zero.
    const FLOOR: u32 = 600;
    let total: u32 = sums.iter().sum::<u32>() + FLOOR;
    // share · 2^20 → root · 2^10; a root of 1/4 of the length fills the byte.
    let reciprocal = (1u64 << 40) / total.max(1) as u64;
    for (out, sum) in out.iter_mut().zip(sums) {
        let share = ((*sum as u64 * reciprocal) >> 20) as u32;
        *out = isqrt(share).min(510).div_ceil(2).min(255) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Frame, FrameLayout, warp};
    use crate::math::Similarity;

    fn describe(luma: impl Fn(i32, i32) -> u8) -> [u8; VALUES] {
        let bytes: [u8; 4096] = core::array::from_fn(|i| luma(i as i32 % 64, i as i32 / 64));
        let frame = Frame::new(&FrameLayout::grey(64, 64), &bytes).unwrap();
        let mut crop = Crop::new();
        warp(&frame, &Similarity::IDENTITY, 64, &mut crop);
        let mut out = [[0; VALUES]];
        Hog::new().describe(
            &crop,
            HogGrid {
                spacing: 6,
                radius: 4,
            },
            &[[32, 32]],
            &mut out,
        );
        out[0]
    }

    #[test]
    fn a_ramp_fills_one_direction() {
        let right = describe(|x, _| (x * 3) as u8);
        for cell in right.chunks(BINS) {
            assert!(
                cell[1] > 60 && cell.iter().enumerate().all(|(i, v)| i == 1 || *v == 0),
                "{cell:?}"
            );
        }
        let down_right = describe(|x, y| (x + y) as u8);
        assert!(
            down_right
                .chunks(BINS)
                .all(|c| c[7] > 60 && c[..7].iter().all(|v| *v == 0))
        );
    }

    #[test]
    fn contrast_does_not_matter() {
        let pattern = |gain: i32| {
            describe(move |x, y| (100 + gain * (((x / 5) % 2) * 8 - ((y / 7) % 2) * 5)) as u8)
        };
        let (low, high) = (pattern(2), pattern(8));
        assert!(
            low.iter()
                .zip(high)
                .all(|(l, h)| (*l as i32 - h as i32).abs() < 14)
        );
    }

    #[test]
    fn flat_and_outside_are_zero() {
        assert_eq!(describe(|_, _| 77), [0; VALUES]);
    }
}
