//! A square window on the frame, and what the ensembles say of it.

use super::{DetectorModel, Ensemble};
use crate::image::{Frame, MAX_SIDE};

/// Bits after the point of a pixel coordinate while an offset is turned and scaled.
const FRACTION: u32 = 14;
/// Bits after the point of sizes and centres.
pub(super) const Q4: i32 = 16;
/// Largest side of a window \[px\]; with it no sum below leaves i32.
const SIDE_MAX: i32 = 4 * MAX_SIDE as i32;

/// A square of a frame, turned: maps offsets of comparisons to pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    // Centre [px, Q14], rounding included.
    x: i32,
    y: i32,
    // One offset unit (1/256 side) along the turned axes [px, Q14].
    cos: i32,
    sin: i32,
    // 1, or −1 for a mirrored window.
    flip: i32,
}

impl Window {
    /// The window of `side_px_q4` (1/16 px) around (`x_px_q4`, `y_px_q4`), turned clockwise by
    /// `roll` \[rad\]. Values beyond any frame are clamped.
    pub fn new(x_px_q4: i32, y_px_q4: i32, side_px_q4: i32, roll: f32) -> Self {
        let roll = if roll.is_finite() { roll } else { 0.0 };
        let side = side_px_q4.clamp(0, SIDE_MAX * Q4);
        // Q14 · Q4 / 256, with the last shift to Q14: (cos · 2^14) · (side · 2^4) / 2^(8 + 4).
        let unit = |v: f32| {
            let q14 = libm::roundf(v * (1 << FRACTION) as f32) as i64;
            ((q14 * side as i64) >> 12) as i32
        };
        Window {
            cos: unit(libm::cosf(roll)),
            sin: unit(libm::sinf(roll)),
            flip: 1,
            ..Window::default()
        }
        .at(x_px_q4, y_px_q4)
    }

    /// The same window around another centre \[1/16 px\].
    #[inline]
    pub fn at(self, x_px_q4: i32, y_px_q4: i32) -> Self {
        let limit = 2 * MAX_SIDE as i32 * Q4;
        let half = 1 << (FRACTION - 1);
        Window {
            x: (x_px_q4.clamp(-limit, limit) << (FRACTION - 4)) + half,
            y: (y_px_q4.clamp(-limit, limit) << (FRACTION - 4)) + half,
            ..self
        }
    }

    /// The window that sees the same square mirrored left to right along its own axes.
    pub fn mirrored(self) -> Self {
        Window {
            flip: -self.flip,
            ..self
        }
    }

    /// Luma at an offset \[1/256 of the side\]: of the pixel that it falls into.
    #[inline]
    pub fn read(&self, frame: &Frame<'_>, x: i8, y: i8) -> u8 {
        let (x, y) = (x as i32 * self.flip, y as i32);
        let px = self.x.wrapping_add(x * self.cos).wrapping_sub(y * self.sin);
        let py = self.y.wrapping_add(x * self.sin).wrapping_add(y * self.cos);
        frame.luma(px >> FRACTION, py >> FRACTION)
    }
}

impl Ensemble<'_> {
    /// The final sum of a window that passes all thresholds, and the number of trees asked.
    #[inline]
    pub fn judge(&self, frame: &Frame<'_>, window: &Window) -> (Option<i32>, usize) {
        let leaves = self.forest.leaves();
        let mut sum = 0i32;
        for (tree, threshold) in self.thresholds.iter().enumerate() {
            let leaf = self.forest.leaf(tree, frame, window);
            let value = self.leaves.get(tree * leaves + leaf).copied().unwrap_or(0);
            sum += value as i32;
            if sum < *threshold {
                return (None, tree + 1);
            }
        }
        let last = self.thresholds.last().copied().unwrap_or(0);
        // > 0 always, so that a hit weighs something.
        (Some(sum.saturating_sub(last).max(0) + 1), self.trees())
    }
}

/// The best score (> 0) that an ensemble gives to the window, if any takes it for a face; and the
/// number of trees asked, at most twice the trees of the model.
#[inline]
pub fn judge(
    model: &DetectorModel<'_>,
    frame: &Frame<'_>,
    window: &Window,
) -> (Option<i32>, usize) {
    let (mut best, mut asked) = (None, 0);
    for ensemble in model.ensembles() {
        let (score, trees) = ensemble.judge(frame, window);
        best = best.max(score);
        asked += trees;
        if ensemble.mirrored {
            let (score, trees) = ensemble.judge(frame, &window.mirrored());
            best = best.max(score);
            asked += trees;
        }
    }
    (best, asked)
}
