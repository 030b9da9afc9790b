//! The canonical crop: a small square of luma cut out of a frame by a similarity transform.

use super::Frame;
use crate::math::Similarity;

/// Largest side of a crop \[px\].
pub const CROP_MAX: usize = 128;

/// A square grey image of `side`×`side` pixels, row-major, in fixed memory.
#[derive(Clone)]
pub struct Crop {
    side: usize,
    luma: [u8; CROP_MAX * CROP_MAX],
}

impl Default for Crop {
    fn default() -> Self {
        Self::new()
    }
}

impl Crop {
    /// An empty crop.
    pub const fn new() -> Self {
        Crop {
            side: 0,
            luma: [0; CROP_MAX * CROP_MAX],
        }
    }

    /// Width and height \[px\].
    pub fn side(&self) -> usize {
        self.side
    }

    /// Exchanges left and right.
    pub fn mirror(&mut self) {
        let side = self.side;
        self.luma
            .chunks_exact_mut(side.max(1))
            .take(side)
            .for_each(<[u8]>::reverse);
    }

    /// The pixels of a crop of this side, at most [`CROP_MAX`], to be written.
    pub(super) fn resized(&mut self, side: usize) -> &mut [u8] {
        self.side = side.min(CROP_MAX);
        self.luma
            .get_mut(..self.side * self.side)
            .unwrap_or(&mut [])
    }

    /// The pixels, row-major, `side()` to a row.
    pub fn luma(&self) -> &[u8] {
        self.luma.get(..self.side * self.side).unwrap_or(&[])
    }
}

/// Bits after the point of a sampling coordinate.
const FRACTION: u32 = 16;

/// Most samples averaged along one axis of a crop pixel when the frame is finer than the crop.
const TAPS_MAX: i32 = 4;
/// From this scale on \[frame px per crop px\] a crop pixel is the mean of 4×4 single pixels of the
/// frame: interpolation would read four times as many for nearly the same mean. Below, 2×2
/// interpolated samples at most take as many reads.
const COARSE_SCALE: f32 = 2.5;

/// Width of a frame's box filter \[frame px\].
const BOX_PX: f32 = 3.0;
/// Largest half width of the box filter in the crop \[crop px\].
const RADIUS_MAX: usize = 3;

/// Fills `crop` (`side` ≤ [`CROP_MAX`]) with the frame's luma: crop pixel (u, v) shows the frame at
/// `to_frame` × (u, v). Bilinear. Where the frame is finer than the crop, each pixel averages up to
/// 4×4 samples, so the work is bounded by 16 `side`². Of a box-filtered frame the crop is filtered
/// instead, with a box that is as wide in the frame as nearly as an odd number of crop pixels can
/// be.
///
/// Arithmetic is 16.16 fixed point: the same bytes on every machine.
pub fn warp(frame: &Frame<'_>, to_frame: &Similarity, side: usize, crop: &mut Crop) {
    let side = side.min(CROP_MAX);
    crop.side = side;
    let fixed = |v: f32| {
        let v = if v.is_finite() { v } else { 0.0 };
        libm::roundf(v.clamp(-16_000.0, 16_000.0) * (1 << FRACTION) as f32) as i32
    };
    let (a, b) = (fixed(to_frame.a) as i64, fixed(to_frame.b) as i64);
    let (tx, ty) = (fixed(to_frame.tx) as i64, fixed(to_frame.ty) as i64);
    let scale = libm::sqrtf(to_frame.a * to_frame.a + to_frame.b * to_frame.b);
    let coarse = scale >= COARSE_SCALE;
    let taps = match coarse {
        true => TAPS_MAX,
        false => (libm::roundf(scale) as i32).clamp(1, TAPS_MAX),
    };
    // Samples sit at the centres of a taps×taps division of the crop pixel.
    let first = |axis: i64| -axis * (taps as i64 - 1) / (2 * taps as i64);
    let (sub_a, sub_b) = (a / taps as i64, b / taps as i64);
    let samples = Samples {
        taps: taps as usize,
        steps: [(a, b), (sub_a, sub_b)],
        coarse,
    };
    let inside = Inside::of(frame);
    let rows = crop.luma.chunks_exact_mut(side.max(1)).take(side);
    for (v, row) in rows.enumerate() {
        // Crop (u, v) → frame (a·u − b·v + tx, b·u + a·v + ty).
        let x = tx - b * v as i64 + first(a) - first(b);
        let y = ty + a * v as i64 + first(b) + first(a);
        match &inside {
            Some(inside) if samples.are_inside(frame, x, y, side) => match (samples.coarse, taps) {
                (true, _) => inside.fill::<4>(&samples, x, y, row, |x, y| inside.nearest(x, y)),
                (_, 1) => inside.fill::<1>(&samples, x, y, row, |x, y| inside.bilinear(x, y)),
                _ => inside.fill::<2>(&samples, x, y, row, |x, y| inside.bilinear(x, y)),
            },
            _ => samples.fill(frame, x, y, row),
        }
    }
    if frame.is_box_filtered() {
        // Filtering the crop saves the nine reads per sample that the frame's own filter takes.
        let radius = libm::roundf((BOX_PX / scale.max(1e-3) - 1.0) / 2.0);
        if radius >= 1.0 {
            box_filter(crop, (radius as usize).min(RADIUS_MAX));
        }
    }
}

/// Where the frame is sampled for a crop: `taps`×`taps` samples for each crop pixel. Coordinates
/// are 16.16 fixed point.
struct Samples {
    taps: usize,
    /// Frame x and y of a step to the next crop pixel and to the next sample of a pixel, in the
    /// crop's u.
    steps: [(i64, i64); 2],
    /// Whether samples are single pixels of the frame.
    coarse: bool,
}

impl Samples {
    /// Whether all samples of a row of `side` pixels, the first one at (x, y), have their four
    /// neighbours in the frame.
    fn are_inside(&self, frame: &Frame<'_>, x: i64, y: i64, side: usize) -> bool {
        let [(a, b), (sub_a, sub_b)] = self.steps;
        let (last, tap) = (side as i64 - 1, self.taps as i64 - 1);
        // The samples lie in a parallelogram between these corners.
        (0..8).all(|corner: i64| {
            let [u, i, j] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let x = x + a * last * u + (sub_a * i - sub_b * j) * tap;
            let y = y + b * last * u + (sub_b * i + sub_a * j) * tap;
            let within = |v: i64, size: i32| v >= 0 && v >> FRACTION < i64::from(size) - 1;
            within(x, frame.width()) && within(y, frame.height())
        })
    }

    /// Fills a row of crop pixels, the first of which has its first sample at (x, y).
    fn fill(&self, frame: &Frame<'_>, mut x: i64, mut y: i64, row: &mut [u8]) {
        let [(a, b), (sub_a, sub_b)] = self.steps;
        let area = (self.taps * self.taps).max(1) as u32;
        for pixel in row {
            let mut sum = 0;
            for j in 0..self.taps as i64 {
                for i in 0..self.taps as i64 {
                    let sx = x + sub_a * i - sub_b * j;
                    let sy = y + sub_b * i + sub_a * j;
                    sum += match self.coarse {
                        true => nearest(frame, sx, sy),
                        false => bilinear(frame, sx, sy),
                    };
                }
            }
            *pixel = ((sum + area / 2) / area) as u8;
            x += a;
            y += b;
        }
    }
}

/// The bytes of a frame whose luma is one byte, for samples that are inside of it.
struct Inside<'a> {
    bytes: &'a [u8],
    origin: isize,
    /// Bytes to the neighbour on the right.
    right: isize,
    /// Bytes to the neighbour below.
    below: isize,
}

impl<'a> Inside<'a> {
    fn of(frame: &Frame<'a>) -> Option<Self> {
        Some(Inside {
            bytes: frame.luma_bytes()?,
            origin: frame.byte_offset(0, 0),
            right: frame.byte_step(1, 0),
            below: frame.byte_step(0, 1),
        })
    }

    /// As [`Samples::fill`], for `T`×`T` samples that are inside: their coordinates fit 32 bits.
    #[inline(always)]
    fn fill<const T: usize>(
        &self,
        samples: &Samples,
        x: i64,
        y: i64,
        row: &mut [u8],
        sample: impl Fn(i32, i32) -> u32,
    ) {
        let [(a, b), (sub_a, sub_b)] = samples.steps;
        let [a, b, sub_a, sub_b] = [a, b, sub_a, sub_b].map(|step| step as i32);
        let (mut x, mut y) = (x as i32, y as i32);
        let area = (T * T).max(1) as u32;
        for pixel in row {
            let mut sum = 0;
            let (mut line_x, mut line_y) = (x, y);
            for _ in 0..T {
                let (mut sx, mut sy) = (line_x, line_y);
                for _ in 0..T {
                    sum += sample(sx, sy);
                    sx = sx.wrapping_add(sub_a);
                    sy = sy.wrapping_add(sub_b);
                }
                line_x = line_x.wrapping_sub(sub_b);
                line_y = line_y.wrapping_add(sub_a);
            }
            *pixel = ((sum + area / 2) / area) as u8;
            x = x.wrapping_add(a);
            y = y.wrapping_add(b);
        }
    }

    /// The byte at this index. One that is not there, which cannot be, reads as 0: no path
    /// panics.
    #[inline(always)]
    fn read(&self, at: isize) -> u32 {
        self.bytes.get(at as usize).map_or(0, |v| u32::from(*v))
    }

    /// As [`nearest`].
    #[inline(always)]
    fn nearest(&self, x: i32, y: i32) -> u32 {
        let round = |v: i32| ((v + (1 << (FRACTION - 1))) >> FRACTION) as isize;
        self.read(self.origin + round(x) * self.right + round(y) * self.below)
    }

    /// As [`bilinear`].
    #[inline(always)]
    fn bilinear(&self, x: i32, y: i32) -> u32 {
        let [column, row] = [x, y].map(|v| (v >> FRACTION) as isize);
        let at = self.origin + column * self.right + row * self.below;
        let read = |offset: isize| self.read(at + offset);
        let [fx, fy] = [x, y].map(|v| (v >> (FRACTION - 8) & 255) as u32);
        let top = read(0) * (256 - fx) + read(self.right) * fx;
        let bottom = read(self.below) * (256 - fx) + read(self.below + self.right) * fx;
        (top * (256 - fy) + bottom * fy + (1 << 15)) >> 16
    }
}

/// Box filter of `2·radius + 1` crop pixels along each axis; the edge pixels repeat.
fn box_filter(crop: &mut Crop, radius: usize) {
    let side = crop.side;
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
    let side = crop.side;
    let mut line = [0u8; CROP_MAX + 2 * RADIUS_MAX];
    let Some(pixels) = crop.luma.get_mut(first..) else {
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

/// Luma of the pixel nearest to (x, y) in 16.16 fixed point, 0..=255.
#[inline]
fn nearest(frame: &Frame<'_>, x: i64, y: i64) -> u32 {
    let round = |v: i64| ((v + (1 << (FRACTION - 1))) >> FRACTION) as i32;
    frame.raw_luma(round(x), round(y)).into()
}

/// Luma at (x, y) in 16.16 fixed point, 0..=255.
#[inline]
fn bilinear(frame: &Frame<'_>, x: i64, y: i64) -> u32 {
    let (ix, iy) = ((x >> FRACTION) as i32, (y >> FRACTION) as i32);
    // 8 bits of fraction are below the quantisation of the pixels themselves.
    let fx = ((x >> (FRACTION - 8)) & 255) as u32;
    let fy = ((y >> (FRACTION - 8)) & 255) as u32;
    let [a, b, c, d] = frame.raw_2x2(ix, iy).map(u32::from);
    let top = a * (256 - fx) + b * fx;
    let bottom = c * (256 - fx) + d * fx;
    (top * (256 - fy) + bottom * fy + (1 << 15)) >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::FrameLayout;

    #[test]
    fn identity_copies_and_shift_interpolates() {
        let bytes: [u8; 16] = core::array::from_fn(|i| (i * 10) as u8);
        let frame = Frame::new(&FrameLayout::grey(4, 4), &bytes).unwrap();
        let mut crop = Crop::new();
        warp(&frame, &Similarity::IDENTITY, 4, &mut crop);
        assert_eq!(crop.luma(), &bytes);
        warp(
            &frame,
            &Similarity {
                tx: 0.5,
                ..Similarity::IDENTITY
            },
            2,
            &mut crop,
        );
        assert_eq!(crop.luma(), &[5, 15, 45, 55]);
    }

    #[test]
    fn a_box_filtered_frame_gives_means() {
        // A dot and a slope, at the frame's own scale: means over 3×3.
        let mut bytes = [0u8; 64];
        bytes[3 * 8 + 3] = 90;
        (0..8).for_each(|x| bytes[7 * 8 + x] = 10 * x as u8);
        let frame = Frame::new(&FrameLayout::grey(8, 8), &bytes).unwrap();
        let mut crop = Crop::new();
        warp(&frame.box_filtered(), &Similarity::IDENTITY, 8, &mut crop);
        assert_eq!(
            [9, 18, 27, 28, 36].map(|k| crop.luma()[k]),
            [0, 10, 10, 10, 10]
        );
        assert_eq!(crop.luma()[4], 0);
        for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
            let (read, warped) = (
                frame.box_filtered().luma(x, y),
                crop.luma()[(y * 8 + x) as usize],
            );
            assert!(read.abs_diff(warped) <= 1, "{x} {y}: {read} {warped}");
        }
        // Where the frame is twice as fine, averaging its samples is filter enough.
        let half = Similarity {
            a: 2.0,
            ..Similarity::IDENTITY
        };
        let (mut raw, mut box_filtered) = (Crop::new(), Crop::new());
        warp(&frame, &half, 4, &mut raw);
        warp(&frame.box_filtered(), &half, 4, &mut box_filtered);
        assert_eq!(raw.luma(), box_filtered.luma());
    }

    #[test]
    fn downscale_averages() {
        let bytes: [u8; 16] = core::array::from_fn(|i| if i % 2 == 0 { 0 } else { 200 });
        let frame = Frame::new(&FrameLayout::grey(4, 4), &bytes).unwrap();
        let mut crop = Crop::new();
        let half = Similarity {
            a: 2.0,
            b: 0.0,
            tx: 0.5,
            ty: 0.5,
        };
        warp(&frame, &half, 2, &mut crop);
        assert_eq!(crop.luma(), &[100; 4]);
    }

    #[test]
    fn extreme_transforms_stay_inside() {
        let frame = Frame::new(&FrameLayout::grey(1, 1), &[7]).unwrap();
        let mut crop = Crop::new();
        for v in [f32::NAN, f32::INFINITY, -1e30, 1e30, 16_000.0] {
            warp(
                &frame,
                &Similarity {
                    a: v,
                    b: v,
                    tx: v,
                    ty: v,
                },
                CROP_MAX,
                &mut crop,
            );
            assert!(crop.luma().iter().all(|&l| l == 7));
        }
    }
}
