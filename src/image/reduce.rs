//! A square of the frame reduced into a crop: the mean of the frame's pixels under each crop pixel.

use super::{CROP_MAX, Crop, Frame};

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
    match (scale_q8 as usize).div_ceil(256).min(TAPS_MAX) {
        1 => fill::<1>(frame, corner, scale_q8, crop.resized(side), side),
        2 => fill::<2>(frame, corner, scale_q8, crop.resized(side), side),
        3 => fill::<3>(frame, corner, scale_q8, crop.resized(side), side),
        _ => fill::<4>(frame, corner, scale_q8, crop.resized(side), side),
    }
}

/// The frame's column or row of sample number `index` along an axis, `T` to a crop pixel.
fn sample<const T: usize>(corner: i32, scale_q8: i32, index: usize) -> i32 {
    let middle = (2 * index as i64 + 1) * i64::from(scale_q8) / (2 * T as i64);
    // A frame has at most 2^14 pixels along an axis.
    i64::from(corner)
        .saturating_add(middle >> 8)
        .clamp(-(1 << 20), 1 << 20) as i32
}

/// Fills all rows, with `T`×`T` samples for each pixel.
fn fill<const T: usize>(
    frame: &Frame<'_>,
    [left, top]: [i32; 2],
    scale_q8: i32,
    luma: &mut [u8],
    side: usize,
) {
    let width = side * T;
    let mut columns = [0i32; CROP_MAX * TAPS_MAX];
    for (k, column) in columns.iter_mut().enumerate().take(width) {
        *column = sample::<T>(left, scale_q8, k).min(frame.width() - 1).max(0);
    }
    let Some(columns) = columns.get(..width) else {
        return;
    };
    // Of most frames and scales the samples of a row are adjacent bytes.
    let [first, last] = [columns.first(), columns.last()].map(|x| x.copied().unwrap_or(0));
    let adjacent = frame.byte_step(1, 0) == 1
        && scale_q8 == 256 * T as i32
        && left == first
        && last == first + width as i32 - 1;
    // Where a row has few bytes between its first sample and its last one, all of them are added up
    // by column, and the sums are sampled.
    let span = (last - first + 1).max(0) as usize;
    let by_column = frame.byte_step(1, 0) == 1 && span <= CROP_MAX * TAPS_MAX;
    let area = (T * T).max(1) as u16;
    for (v, pixels) in luma.chunks_exact_mut(side.max(1)).enumerate() {
        let mut sums = [0u16; CROP_MAX];
        let mut totals = [0u16; CROP_MAX * TAPS_MAX];
        for j in 0..T {
            let row = sample::<T>(top, scale_q8, v * T + j);
            let row = row.min(frame.height() - 1).max(0);
            let start = frame.byte_offset(0, row);
            match frame.luma_bytes() {
                Some(bytes) if adjacent => {
                    let from = (start + first as isize) as usize;
                    let row = bytes.get(from..from + width).unwrap_or(&[]);
                    add::<T, u8>(&mut sums, row, u16::from);
                }
                Some(bytes) if by_column => {
                    let from = (start + first as isize) as usize;
                    let row = bytes.get(from..from + span).unwrap_or(&[]);
                    let totals = totals.iter_mut().zip(row);
                    totals.for_each(|(total, v)| *total += u16::from(*v));
                }
                Some(bytes) => add::<T, i32>(&mut sums, columns, |x| {
                    let at = start + frame.byte_step(x, 0);
                    bytes.get(at as usize).copied().unwrap_or(0).into()
                }),
                None => add::<T, i32>(&mut sums, columns, |x| frame.raw_luma(x, row).into()),
            }
        }
        if by_column && !adjacent {
            add::<T, i32>(&mut sums, columns, |x| {
                totals.get((x - first) as usize).copied().unwrap_or(0)
            });
        }
        for (pixel, sum) in pixels.iter_mut().zip(sums) {
            *pixel = ((sum + area / 2) / area) as u8;
        }
    }
}

/// Adds each crop pixel's `T` samples of a row.
#[inline(always)]
fn add<const T: usize, S: Copy>(sums: &mut [u16], samples: &[S], read: impl Fn(S) -> u16) {
    for (sum, samples) in sums.iter_mut().zip(samples.as_chunks::<T>().0) {
        *sum += samples.iter().map(|s| read(*s)).sum::<u16>();
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
            for scale in [128, 256, 300, 512, 600, 768, 1024, 1500, 4000] {
                for corner in [[0, 0], [-5, 3], [30, -60], [7, 7]] {
                    reduce(&expected, corner, scale, 8, &mut a);
                    reduce(&frame, corner, scale, 8, &mut b);
                    assert_eq!(a.luma(), b.luma(), "{layout:?} {scale} {corner:?}");
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
