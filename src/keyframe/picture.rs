//! The reduced picture: a window of the frame, so small that the face is always about as wide.

use crate::image::Frame;

/// Widest picture \[px\].
pub const WIDTH: usize = 320;
/// Highest picture \[px\].
pub const HEIGHT: usize = 240;
/// Bytes that a picture may take.
pub const SCRATCH_BYTES: usize = WIDTH * HEIGHT;

/// A frame pixel in the units of a [`Grid`].
const Q8: f32 = 256.0;
/// Coarsest step \[frame px\]: with it the largest face there can be is 64 px wide.
const STEP_MAX: f32 = 256.0;
/// Finest step \[frame px\]: small faces are not blown up further.
const STEP_MIN: f32 = 0.66;

/// Which frame pixels a picture's pixels show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Centre of the first pixel, and the step from one to the next \[1/256 frame px\].
    x: i32,
    y: i32,
    step: i32,
    width: usize,
    height: usize,
}

impl Grid {
    /// Steps such that `face_px` frame pixels are `wide` of the picture's.
    fn step(face_px: f32, wide: f32) -> Option<i32> {
        let step = face_px / wide;
        (step.is_finite() && step > 0.0)
            .then(|| libm::roundf(step.clamp(STEP_MIN, STEP_MAX) * Q8) as i32)
    }

    /// A square of `side` pixels around a place of the frame.
    pub fn around(centre: [f32; 2], side: usize, face_px: f32, wide: f32) -> Option<Grid> {
        let step = Self::step(face_px, wide)?;
        let side = side.min(HEIGHT);
        let half = step * (side as i32 - 1) / 2;
        let q8 = |v: f32| libm::roundf(v.clamp(-16_384.0, 32_768.0) * Q8) as i32 - half;
        let sane = centre.iter().all(|v| v.is_finite());
        sane.then(|| Grid {
            x: q8(centre[0]),
            y: q8(centre[1]),
            step,
            width: side,
            height: side,
        })
    }

    /// How many windows together show the whole frame, overlapping by a face: columns and rows.
    fn windows(frame: &Frame<'_>, step: i32, wide: f32) -> (usize, usize) {
        let overlap = (wide as usize).min(HEIGHT / 2);
        let (columns, _) = windows(frame.width(), step, WIDTH, overlap);
        let (rows, _) = windows(frame.height(), step, HEIGHT, overlap);
        (columns, rows)
    }

    /// The number of those windows, at least 1.
    pub fn count(frame: &Frame<'_>, face_px: f32, wide: f32) -> u32 {
        let step = Self::step(face_px, wide);
        let (columns, rows) = step.map_or((1, 1), |step| Self::windows(frame, step, wide));
        (columns * rows) as u32
    }

    /// One of them; `turn` counts through them.
    pub fn window(frame: &Frame<'_>, turn: u32, face_px: f32, wide: f32) -> Option<Grid> {
        let step = Self::step(face_px, wide)?;
        let (columns, rows) = Self::windows(frame, step, wide);
        let turn = turn as usize % (columns * rows).max(1);
        let row = turn.checked_div(columns)?;
        let (x, width) = part(frame.width(), step, WIDTH, columns, turn - row * columns);
        let (y, height) = part(frame.height(), step, HEIGHT, rows, row);
        Some(Grid {
            x,
            y,
            step,
            width,
            height,
        })
    }

    /// From the picture's pixels to the frame's.
    pub fn to_frame(self, [u, v]: [f32; 2]) -> [f32; 2] {
        let at = |first: i32, n: f32| (first as f32 + self.step as f32 * n) / Q8;
        [at(self.x, u), at(self.y, v)]
    }

    /// From the frame's pixels to the picture's.
    pub fn of_frame(self, [x, y]: [f32; 2]) -> [f32; 2] {
        let at = |first: i32, n: f32| (n * Q8 - first as f32) / self.step.max(1) as f32;
        [at(self.x, x), at(self.y, y)]
    }
}

/// Number of windows along an axis of the frame, and the picture pixels that it has.
fn windows(length: i32, step: i32, most: usize, overlap: usize) -> (usize, usize) {
    let pixels = ((length.max(1) * 256).checked_div(step).unwrap_or(1)).max(1) as usize;
    let fresh = most.saturating_sub(overlap).max(1);
    let more = pixels.saturating_sub(most).div_ceil(fresh);
    (1 + more, pixels)
}

/// First pixel \[1/256 frame px\] and number of pixels of a window along an axis.
fn part(length: i32, step: i32, most: usize, count: usize, index: usize) -> (i32, usize) {
    let (_, pixels) = windows(length, step, most, 0);
    let shown = pixels.min(most);
    let last = pixels - shown;
    // Spread evenly: the first begins where the frame does, the last ends where it does.
    let first = (last * index)
        .checked_div(count.saturating_sub(1))
        .unwrap_or(0);
    (first as i32 * step + (step - 256) / 2, shown)
}

/// A small blurred picture in borrowed memory.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'s> {
    luma: &'s [u8],
    width: usize,
    height: usize,
}

impl<'s> Picture<'s> {
    /// A picture of that width over these bytes, rows without padding.
    pub fn new(luma: &'s [u8], width: usize) -> Picture<'s> {
        let height = luma.len().checked_div(width).unwrap_or(0);
        Picture {
            luma,
            width: width.min(WIDTH),
            height: if width > WIDTH { 0 } else { height },
        }
    }

    /// Reduces the part of the frame that the grid says, blurred by 3×3 binomial weights: two
    /// samples for each pixel, so at most 2·[`SCRATCH_BYTES`] reads. Empty when the memory is too small.
    pub fn of(frame: &Frame<'_>, grid: &Grid, memory: &'s mut [u8]) -> Picture<'s> {
        let (width, height) = (grid.width.min(WIDTH), grid.height.min(HEIGHT));
        let Some(luma) = memory.get_mut(..width * height) else {
            return Picture::new(&[], 0);
        };
        // Two rows, blurred along x, before the one that is read.
        let mut here = [0u16; WIDTH];
        sample(frame, grid, 0, width, &mut here);
        let (mut above, mut below) = (here, here);
        for (v, row) in luma.chunks_exact_mut(width.max(1)).enumerate() {
            let next = (v + 1).min(height.saturating_sub(1));
            sample(frame, grid, next as i32, width, &mut below);
            let sums = above.iter().zip(&here).zip(&below);
            for (out, ((a, b), c)) in row.iter_mut().zip(sums) {
                *out = ((a + 2 * b + c + 8) >> 4) as u8;
            }
            above = here;
            here = below;
        }
        Picture {
            luma,
            width,
            height,
        }
    }

    /// Width \[px\].
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height \[px\].
    pub fn height(&self) -> usize {
        self.height
    }

    /// A row; empty below the last.
    pub fn row(&self, y: usize) -> &'s [u8] {
        let start = y * self.width;
        self.luma.get(start..start + self.width).unwrap_or(&[])
    }

    /// Luma at (x, y); outside the picture, that of the nearest pixel.
    #[inline]
    pub fn luma(&self, x: i32, y: i32) -> u8 {
        let x = x.min(self.width as i32 - 1).max(0) as usize;
        let y = y.min(self.height as i32 - 1).max(0) as usize;
        self.luma.get(y * self.width + x).copied().unwrap_or(0)
    }

    /// Luma at that many pixels from the first; 0 outside.
    #[inline]
    pub fn at(&self, index: i32) -> u8 {
        self.luma.get(index as usize).copied().unwrap_or(0)
    }
}

/// A row, blurred along x by 1 2 1.
fn sample(frame: &Frame<'_>, grid: &Grid, v: i32, width: usize, out: &mut [u16; WIDTH]) {
    // Two samples on the pixel's diagonal.
    let quarter = grid.step / 4;
    let y = grid.y + grid.step * v;
    let (y0, y1) = ((y - quarter + 128) >> 8, (y + quarter + 128) >> 8);
    let mut raw = [0u16; WIDTH + 2];
    let mut x = grid.x + 128;
    for pixel in raw.iter_mut().skip(1).take(width) {
        let a = frame.raw_luma((x - quarter) >> 8, y0) as u16;
        let b = frame.raw_luma((x + quarter) >> 8, y1) as u16;
        *pixel = (a + b + 1) >> 1;
        x += grid.step;
    }
    // The edges repeat.
    let first = raw.get(1).copied().unwrap_or(0);
    if let Some(edge) = raw.first_mut() {
        *edge = first;
    }
    let last = raw.get(width).copied().unwrap_or(0);
    if let Some(edge) = raw.get_mut(width + 1) {
        *edge = last;
    }
    let sums = raw.iter().zip(raw.iter().skip(1)).zip(raw.iter().skip(2));
    for (out, ((a, b), c)) in out.iter_mut().zip(sums) {
        *out = a + 2 * b + c;
    }
}
