//! The reduced image: a window of the frame, sampled such that a face is always about as wide.

use crate::image::Frame;

/// Largest width of a reduced image \[px\].
pub const WIDTH: usize = 240;
/// Largest height of a reduced image \[px\].
pub const HEIGHT: usize = 180;
/// Bytes that a reduced image needs at most.
pub const SCRATCH_BYTES: usize = WIDTH * HEIGHT;

/// Units of a [`SamplingGrid`] \[1/frame px\]: 8 bits after the point.
const Q8: f32 = 256.0;
/// Largest step \[frame px\]: with it the largest possible face (16384 px) is 64 px wide.
const STEP_MAX: f32 = 256.0;
/// Smallest step \[frame px\]: smaller faces are not enlarged further.
const STEP_MIN: f32 = 0.66;

/// Where the pixels of a reduced image lie on the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplingGrid {
    /// Centre of the first pixel, and the step from one to the next \[1/256 frame px\].
    x: i32,
    y: i32,
    step: i32,
    width: usize,
    height: usize,
}

impl SamplingGrid {
    /// The step with which a face of `face_px` frame pixels is `reduced_px` wide
    /// \[1/256 frame px\].
    fn step(face_px: f32, reduced_px: f32) -> Option<i32> {
        let step = face_px / reduced_px;
        (step.is_finite() && step > 0.0)
            .then(|| libm::roundf(step.clamp(STEP_MIN, STEP_MAX) * Q8) as i32)
    }

    /// A square of `side` pixels around a point of the frame \[frame px\]. A face of `face_px`
    /// frame pixels is reduced to `reduced_px`.
    pub fn around(
        centre: [f32; 2],
        side: usize,
        face_px: f32,
        reduced_px: f32,
    ) -> Option<SamplingGrid> {
        let step = Self::step(face_px, reduced_px)?;
        let side = side.min(HEIGHT);
        let half = step * (side as i32 - 1) / 2;
        let q8 = |v: f32| libm::roundf(v.clamp(-16_384.0, 32_768.0) * Q8) as i32 - half;
        let finite = centre.iter().all(|v| v.is_finite());
        finite.then(|| SamplingGrid {
            x: q8(centre[0]),
            y: q8(centre[1]),
            step,
            width: side,
            height: side,
        })
    }

    /// Number of windows that cover the frame and overlap by a face: columns and rows.
    fn windows(frame: &Frame<'_>, step: i32, reduced_px: f32) -> (usize, usize) {
        let overlap = (reduced_px as usize).min(HEIGHT / 2);
        let (columns, _) = windows(frame.width(), step, WIDTH, overlap);
        let (rows, _) = windows(frame.height(), step, HEIGHT, overlap);
        (columns, rows)
    }

    /// The number of those windows, at least 1.
    pub fn count(frame: &Frame<'_>, face_px: f32, reduced_px: f32) -> u32 {
        let step = Self::step(face_px, reduced_px);
        let (columns, rows) = step.map_or((1, 1), |step| Self::windows(frame, step, reduced_px));
        (columns * rows) as u32
    }

    /// One of those windows, by its index modulo their number.
    pub fn window(
        frame: &Frame<'_>,
        index: u32,
        face_px: f32,
        reduced_px: f32,
    ) -> Option<SamplingGrid> {
        let step = Self::step(face_px, reduced_px)?;
        let (columns, rows) = Self::windows(frame, step, reduced_px);
        let index = index as usize % (columns * rows).max(1);
        let row = index.checked_div(columns)?;
        let (x, width) = segment(frame.width(), step, WIDTH, columns, index - row * columns);
        let (y, height) = segment(frame.height(), step, HEIGHT, rows, row);
        Some(SamplingGrid {
            x,
            y,
            step,
            width,
            height,
        })
    }

    /// From pixels of the reduced image to those of the frame.
    pub fn to_frame(self, [u, v]: [f32; 2]) -> [f32; 2] {
        let at = |first: i32, n: f32| (first as f32 + self.step as f32 * n) / Q8;
        [at(self.x, u), at(self.y, v)]
    }

    /// From pixels of the frame to those of the reduced image.
    pub fn to_image(self, [x, y]: [f32; 2]) -> [f32; 2] {
        let at = |first: i32, n: f32| (n * Q8 - first as f32) / self.step.max(1) as f32;
        [at(self.x, x), at(self.y, y)]
    }
}

/// Number of windows along an axis of the frame, and its length in pixels of the reduced image. A
/// window has at most `window_max` of them.
fn windows(length: i32, step: i32, window_max: usize, overlap: usize) -> (usize, usize) {
    let pixels = ((length.max(1) * 256).checked_div(step).unwrap_or(1)).max(1) as usize;
    let fresh = window_max.saturating_sub(overlap).max(1);
    let more = pixels.saturating_sub(window_max).div_ceil(fresh);
    (1 + more, pixels)
}

/// First pixel \[1/256 frame px\] and number of pixels of a window along an axis.
fn segment(length: i32, step: i32, window_max: usize, count: usize, index: usize) -> (i32, usize) {
    let (_, pixels) = windows(length, step, window_max, 0);
    let visible = pixels.min(window_max);
    let last = pixels - visible;
    // Spread evenly: the first window begins and the last one ends with the frame.
    let first = (last * index)
        .checked_div(count.saturating_sub(1))
        .unwrap_or(0);
    (first as i32 * step + (step - 256) / 2, visible)
}

/// A small blurred grey image in borrowed memory, rows without padding.
#[derive(Clone, Copy, Debug)]
pub struct ReducedImage<'s> {
    luma: &'s [u8],
    width: usize,
    height: usize,
}

impl<'s> ReducedImage<'s> {
    /// An image of that width over these bytes.
    pub fn new(luma: &'s [u8], width: usize) -> ReducedImage<'s> {
        let height = luma.len().checked_div(width).unwrap_or(0);
        ReducedImage {
            luma,
            width: width.min(WIDTH),
            height: if width > WIDTH { 0 } else { height },
        }
    }

    /// Samples the frame at the grid, with two samples per pixel, and blurs by 3×3 binomial
    /// weights: at most 2·[`SCRATCH_BYTES`] reads of the frame. Empty when the memory is too small.
    pub fn of(frame: &Frame<'_>, grid: &SamplingGrid, memory: &'s mut [u8]) -> ReducedImage<'s> {
        let (width, height) = (grid.width.min(WIDTH), grid.height.min(HEIGHT));
        let Some(luma) = memory.get_mut(..width * height) else {
            return ReducedImage::new(&[], 0);
        };
        let columns = &Columns::of(frame, grid);
        // Three rows, blurred along x: the last one, this one and the next one.
        let mut here = [0u16; WIDTH];
        sample(frame, grid, columns, 0, width, &mut here);
        let (mut above, mut below) = (here, here);
        for (v, row) in luma.chunks_exact_mut(width.max(1)).enumerate() {
            let next = (v + 1).min(height.saturating_sub(1));
            sample(frame, grid, columns, next as i32, width, &mut below);
            let sums = above.iter().zip(&here).zip(&below);
            for (out, ((a, b), c)) in row.iter_mut().zip(sums) {
                *out = ((a + 2 * b + c + 8) >> 4) as u8;
            }
            above = here;
            here = below;
        }
        ReducedImage {
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

    /// Row `y`; empty below the last.
    pub fn row(&self, y: usize) -> &'s [u8] {
        let start = y * self.width;
        self.luma.get(start..start + self.width).unwrap_or(&[])
    }

    /// Copies the pixels from (x, y) to the right; outside the image, the nearest one.
    #[inline]
    pub fn copy_row(&self, x: i32, y: i32, out: &mut [u8]) {
        let y = y.min(self.height as i32 - 1).max(0) as usize;
        let row = self.row(y);
        let inside = usize::try_from(x)
            .ok()
            .and_then(|x| row.get(x..x + out.len()));
        if let Some(inside) = inside {
            out.copy_from_slice(inside);
            return;
        }
        for (k, pixel) in out.iter_mut().enumerate() {
            let x = (x + k as i32).min(self.width as i32 - 1).max(0) as usize;
            *pixel = row.get(x).copied().unwrap_or(0);
        }
    }
}

/// Columns of the frame that hold the two samples of each pixel of a row, if they are inside.
struct Columns {
    upper: [u16; WIDTH],
    lower: [u16; WIDTH],
}

impl Columns {
    fn of(frame: &Frame<'_>, grid: &SamplingGrid) -> Columns {
        let quarter = grid.step / 4;
        let at = |u: usize, by: i32| {
            let x = (grid.x + 128 + grid.step * u as i32 + by) >> 8;
            x.min(frame.width() - 1).max(0) as u16
        };
        Columns {
            upper: core::array::from_fn(|u| at(u, -quarter)),
            lower: core::array::from_fn(|u| at(u, quarter)),
        }
    }
}

/// Row `v` of the grid, blurred along x by the weights 1 2 1 (their sum, not their mean).
fn sample(
    frame: &Frame<'_>,
    grid: &SamplingGrid,
    columns: &Columns,
    v: i32,
    width: usize,
    out: &mut [u16; WIDTH],
) {
    let quarter = grid.step / 4;
    let y = grid.y + grid.step * v;
    let (y0, y1) = ((y - quarter + 128) >> 8, (y + quarter + 128) >> 8);
    let mut raw = [0u16; WIDTH + 2];
    let pixels = raw.iter_mut().skip(1).take(width);
    let pairs = columns.upper.iter().zip(&columns.lower);
    let pixels = pixels.zip(pairs);
    match (frame.luma_row(y0), frame.luma_row(y1)) {
        (Some(upper), Some(lower)) => {
            let at = |row: &[u8], x: u16| u16::from(row.get(usize::from(x)).copied().unwrap_or(0));
            for (pixel, (a, b)) in pixels {
                *pixel = (at(upper, *a) + at(lower, *b) + 1) >> 1;
            }
        }
        _ => {
            let at = |x: u16, y: i32| u16::from(frame.raw_luma(i32::from(x), y));
            for (pixel, (a, b)) in pixels {
                *pixel = (at(*a, y0) + at(*b, y1) + 1) >> 1;
            }
        }
    }
    // The edge pixels repeat.
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
