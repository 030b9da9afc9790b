//! A square of the frame reduced into a crop: the mean of the frame's pixels under each crop pixel.

use super::{CROP_MAX, Crop, Frame};
use core::ops::Range;

/// Most samples averaged along one axis of a crop pixel. Of a coarser reduction these are spread
/// evenly, so the work is bounded by 16 reads for each crop pixel, whatever the frame's size.
const TAPS_MAX: usize = 4;

/// Fills `crop` (`side` ≤ [`CROP_MAX`]) with the frame's luma: crop pixel (u, v) is the mean of the
/// square of `scale_q8` \[1/256 frame px\] whose upper left corner is at `corner` + `scale_q8` ·
/// (u, v). Outside of the frame the nearest pixel counts. Up to a scale of 4 that is a whole number
/// every pixel is read; otherwise up to 4×4 samples are, each the pixel that it falls into.
///
/// The frame's box filter is left out: a mean of several pixels needs none. Arithmetic is integer:
/// the same bytes on every machine.
pub fn reduce(frame: &Frame<'_>, corner: [i32; 2], scale_q8: i32, side: usize, crop: &mut Crop) {
    let scale_q8 = scale_q8.max(1);
    let side = side.min(CROP_MAX);
    let samples = Samples {
        corner,
        scale_q8,
        taps: (scale_q8 as usize).div_ceil(256).min(TAPS_MAX),
    };
    let luma = crop.resized(side);
    // As many columns of the crop at a time as lie in few bytes of the frame.
    let (bytes, together) = match (frame.luma_bytes(), frame.byte_step(1, 0)) {
        (Some(bytes), step @ 1..=2) if scale_q8 < SPARSE_Q8 => {
            let together = (SPAN_MAX << 8) / (scale_q8 as usize * step as usize).max(1);
            (Some(bytes), together.clamp(1, CROP_MAX))
        }
        _ => (None, CROP_MAX),
    };
    for first in (0..side).step_by(together) {
        let columns = first..side.min(first + together);
        match bytes {
            Some(bytes) => samples.fill_dense(frame, bytes, luma, side, columns),
            None => samples.fill_sparse(frame, luma, side),
        }
    }
}

/// Bytes of a frame's row that are added up together.
const SPAN_MAX: usize = CROP_MAX * TAPS_MAX;

/// From this scale on \[1/256\] so few of a row's bytes are samples that each is read by itself.
const SPARSE_Q8: i32 = 64 << 8;

/// Where a crop samples the frame: `taps`×`taps` times for each of its pixels.
struct Samples {
    corner: [i32; 2],
    scale_q8: i32,
    taps: usize,
}

impl Samples {
    /// The frame's column or row of sample number `index` along an axis of `size` pixels.
    fn at(&self, corner: i32, size: i32, index: usize) -> i32 {
        let samples = (2 * self.taps as i64).max(1);
        let middle = (2 * index as i64 + 1) * i64::from(self.scale_q8) / samples;
        // A frame has at most 2^14 pixels along an axis.
        let at = i64::from(corner).saturating_add(middle >> 8);
        at.clamp(-(1 << 20), 1 << 20)
            .min(i64::from(size) - 1)
            .max(0) as i32
    }

    /// The frame's column of a sample.
    fn column(&self, frame: &Frame<'_>, index: usize) -> i32 {
        self.at(self.corner[0], frame.width(), index)
    }

    /// The frame's row of a sample.
    fn row(&self, frame: &Frame<'_>, index: usize) -> i32 {
        self.at(self.corner[1], frame.height(), index)
    }

    fn mean(&self, sum: u16) -> u8 {
        let area = ((self.taps * self.taps) as u16).max(1);
        ((sum + area / 2) / area) as u8
    }

    /// Fills some columns of all rows. All bytes between a row's first sample and its last one are
    /// added up by column, and the sums are sampled.
    fn fill_dense(
        &self,
        frame: &Frame<'_>,
        bytes: &[u8],
        luma: &mut [u8],
        side: usize,
        of_crop: Range<usize>,
    ) {
        let taps = self.taps;
        let indices = of_crop.start * taps..of_crop.end * taps;
        let first = self.column(frame, indices.start);
        let mut offsets = [0u16; SPAN_MAX];
        let mut span = 0;
        for (offset, k) in offsets.iter_mut().zip(indices.clone()) {
            *offset = frame.byte_step(self.column(frame, k) - first, 0) as u16;
            span = usize::from(*offset) + 1;
        }
        let offsets = offsets.get(..indices.len()).unwrap_or(&[]);
        let mut totals = [0u16; SPAN_MAX];
        for (v, pixels) in luma.chunks_exact_mut(side.max(1)).enumerate() {
            let rows: [&[u8]; TAPS_MAX] = core::array::from_fn(|j| {
                let from = frame.byte_offset(first, self.row(frame, v * taps + j)) as usize;
                bytes.get(from..from + span).unwrap_or(&[])
            });
            let mut sums = [0u16; CROP_MAX];
            match taps {
                1 => sample::<1>(&rows, &mut totals, offsets, &mut sums),
                2 => sample::<2>(&rows, &mut totals, offsets, &mut sums),
                3 => sample::<3>(&rows, &mut totals, offsets, &mut sums),
                _ => sample::<TAPS_MAX>(&rows, &mut totals, offsets, &mut sums),
            }
            let pixels = pixels.get_mut(of_crop.clone()).unwrap_or(&mut []);
            for (pixel, sum) in pixels.iter_mut().zip(sums) {
                *pixel = self.mean(sum);
            }
        }
    }

    /// Fills all rows, one sample after the other.
    fn fill_sparse(&self, frame: &Frame<'_>, luma: &mut [u8], side: usize) {
        let mut columns = [0i32; SPAN_MAX];
        for (k, column) in columns.iter_mut().enumerate().take(side * self.taps) {
            *column = self.column(frame, k);
        }
        for (v, pixels) in luma.chunks_exact_mut(side.max(1)).enumerate() {
            let mut sums = [0u16; CROP_MAX];
            for j in 0..self.taps {
                let row = self.row(frame, v * self.taps + j);
                let start = frame.byte_offset(0, row);
                let columns = columns.chunks_exact(self.taps.max(1));
                for (sum, columns) in sums.iter_mut().zip(columns).take(side) {
                    for x in columns {
                        *sum += u16::from(match frame.luma_bytes() {
                            Some(bytes) => {
                                let at = start + frame.byte_step(*x, 0);
                                bytes.get(at as usize).copied().unwrap_or(0)
                            }
                            None => frame.raw_luma(*x, row),
                        });
                    }
                }
            }
            for (pixel, sum) in pixels.iter_mut().zip(sums) {
                *pixel = self.mean(sum);
            }
        }
    }
}

/// Adds up the first `T` rows, which are equally long, column by column, and each crop pixel's `T`
/// samples of these totals.
fn sample<const T: usize>(
    rows: &[&[u8]; TAPS_MAX],
    totals: &mut [u16; SPAN_MAX],
    offsets: &[u16],
    sums: &mut [u16; CROP_MAX],
) {
    const LANES: usize = 16;
    let rows = rows.first_chunk::<T>().unwrap_or(&[&[]; T]);
    let lanes = rows.map(|row| row.as_chunks::<LANES>());
    let whole = lanes.first().map_or(0, |(lanes, _)| lanes.len());
    let (by_lanes, _) = totals.as_chunks_mut::<LANES>();
    for (k, totals) in by_lanes.iter_mut().enumerate().take(whole) {
        let mut sums = [0u16; LANES];
        for (lanes, _) in lanes {
            let both = sums.iter_mut().zip(lanes.get(k).unwrap_or(&[0; LANES]));
            both.for_each(|(sum, v)| *sum += u16::from(*v));
        }
        *totals = sums;
    }
    let rest = totals.iter_mut().skip(whole * LANES);
    for (i, total) in rest.take(LANES).enumerate() {
        let column = lanes.iter().filter_map(|(_, rest)| rest.get(i));
        *total = column.map(|v| u16::from(*v)).sum();
    }
    for (sum, offsets) in sums.iter_mut().zip(offsets.as_chunks::<T>().0) {
        // The remainder, which changes nothing, saves a check.
        let samples = offsets.iter().map(|at| totals[usize::from(*at) % SPAN_MAX]);
        *sum = samples.sum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{FrameLayout, PixelFormat, Rotation};

    #[test]
    fn whole_scales_are_means_of_all_pixels() {
        let bytes: [u8; 24 * 24] = core::array::from_fn(|k| (k * 7919 % 251) as u8);
        let frame = Frame::new(&FrameLayout::grey(24, 24), &bytes).unwrap();
        let mut crop = Crop::new();
        for scale in 1..=4usize {
            reduce(&frame, [0, 0], 256 * scale as i32, 24 / scale, &mut crop);
            for (k, v) in crop.luma().iter().enumerate() {
                let (x, y) = (k % (24 / scale) * scale, k / (24 / scale) * scale);
                let sum: u32 = (0..scale * scale)
                    .map(|i| u32::from(bytes[(y + i / scale) * 24 + x + i % scale]))
                    .sum();
                let area = (scale * scale) as u32;
                assert_eq!(u32::from(*v), (sum + area / 2) / area, "{scale} {k}");
            }
        }
    }

    #[test]
    fn every_layout_gives_the_same_bytes() {
        const SIDE: u32 = 40;
        let at = |x: i32, y: i32| (x * 37 + y * 91 + x * y) as u8;
        let upright: [u8; 1600] = core::array::from_fn(|k| at(k as i32 % 40, k as i32 / 40));
        let expected = Frame::new(&FrameLayout::grey(SIDE, SIDE), &upright).unwrap();
        let mirrored: [u8; 1600] = core::array::from_fn(|k| at(39 - k as i32 % 40, k as i32 / 40));
        let quarter: [u8; 1600] = core::array::from_fn(|k| at(39 - k as i32 / 40, k as i32 % 40));
        let yuyv: [u8; 3200] =
            core::array::from_fn(|k| if k % 2 == 0 { upright[k / 2] } else { 128 });
        let rgb: [u8; 4800] = core::array::from_fn(|k| upright[k / 3]);
        let grey = FrameLayout::grey(SIDE, SIDE);
        let format = |format, stride| FrameLayout {
            format,
            stride,
            ..grey
        };
        let cases: [(FrameLayout, &[u8]); 4] = [
            (
                FrameLayout {
                    mirrored: true,
                    ..grey
                },
                &mirrored,
            ),
            (
                FrameLayout {
                    rotation: Rotation::Cw90,
                    ..grey
                },
                &quarter,
            ),
            (format(PixelFormat::Yuyv, 2 * SIDE), &yuyv),
            (format(PixelFormat::Rgb24, 3 * SIDE), &rgb),
        ];
        let (mut a, mut b) = (Crop::new(), Crop::new());
        for (layout, bytes) in &cases {
            let frame = Frame::new(layout, bytes).unwrap();
            for scale in [128, 256, 300, 512, 600, 768, 1024, 1500, 4000, 9000, 20_000] {
                for corner in [[0, 0], [-5, 3], [30, -60], [7, 7], [-900, -70]] {
                    for side in [8, CROP_MAX] {
                        reduce(&expected, corner, scale, side, &mut a);
                        reduce(&frame, corner, scale, side, &mut b);
                        assert_eq!(a.luma(), b.luma(), "{layout:?} {scale} {corner:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn extreme_places_stay_inside() {
        let frame = Frame::new(&FrameLayout::grey(1, 1), &[7]).unwrap();
        let mut crop = Crop::new();
        for corner in [[i32::MIN; 2], [i32::MAX; 2], [0; 2]] {
            for scale in [i32::MIN, 0, 1, 700, i32::MAX] {
                reduce(&frame, corner, scale, CROP_MAX + 1, &mut crop);
                assert_eq!(crop.side(), CROP_MAX);
                assert!(crop.luma().iter().all(|l| *l == 7));
            }
        }
    }
}
