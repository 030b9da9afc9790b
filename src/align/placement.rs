//! Where a pass looks: the crop of a shape.

use super::Shape;
use crate::math::Similarity;
use crate::shape::MIRROR;

/// A crop that is canonical for a shape.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Crop px from the crop's centre → frame px.
    pub centred_to_frame: Similarity,
    /// Crop px from the centre of its first pixel → frame px: what `warp` takes.
    pub corner_to_frame: Similarity,
}

/// A canonical shape in a mirror.
pub fn mirror(shape: &Shape) -> Shape {
    MIRROR.map(|from| shape.get(from).map_or([0.0; 2], |[x, y]| [-x, *y]))
}

/// Places a crop of `side` px, `zoom` crop px per canonical unit, over a shape in frame px.
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
