//! Amounts of turn: which weights a shape needs, and which shape to start from.

use super::{Shape, mirror};
use crate::math::Similarity;

/// Start shapes by turn, in the canonical frame; those of left-turned faces are their mirrors.
#[derive(Clone, Copy, Debug)]
pub struct Views<'a> {
    /// One shape per view, turned to the image right (or not at all).
    pub starts: &'a [Shape],
    /// Their turns, rising from 0 (towards the camera) to 1 (profile).
    pub turns: &'a [f32],
}

/// What a shape looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Index of the view.
    pub index: usize,
    /// Whether it is turned to the image left, so that its mirror image belongs to the view.
    pub mirrored: bool,
    /// In-plane rotation that brought it there, clockwise in the image \[rad\].
    pub roll: f32,
}

impl Views<'_> {
    /// The start shape for a turn (−1 image left … 1 image right), in the canonical frame.
    pub fn start(&self, turn: f32) -> Option<Shape> {
        let distance = |t: &f32| libm::fabsf(t - libm::fabsf(turn));
        let pairs = self.starts.iter().zip(self.turns);
        let (start, t) = pairs.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))?;
        Some(if turn < 0.0 && *t > 0.0 {
            mirror(start)
        } else {
            *start
        })
    }

    /// The view that a shape resembles most.
    pub fn of(&self, shape: &Shape) -> Option<View> {
        let mut best: Option<(f32, View)> = None;
        for (index, start) in self.starts.iter().enumerate() {
            for mirrored in [false, true] {
                // The first view is its own mirror.
                if mirrored && index == 0 {
                    continue;
                }
                let start = if mirrored { mirror(start) } else { *start };
                let Some(to_frame) = Similarity::fit(&start, shape) else {
                    continue;
                };
                let start = start.map(|p| to_frame.apply(p));
                let squares: f32 = start.iter().zip(shape).map(|(a, b)| squared(a, b)).sum();
                if best.is_none_or(|(least, _)| squares < least) {
                    best = Some((
                        squares,
                        View {
                            index,
                            mirrored,
                            roll: to_frame.angle(),
                        },
                    ));
                }
            }
        }
        best.map(|(_, view)| view)
    }
}

fn squared(a: &[f32; 2], b: &[f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
