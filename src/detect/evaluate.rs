//! What the ensembles say of windows.

use super::forest::ABREAST;
use super::grid::{GRID, Pixel, mirrored};
use super::{DetectorModel, Ensemble, Window};
use crate::image::Frame;

/// Trees per unit of work beyond the first: most windows are rejected by fewer.
const TREES_PER_UNIT: usize = 16;

/// What a unit of work is on a box_filtered frame.
const SOFT: i64 = 3;

/// From a centre to each pixel of the grid, right and down \[px\].
pub(super) type Table = [[i16; 2]; GRID * GRID];
/// A table that [`Windows::new`] has not filled yet.
pub(super) const EMPTY: Table = [[0; 2]; GRID * GRID];

/// All windows of one size and roll on a frame, around its pixels.
///
/// The same pixels of the grid lie equally far from the centres of all of them. Where, is computed
/// once: it would be most of the work of a walk.
pub(super) struct Windows<'a> {
    frame: &'a Frame<'a>,
    table: &'a Table,
    /// The farthest of the grid's pixels in either direction.
    reach: [i32; 2],
}

impl<'a> Windows<'a> {
    /// The windows of this one's size and roll; fills the table.
    pub fn new(frame: &'a Frame<'a>, window: Window, table: &'a mut Table) -> Self {
        let window = window.at_pixel(0, 0);
        let mut reach = [0; 2];
        for (row, pixels) in table.chunks_exact_mut(GRID).enumerate() {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                // What is farther than that is outside of any frame, wherever the centre is.
                let near = |v: i32| v.min(i16::MAX.into()).max(i16::MIN.into());
                let far = window.frame_pixel(row, column).map(near);
                *pixel = far.map(|v| v as i16);
                reach = [reach[0].max(far[0].abs()), reach[1].max(far[1].abs())];
            }
        }
        Windows {
            frame,
            table,
            reach,
        }
    }

    /// The best score (> 0) that an ensemble gives to the window around a pixel of the frame, if any
    /// takes it for a face, and what it cost to see that \[units of work\].
    #[inline(never)]
    pub fn evaluate(&self, model: &DetectorModel<'_>, x: i32, y: i32) -> (Option<i32>, i64) {
        let (mut best, mut asked) = (None, 0);
        let (centre, box_filtered) = (self.inside(x, y), self.frame.is_box_filtered());
        for ensemble in model.ensembles() {
            let (score, trees) = match centre {
                Some(centre) if box_filtered => ensemble.evaluate(self.box_filtered(centre)),
                Some(centre) => ensemble.evaluate(self.stored(centre)),
                None => ensemble.evaluate(self.anywhere(x, y, false)),
            };
            best = best.max(score);
            asked += trees;
            if ensemble.mirrored {
                let (score, trees) = ensemble.evaluate(self.anywhere(x, y, true));
                best = best.max(score);
                asked += trees;
            }
        }
        let cost = if box_filtered { SOFT } else { 1 };
        (best, cost * (1 + (asked / TREES_PER_UNIT) as i64))
    }

    /// The luma of the grid, or of the mirrored grid, around a pixel of the frame.
    #[inline]
    fn anywhere(&self, x: i32, y: i32, mirror: bool) -> impl Fn(Pixel) -> u8 {
        move |pixel| {
            let [right, below] = self.far(if mirror { mirrored(pixel) } else { pixel });
            self.frame.luma(x + right, y + below)
        }
    }

    /// As [`Windows::anywhere`], faster, around what [`Windows::inside`] gives.
    #[inline]
    fn stored(&self, (bytes, centre): (&'a [u8], isize)) -> impl Fn(Pixel) -> u8 {
        move |pixel| {
            let at = centre + self.bytes_to(pixel);
            // It lies inside, so the fallback is never taken.
            bytes.get(at as usize).copied().unwrap_or(0)
        }
    }

    /// The same of a box_filtered frame.
    #[inline]
    fn box_filtered(&self, (_, centre): (&'a [u8], isize)) -> impl Fn(Pixel) -> u8 {
        move |pixel| self.frame.filtered_luma_at(centre + self.bytes_to(pixel))
    }

    /// The bytes of a frame that has luma in single ones, and the place of a pixel in them, if all that is
    /// read of the grid around it lies inside.
    #[inline]
    fn inside(&self, x: i32, y: i32) -> Option<(&'a [u8], isize)> {
        let (reach, frame) = (self.reach, self.frame);
        // Neighbours are read too.
        let more = i32::from(frame.is_box_filtered());
        let [across, down] = reach.map(|reach| reach.saturating_add(more));
        let left_and_up = x >= across && y >= down;
        let inside = left_and_up && x + across < frame.width() && y + down < frame.height();
        let bytes = frame.luma_bytes().filter(|_| inside)?;
        Some((bytes, frame.byte_offset(x, y)))
    }

    #[inline]
    fn bytes_to(&self, pixel: Pixel) -> isize {
        let [right, below] = self.far(pixel);
        self.frame.byte_step(right, below)
    }

    #[inline]
    fn far(&self, pixel: Pixel) -> [i32; 2] {
        let far = self.table.get(pixel as usize).copied();
        far.unwrap_or_default().map(i32::from)
    }
}

impl Ensemble<'_> {
    /// The final sum of a window that passes all thresholds, and the number of trees asked.
    fn evaluate(&self, luma: impl Fn(Pixel) -> u8) -> (Option<i32>, usize) {
        let leaves = self.forest.leaves();
        let mut sum = 0i32;
        for (group, thresholds) in self.thresholds.chunks(ABREAST).enumerate() {
            let first = group * ABREAST;
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
        // > 0 always, so that a hit weighs something.
        (Some(sum.saturating_sub(last).max(0) + 1), self.trees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{FrameLayout, PixelFormat, Rotation};

    #[test]
    fn windows_see_what_each_of_them_reads() {
        const WIDTH: u32 = 61;
        const HEIGHT: u32 = 47;
        let bytes: [u8; 4 * 64 * HEIGHT as usize] =
            core::array::from_fn(|k| (k * 7919 % 251) as u8);
        let formats = [PixelFormat::Grey, PixelFormat::Uyvy, PixelFormat::Bgrx32];
        let rotations = [Rotation::None, Rotation::Cw90, Rotation::Half];
        let mut seen_inside = [0; 2];
        for (format, rotation) in formats.into_iter().zip(rotations) {
            let layout = FrameLayout {
                format,
                stride: 256,
                rotation,
                mirrored: true,
                ..FrameLayout::grey(WIDTH, HEIGHT)
            };
            let sharp = Frame::new(&layout, &bytes).unwrap();
            let sizes = [(16, 0.0), (25, 0.5), (33, -0.5), (90, 0.5), (60_000, 1.0)];
            for ((side, roll), box_filtered) in
                sizes.into_iter().flat_map(|s| [(s, false), (s, true)])
            {
                let frame = if box_filtered {
                    sharp.box_filtered()
                } else {
                    sharp
                };
                let window = Window::new(0, 0, side * 16, roll);
                let mut table = EMPTY;
                let windows = Windows::new(&frame, window, &mut table);
                for (x, y) in (0..frame.width()).flat_map(|x| (0..9).map(move |y| (x, 5 * y))) {
                    let window = window.at_pixel(x, y);
                    let (anywhere, inside) = (windows.anywhere(x, y, false), windows.inside(x, y));
                    seen_inside[box_filtered as usize] += inside.is_some() as u32;
                    for pixel in 0..(GRID * GRID) as Pixel {
                        let expected = window.read(&frame, pixel);
                        assert_eq!(anywhere(pixel), expected, "{side} {roll} {x} {y}");
                        if let Some(centre) = inside {
                            let seen = match box_filtered {
                                true => windows.box_filtered(centre)(pixel),
                                false => windows.stored(centre)(pixel),
                            };
                            assert_eq!(seen, expected, "{side} {roll} {x} {y}");
                        }
                    }
                }
            }
        }
        assert!(seen_inside.iter().all(|n| *n > 500), "{seen_inside:?}");
    }
}
