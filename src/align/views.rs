//! Views: initial shapes by head yaw, and the classification of a shape into a view.

use super::placement::mirror;
use super::shape::Shape;
use crate::math::Similarity;

/// Initial shapes by yaw, in the canonical frame. The views of faces turned to the image left are
/// the mirror images of these.
#[derive(Clone, Copy, Debug)]
pub struct Views<'a> {
    /// One mean shape per view, turned to the image right; the first is frontal.
    pub shapes: &'a [Shape],
    /// Their yaws, rising, normalised: 0 is frontal, 1 is a profile (90°).
    pub yaws: &'a [f32],
}

/// The view of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Index into [`Views::shapes`].
    pub index: usize,
    /// Whether the face turns to the image left: its mirror image belongs to the view.
    pub mirrored: bool,
    /// In-plane rotation of the shape, clockwise in the image \[rad\].
    pub roll: f32,
}

impl Views<'_> {
    /// The initial shape of the nearest view, in the canonical frame. `yaw` is normalised: −1 is a
    /// profile turned to the image left, 1 one turned to the image right. `None` without views.
    pub fn initial_shape(&self, yaw: f32) -> Option<Shape> {
        let distance = |y: &f32| libm::fabsf(y - libm::fabsf(yaw));
        let pairs = self.shapes.iter().zip(self.yaws);
        let (shape, y) = pairs.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))?;
        Some(if yaw < 0.0 && *y > 0.0 {
            mirror(shape)
        } else {
            *shape
        })
    }

    /// The view whose shape has the least squared distance from `shape` (frame px) after a
    /// similarity fit. `None` when `shape` is not finite.
    pub fn of(&self, shape: &Shape) -> Option<View> {
        let mut best: Option<(f32, View)> = None;
        for (index, initial) in self.shapes.iter().enumerate() {
            for mirrored in [false, true] {
                // The frontal view is its own mirror image.
                if mirrored && index == 0 {
                    continue;
                }
                let initial = if mirrored { mirror(initial) } else { *initial };
                let Some(to_frame) = Similarity::fit(&initial, shape) else {
                    continue;
                };
                let fitted = initial.map(|p| to_frame.apply(p));
                let squares: f32 = fitted.iter().zip(shape).map(|(a, b)| squared(a, b)).sum();
                if best.is_none_or(|(least, _)| squares < least) {
                    let roll = to_frame.angle();
                    best = Some((
                        squares,
                        View {
                            index,
                            mirrored,
                            roll,
                        },
                    ));
                }
            }
        }
        best.map(|(_, view)| view)
    }
}

/// Squared distance of two points.
fn squared(a: &[f32; 2], b: &[f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
