//! Evaluates windows with the ensembles of a model.

use super::forest::PARALLEL_TREES;
use super::grid::{GRID, Pixel, mirrored};
use super::{DetectorModel, Ensemble, Window};
use crate::image::Frame;

/// Trees per unit of work beyond the first unit: most windows are rejected by fewer.
const TREES_PER_UNIT: usize = 16;

/// Cost of a unit of work on a box-filtered frame, in those of another frame.
const BOX_FILTERED_UNITS: i64 = 3;

/// Offset from a window's centre to each pixel of its grid: right and down \[frame px\].
pub(super) type OffsetTable = [[i16; 2]; GRID * GRID];
/// A table that [`WindowGrid::new`] has not filled yet.
pub(super) const EMPTY_TABLE: OffsetTable = [[0; 2]; GRID * GRID];

/// All windows of one size and roll that are centred on pixels of a frame.
///
/// A pixel of the grid has the same offset from the centre in all of them. The offsets are computed
/// once: they would be most of the work of a tree's walk.
pub(super) struct WindowGrid<'a> {
    frame: &'a Frame<'a>,
    offsets: &'a OffsetTable,
    /// Largest offset across and down \[frame px\].
    reach: [i32; 2],
}

impl<'a> WindowGrid<'a> {
    /// The windows of this one's size and roll; fills the table.
    pub fn new(frame: &'a Frame<'a>, window: Window, offsets: &'a mut OffsetTable) -> Self {
        let window = window.at_pixel(0, 0);
        let mut reach = [0; 2];
        for (row, pixels) in offsets.chunks_exact_mut(GRID).enumerate() {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                // What is clamped lies outside of any frame, wherever the centre is.
                let clamp = |v: i32| v.min(i16::MAX.into()).max(i16::MIN.into());
                let offset = window.frame_pixel(row, column).map(clamp);
                *pixel = offset.map(|v| v as i16);
                reach = [reach[0].max(offset[0].abs()), reach[1].max(offset[1].abs())];
            }
        }
        WindowGrid {
            frame,
            offsets,
            reach,
        }
    }

    /// Evaluates the window around a pixel of the frame: the best score (> 0) of the ensembles that
    /// accept it as a face, if any, and the cost \[units of work\].
    #[inline(never)]
    pub fn evaluate(&self, model: &DetectorModel<'_>, x: i32, y: i32) -> (Option<i32>, i64) {
        let (mut best, mut trees_used) = (None, 0);
        let (interior, box_filtered) = (self.interior(x, y), self.frame.is_box_filtered());
        for ensemble in &model.ensembles {
            let (score, trees) = match interior {
                Some(centre) if box_filtered => ensemble.evaluate(self.filtered_luma(centre)),
                Some(centre) => ensemble.evaluate(self.raw_luma(centre)),
                None => ensemble.evaluate(self.clamped_luma(x, y, false)),
            };
            best = best.max(score);
            trees_used += trees;
            if ensemble.mirrored {
                let (score, trees) = ensemble.evaluate(self.clamped_luma(x, y, true));
                best = best.max(score);
                trees_used += trees;
            }
        }
        let cost = if box_filtered { BOX_FILTERED_UNITS } else { 1 };
        (best, cost * (1 + (trees_used / TREES_PER_UNIT) as i64))
    }

    /// Luma of the grid, or of the mirrored grid, around a pixel of the frame; outside the frame,
    /// that of the nearest pixel.
    #[inline]
    fn clamped_luma(&self, x: i32, y: i32, mirror: bool) -> impl Fn(Pixel) -> u8 {
        move |pixel| {
            let [right, below] = self.offset(if mirror { mirrored(pixel) } else { pixel });
            self.frame.luma(x + right, y + below)
        }
    }

    /// As [`WindowGrid::clamped_luma`], faster, for what [`WindowGrid::interior`] returns of a
    /// frame that is not box-filtered.
    #[inline]
    fn raw_luma(&self, (bytes, centre): (&'a [u8], isize)) -> impl Fn(Pixel) -> u8 {
        move |pixel| {
            let at = centre + self.byte_step(pixel);
            // An interior window lies inside the bytes, so the fallback is never taken.
            bytes.get(at as usize).copied().unwrap_or(0)
        }
    }

    /// As [`WindowGrid::raw_luma`], of a box-filtered frame.
    #[inline]
    fn filtered_luma(&self, (_, centre): (&'a [u8], isize)) -> impl Fn(Pixel) -> u8 {
        move |pixel| self.frame.filtered_luma_at(centre + self.byte_step(pixel))
    }

    /// The frame's bytes of luma and the byte offset of a pixel, if luma is one byte and all pixels
    /// that are read for the grid around that pixel lie inside the frame.
    #[inline]
    fn interior(&self, x: i32, y: i32) -> Option<(&'a [u8], isize)> {
        let (reach, frame) = (self.reach, self.frame);
        // The box filter reads the neighbours too.
        let more = i32::from(frame.is_box_filtered());
        let [across, down] = reach.map(|reach| reach.saturating_add(more));
        let left_and_up = x >= across && y >= down;
        let inside = left_and_up && x + across < frame.width() && y + down < frame.height();
        let bytes = frame.luma_bytes().filter(|_| inside)?;
        Some((bytes, frame.byte_offset(x, y)))
    }

    #[inline]
    fn byte_step(&self, pixel: Pixel) -> isize {
        let [right, below] = self.offset(pixel);
        self.frame.byte_step(right, below)
    }

    #[inline]
    fn offset(&self, pixel: Pixel) -> [i32; 2] {
        let offset = self.offsets.get(pixel as usize).copied();
        offset.unwrap_or_default().map(i32::from)
    }
}

impl Ensemble<'_> {
    /// The final sum of a window that passes all thresholds, and the number of trees used.
    fn evaluate(&self, luma: impl Fn(Pixel) -> u8) -> (Option<i32>, usize) {
        let leaves = self.forest.leaves();
        let mut sum = 0i32;
        for (group, thresholds) in self.thresholds.chunks(PARALLEL_TREES).enumerate() {
            let first = group * PARALLEL_TREES;
            let reached = self.forest.walk(first, &luma);
            for ((tree, leaf), threshold) in (first..).zip(reached).zip(thresholds) {
                let value = self.leaves.get(tree * leaves + leaf).copied().unwrap_or(0);
                sum += value as i32;
                if sum < *threshold {
                    return (None, tree + 1);
                }
            }
        }
        let last = self.thresholds.last().copied().unwrap_or(0);
        // Always > 0, so that every hit has a weight. Both are at most SUM_MAX.
        (Some((sum - last).max(0) + 1), self.trees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{FrameLayout, PixelFormat, Rotation};

    #[test]
    fn fast_and_slow_reads_agree_with_each_window() {
        const WIDTH: u32 = 61;
        const HEIGHT: u32 = 47;
        let bytes: [u8; 4 * 64 * HEIGHT as usize] =
            core::array::from_fn(|k| (k * 7919 % 251) as u8);
        let formats = [PixelFormat::Grey, PixelFormat::Uyvy, PixelFormat::Bgrx32];
        let rotations = [Rotation::None, Rotation::Cw90, Rotation::Half];
        let mut interior_count = [0; 2];
        for (format, rotation) in formats.into_iter().zip(rotations) {
            let layout = FrameLayout {
                format,
                stride: 256,
                rotation,
                mirrored: true,
                ..FrameLayout::grey(WIDTH, HEIGHT)
            };
            let raw = Frame::new(&layout, &bytes).unwrap();
            let sizes = [(16, 0.0), (25, 0.5), (33, -0.5), (90, 0.5), (60_000, 1.0)];
            for ((side, roll), box_filtered) in
                sizes.into_iter().flat_map(|s| [(s, false), (s, true)])
            {
                let frame = if box_filtered {
                    raw.box_filtered()
                } else {
                    raw
                };
                let window = Window::new(0, 0, side * 16, roll);
                let mut table = EMPTY_TABLE;
                let windows = WindowGrid::new(&frame, window, &mut table);
                for (x, y) in (0..frame.width()).flat_map(|x| (0..9).map(move |y| (x, 5 * y))) {
                    let window = window.at_pixel(x, y);
                    let clamped = windows.clamped_luma(x, y, false);
                    let interior = windows.interior(x, y);
                    interior_count[box_filtered as usize] += interior.is_some() as u32;
                    for pixel in 0..(GRID * GRID) as Pixel {
                        let expected = window.read(&frame, pixel);
                        assert_eq!(clamped(pixel), expected, "{side} {roll} {x} {y}");
                        if let Some(centre) = interior {
                            let fast = match box_filtered {
                                true => windows.filtered_luma(centre)(pixel),
                                false => windows.raw_luma(centre)(pixel),
                            };
                            assert_eq!(fast, expected, "{side} {roll} {x} {y}");
                        }
                    }
                }
            }
        }
        assert!(
            interior_count.iter().all(|n| *n > 500),
            "{interior_count:?}"
        );
    }
}
