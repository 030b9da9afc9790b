//! Cuts a crop out of a frame by a similarity transform.

use super::Frame;
use super::box_filter::{RADIUS_MAX, box_filter};
use super::crop::{CROP_MAX, Crop};
use crate::math::Similarity;

/// Bits after the point of a sampling coordinate.
const FRACTION: u32 = 16;

/// Most samples averaged along one axis of a crop pixel when the frame is finer than the crop.
const TAPS_MAX: i32 = 4;
/// From this scale on \[frame px per crop px\] a crop pixel is the mean of 4×4 single pixels of the
/// frame: interpolation would read four times as many for nearly the same mean. Below, 2×2
/// interpolated samples at most take as many reads.
const COARSE_SCALE: f32 = 2.5;

/// Crop pixels of a row that are filled together where not all of the row is inside of the frame.
const PIECE: usize = 16;

/// Width of a frame's box filter \[frame px\].
const BOX_PX: f32 = 3.0;

/// Fills `crop` (`side` ≤ [`CROP_MAX`]) with the frame's luma: crop pixel (u, v) shows the frame at
/// `to_frame` × (u, v). Bilinear. Where the frame is finer than the crop, each pixel averages up to
/// 4×4 samples, so the work is bounded by 16 `side`². Of a box-filtered frame the crop is filtered
/// instead, with a box that is as wide in the frame as nearly as an odd number of crop pixels can
/// be.
///
/// Arithmetic is 16.16 fixed point: the same bytes on every machine.
pub fn warp(frame: &Frame<'_>, to_frame: &Similarity, side: usize, crop: &mut Crop) {
    let side = side.min(CROP_MAX);
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
    let edges = inside.as_ref().and_then(|inside| Edges::of(inside, frame));
    // Crop (u, v) → frame (a·u − b·v + tx, b·u + a·v + ty).
    let start = |v: usize| {
        let x = tx - b * v as i64 + first(a) - first(b);
        (x, ty + a * v as i64 + first(b) + first(a))
    };
    let row_is_inside = |v: usize| {
        let (x, y) = start(v);
        samples.are_inside(frame, x, y, side)
    };
    // All rows lie between the first and the last one.
    let all_inside = row_is_inside(0) && row_is_inside(side.saturating_sub(1));
    let rows = crop.resized(side).chunks_exact_mut(side.max(1));
    for (v, row) in rows.enumerate() {
        let (x, y) = start(v);
        // A row that is not all inside is so for the most part.
        let is_inside = all_inside || row_is_inside(v);
        let piece = if is_inside { side } else { PIECE };
        for (k, row) in row.chunks_mut(piece.max(1)).enumerate() {
            let first = (k * piece) as i64;
            let (x, y) = (x + a * first, y + b * first);
            match &inside {
                Some(inside) if is_inside || samples.are_inside(frame, x, y, row.len()) => {
                    inside.fill(&samples, x, y, row);
                }
                _ => match &edges {
                    Some(edges) if samples.fit_32_bits(x, y, row.len()) => {
                        edges.fill(&samples, x, y, row);
                    }
                    _ => samples.fill(frame, x, y, row),
                },
            }
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
    /// The steps, of samples that are inside of a frame.
    fn steps_32(&self) -> [(i32, i32); 2] {
        self.steps.map(|(a, b)| (a as i32, b as i32))
    }

    /// Whether all samples of a row of `side` pixels, the first one at (x, y), have their four
    /// neighbours in the frame.
    fn are_inside(&self, frame: &Frame<'_>, x: i64, y: i64, side: usize) -> bool {
        let within = |v: i64, size: i32| v >= 0 && v >> FRACTION < i64::from(size) - 1;
        self.are_all(x, y, side, |x, y| {
            within(x, frame.width()) && within(y, frame.height())
        })
    }

    /// Whether the coordinates of all samples of such a row fit 32 bits.
    fn fit_32_bits(&self, x: i64, y: i64, side: usize) -> bool {
        let fits = |v: i64| v.abs() <= 1 << 30;
        self.are_all(x, y, side, |x, y| fits(x) && fits(y))
    }

    /// Whether something is true of all samples of such a row if it is of the outermost ones.
    fn are_all(&self, x: i64, y: i64, side: usize, holds: impl Fn(i64, i64) -> bool) -> bool {
        let [(a, b), (sub_a, sub_b)] = self.steps;
        let (last, tap) = (side as i64 - 1, self.taps as i64 - 1);
        // The samples lie in a parallelogram between these corners.
        (0..8).all(|corner: i64| {
            let [u, i, j] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let x = x + a * last * u + (sub_a * i - sub_b * j) * tap;
            let y = y + b * last * u + (sub_b * i + sub_a * j) * tap;
            holds(x, y)
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

/// Where samples are read, whose coordinates fit 32 bits.
trait Source {
    /// As [`Source::fill`], for samples that are single pixels.
    fn fill_coarse(&self, samples: &Samples, x: i64, y: i64, row: &mut [u8]);

    /// Adds a row of interpolated samples, from (x, y) on and this far from each other, to the
    /// sums.
    fn add_samples(&self, at: (i32, i32), step: (i32, i32), sums: &mut [u16]);

    /// As [`Samples::fill`].
    #[inline(always)]
    fn fill(&self, samples: &Samples, x: i64, y: i64, row: &mut [u8]) {
        let add = |at, step, sums: &mut [u16]| self.add_samples(at, step, sums);
        match (samples.coarse, samples.taps) {
            (true, _) => self.fill_coarse(samples, x, y, row),
            (_, 1) => fill_fine::<1>(samples, x, y, row, add),
            _ => fill_fine::<2>(samples, x, y, row, add),
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

    /// The byte at this index. One that is not there, which cannot be, reads as 0: no path
    /// panics.
    #[inline(always)]
    fn read(&self, at: isize) -> u8 {
        self.bytes.get(at as usize).copied().unwrap_or(0)
    }

    /// As [`nearest`].
    #[inline(always)]
    fn nearest(&self, x: i32, y: i32) -> u32 {
        let round = |v: i32| ((v + (1 << (FRACTION - 1))) >> FRACTION) as isize;
        let at = self.origin + round(x) * self.right + round(y) * self.below;
        self.read(at).into()
    }

    /// The same, of a frame with [`Self::near_rows`].
    #[inline(always)]
    fn near(&self, (origin, below): (i32, i32), x: i32, y: i32) -> u32 {
        let [x, y] = [x, y].map(|v| (v + (1 << (FRACTION - 1))) >> FRACTION);
        let at = origin.wrapping_add(x).wrapping_add(y.wrapping_mul(below));
        self.read(at as u32 as isize).into()
    }

    /// Reads the four neighbours of a row of samples: each pair has the left one in its lower byte.
    #[inline(always)]
    fn read_pairs<'p>(
        &self,
        (mut x, mut y): (i32, i32),
        (a, b): (i32, i32),
        pairs: impl Iterator<Item = (&'p mut u16, &'p mut u16)>,
    ) {
        let pair = |at: isize| u16::from_le_bytes([self.read(at), self.read(at + self.right)]);
        for (top, bottom) in pairs {
            let [column, row] = [x, y].map(|v| (v >> FRACTION) as isize);
            let at = self.origin + column * self.right + row * self.below;
            (*top, *bottom) = (pair(at), pair(at + self.below));
            x = x.wrapping_add(a);
            y = y.wrapping_add(b);
        }
    }

    /// Origin and bytes to the next row of a frame whose pixels are bytes side by side, its rows
    /// from the top, and whose offsets fit 32 bits: [`Self::read_near_pairs`] reads such a frame.
    fn near_rows(&self) -> Option<(i32, i32)> {
        let fits = self.right == 1 && self.below > 0 && i32::try_from(self.bytes.len()).is_ok();
        let rows = i32::try_from(self.origin)
            .ok()
            .zip(i32::try_from(self.below).ok());
        rows.filter(|_| fits)
    }

    /// As [`Self::read_pairs`], with one check of bounds for both pairs.
    #[inline(always)]
    fn read_near_pairs<'p>(
        &self,
        (mut x, mut y): (i32, i32),
        (a, b): (i32, i32),
        pairs: impl Iterator<Item = (&'p mut u16, &'p mut u16)>,
        (origin, below): (i32, i32),
    ) {
        let span = below as usize + 2;
        for (top, bottom) in pairs {
            let row = (y >> FRACTION).wrapping_mul(below);
            let at = origin.wrapping_add(x >> FRACTION).wrapping_add(row) as u32 as usize;
            let read = self.bytes.get(at..at.wrapping_add(span)).and_then(|bytes| {
                let bottom = bytes.get(below as usize..)?.first_chunk()?;
                Some((*bytes.first_chunk()?, *bottom))
            });
            // One that is not there, which cannot be, reads as 0.
            let (of_top, of_bottom) = read.unwrap_or_default();
            (*top, *bottom) = (u16::from_le_bytes(of_top), u16::from_le_bytes(of_bottom));
            x = x.wrapping_add(a);
            y = y.wrapping_add(b);
        }
    }
}

impl Source for Inside<'_> {
    #[inline(always)]
    fn fill_coarse(&self, samples: &Samples, x: i64, y: i64, row: &mut [u8]) {
        match self.near_rows() {
            Some(rows) => fill_coarse(samples, x, y, row, |x, y| self.near(rows, x, y)),
            None => fill_coarse(samples, x, y, row, |x, y| self.nearest(x, y)),
        }
    }

    // All pixels are read first, so that the compiler computes the rest in vectors.
    fn add_samples(&self, (x, y): (i32, i32), (a, b): (i32, i32), sums: &mut [u16]) {
        let [mut tops, mut bottoms] = [[0u16; CROP_MAX]; 2];
        let pairs = tops.iter_mut().zip(&mut bottoms).take(sums.len());
        match self.near_rows() {
            Some(rows) => self.read_near_pairs((x, y), (a, b), pairs, rows),
            None => self.read_pairs((x, y), (a, b), pairs),
        }
        // As [`bilinear`]: nothing overflows 16 bits before the second interpolation.
        let (mut x, mut y) = (x as u32, y as u32);
        for ((top, bottom), sum) in tops.iter().zip(&bottoms).zip(sums) {
            let [fx, fy] = [x, y].map(|v| (v >> (FRACTION - 8) & 255) as u16);
            let [top, bottom] =
                [top, bottom].map(|pair| (pair & 255) * (256 - fx) + (pair >> 8) * fx);
            let value = u32::from(top) * u32::from(256 - fy) + u32::from(bottom) * u32::from(fy);
            *sum += ((value + (1 << 15)) >> 16) as u16;
            x = x.wrapping_add(a as u32);
            y = y.wrapping_add(b as u32);
        }
    }
}

/// The same bytes, for samples that may be outside of the frame: such a one shows the nearest
/// pixel, as one whose coordinates are moved to the edge does.
struct Edges<'a> {
    inside: &'a Inside<'a>,
    rows: (i32, i32),
    /// Width and height \[px\], at least 2.
    size: [i32; 2],
}

impl<'a> Edges<'a> {
    fn of(inside: &'a Inside<'a>, frame: &Frame<'_>) -> Option<Self> {
        let size = [frame.width(), frame.height()];
        let rows = inside.near_rows()?;
        (size.iter().min() >= Some(&2)).then_some(Edges { inside, rows, size })
    }

    /// Coordinates, not beyond the centres of the outermost pixels.
    #[inline(always)]
    fn moved(&self, at: [i32; 2]) -> [i32; 2] {
        let [x, y] = at;
        let [width, height] = self.size;
        let within = |v: i32, size: i32| v.max(0).min(size.wrapping_sub(1) << FRACTION);
        [within(x, width), within(y, height)]
    }
}

impl Source for Edges<'_> {
    fn fill_coarse(&self, samples: &Samples, x: i64, y: i64, row: &mut [u8]) {
        fill_coarse(samples, x, y, row, |x, y| {
            let [x, y] = self.moved([x, y]);
            self.inside.near(self.rows, x, y)
        });
    }

    // Of the last pixel of a row or column, the neighbour before it has no weight.
    fn add_samples(&self, (mut x, mut y): (i32, i32), (a, b): (i32, i32), sums: &mut [u16]) {
        let (origin, below) = self.rows;
        let [width, height] = self.size;
        // The pixel before a coordinate, of which there is a next one, and the weight of that.
        let before = |at: i32, size: i32| {
            let first = (at >> FRACTION).min(size.wrapping_sub(2));
            let rest = at.wrapping_sub(first << FRACTION);
            (first, (rest >> (FRACTION - 8)) as u32)
        };
        for sum in sums {
            let [near_x, near_y] = self.moved([x, y]);
            let (column, fx) = before(near_x, width);
            let (row, fy) = before(near_y, height);
            let at = origin
                .wrapping_add(column)
                .wrapping_add(row.wrapping_mul(below));
            let [top, bottom] = [at, at.wrapping_add(below)].map(|at| {
                let pair = self.inside.bytes.get(at as u32 as usize..);
                let [left, right] = *pair.and_then(|pair| pair.first_chunk()).unwrap_or(&[0; 2]);
                u32::from(left) * (256 - fx) + u32::from(right) * fx
            });
            let value = top * (256 - fy) + bottom * fy;
            *sum = sum.wrapping_add(((value + (1 << 15)) >> 16) as u16);
            x = x.wrapping_add(a);
            y = y.wrapping_add(b);
        }
    }
}

/// Fills a row of crop pixels with means of `T`×`T` samples each, of which `add` adds a row of so
/// many to sums.
#[inline(always)]
fn fill_fine<const T: usize>(
    samples: &Samples,
    x: i64,
    y: i64,
    row: &mut [u8],
    add: impl Fn((i32, i32), (i32, i32), &mut [u16]),
) {
    let [step, (sub_a, sub_b)] = samples.steps_32();
    let mut sums = [0; CROP_MAX];
    let sums = sums.get_mut(..row.len()).unwrap_or(&mut []);
    let (mut line_x, mut line_y) = (x as i32, y as i32);
    for _ in 0..T {
        let (mut sx, mut sy) = (line_x, line_y);
        for _ in 0..T {
            add((sx, sy), step, sums);
            sx = sx.wrapping_add(sub_a);
            sy = sy.wrapping_add(sub_b);
        }
        line_x = line_x.wrapping_sub(sub_b);
        line_y = line_y.wrapping_add(sub_a);
    }
    let area = (T * T).max(1) as u16;
    for (pixel, sum) in row.iter_mut().zip(sums) {
        *pixel = ((*sum + area / 2) / area) as u8;
    }
}

/// Fills a row of crop pixels with means of [`TAPS_MAX`]² samples each.
#[inline(always)]
fn fill_coarse(
    samples: &Samples,
    x: i64,
    y: i64,
    row: &mut [u8],
    sample: impl Fn(i32, i32) -> u32,
) {
    let [(a, b), (sub_a, sub_b)] = samples.steps_32();
    let (mut x, mut y) = (x as i32, y as i32);
    let area = (TAPS_MAX * TAPS_MAX) as u32;
    for pixel in row {
        let mut sum = 0;
        let (mut line_x, mut line_y) = (x, y);
        for _ in 0..TAPS_MAX {
            let (mut sx, mut sy) = (line_x, line_y);
            for _ in 0..TAPS_MAX {
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

    /// Rows that are partly outside have the bytes that one sample after the other gives.
    #[test]
    fn edges_are_as_sampled_one_by_one() {
        let bytes: [u8; 24 * 20] = core::array::from_fn(|i| (i * 37 % 251) as u8);
        let frame = Frame::new(&FrameLayout::grey(24, 20), &bytes).unwrap();
        for (a, b) in [
            (0.7, 0.2),
            (1.0, 0.0),
            (1.3, -0.6),
            (2.1, 1.2),
            (3.0, 0.4),
            (9.0, 2.0),
        ] {
            for (tx, ty) in [(-7.3, -5.1), (10.0, 9.5), (23.0, 19.0), (60.0, -80.0)] {
                let to_frame = Similarity { a, b, tx, ty };
                let (mut crop, mut expected) = (Crop::new(), Crop::new());
                warp(&frame, &to_frame, 16, &mut crop);
                // A frame whose pixels are not side by side has no other way.
                let wide: [u8; 2 * 24 * 20] = core::array::from_fn(|i| bytes[i / 2]);
                let layout = FrameLayout {
                    format: crate::image::PixelFormat::Yuyv,
                    stride: 48,
                    ..FrameLayout::grey(24, 20)
                };
                let other = Frame::new(&layout, &wide).unwrap();
                warp(&other, &to_frame, 16, &mut expected);
                assert_eq!(crop.luma(), expected.luma(), "{a} {b} {tx} {ty}");
            }
        }
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
