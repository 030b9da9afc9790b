//! Placement of the global stage's crop over a shape.

use super::shape::Shape;
use crate::math::Similarity;
use crate::shape::MIRROR;

/// Coordinate transforms of a crop that shows a shape upright and at canonical size.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Crop px relative to the crop's centre → frame px.
    pub centred_to_frame: Similarity,
    /// Crop px relative to the centre of the crop's first pixel → frame px, as
    /// [`crate::image::warp`] takes it.
    pub corner_to_frame: Similarity,
}

/// The mirror image of a canonical shape: x is negated and left and right landmarks are swapped.
pub fn mirror(shape: &Shape) -> Shape {
    MIRROR.map(|from| shape.get(from).map_or([0.0; 2], |[x, y]| [-x, *y]))
}

/// Places a crop of `side` px, at `zoom` crop px per canonical unit, over `shape` (frame px).
///
/// `None` when the shape has no extent or is not finite.
pub fn place(mean: &Shape, shape: &Shape, zoom: f32, side: usize) -> Option<Placement> {
    let canonical_to_frame = Similarity::fit(mean, shape)?;
    canonical_to_frame.inverse()?;
    let to_canonical = Similarity {
        a: 1.0 / zoom,
        ..Similarity::IDENTITY
    };
    let centred_to_frame = to_canonical.then(&canonical_to_frame);
    let centre = (side as f32 - 1.0) / 2.0;
    let [tx, ty] = centred_to_frame.apply([-centre, -centre]);
    Some(Placement {
        centred_to_frame,
        corner_to_frame: Similarity {
            tx,
            ty,
            ..centred_to_frame
        },
    })
}
