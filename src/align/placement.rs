//! Where a stage looks: the crop of a shape and its points in it.

use super::Shape;
use crate::math::Similarity;
use crate::shape::{LANDMARKS, MIRROR};

/// A crop that is canonical for a shape, and the shape's points in it.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Canonical frame → frame px, before mirroring.
    pub canonical_to_frame: Similarity,
    /// Crop px → frame px, before mirroring.
    pub crop_to_frame: Similarity,
    /// Whether the crop and everything in it is seen in a mirror: left-turned faces share the
    /// weights of right-turned ones.
    pub mirrored: bool,
    /// The shape in the canonical frame.
    pub canonical: Shape,
    /// The shape in whole crop px.
    pub points: [[i32; 2]; LANDMARKS],
}

impl Placement {
    /// Where the canonical shape `self.canonical` + `delta` lies in the frame \[px\].
    pub fn moved(&self, delta: &Shape) -> Shape {
        let mut moved = self.canonical;
        for (p, d) in moved.iter_mut().zip(delta) {
            *p = [p[0] + d[0], p[1] + d[1]];
        }
        let moved = if self.mirrored { mirror(&moved) } else { moved };
        moved.map(|p| self.canonical_to_frame.apply(p))
    }
}

/// A canonical shape in a mirror.
pub fn mirror(shape: &Shape) -> Shape {
    MIRROR.map(|from| shape.get(from).map_or([0.0; 2], |[x, y]| [-x, *y]))
}

/// Places a crop of `side` px, `zoom` crop px per canonical unit, over a shape in frame px.
///
/// `None` when the shape has no extent or is not finite.
pub fn place(
    mean: &Shape,
    shape: &Shape,
    zoom: f32,
    side: usize,
    mirrored: bool,
) -> Option<Placement> {
    let canonical_to_frame = Similarity::fit(mean, shape)?;
    let frame_to_canonical = canonical_to_frame.inverse()?;
    let canonical = shape.map(|p| frame_to_canonical.apply(p));
    let canonical = if mirrored {
        mirror(&canonical)
    } else {
        canonical
    };
    let centre = (side as f32 - 1.0) / 2.0;
    let crop_to_canonical = Similarity {
        a: 1.0 / zoom,
        b: 0.0,
        tx: -centre / zoom,
        ty: -centre / zoom,
    };
    let pixel = |v: f32| libm::roundf((v * zoom + centre).clamp(-1000.0, 1000.0)) as i32;
    Some(Placement {
        canonical_to_frame,
        crop_to_frame: crop_to_canonical.then(&canonical_to_frame),
        mirrored,
        canonical,
        points: canonical.map(|[x, y]| [pixel(x), pixel(y)]),
    })
}
