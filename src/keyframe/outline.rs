//! The region of a face whose keypoints belong to it.

use super::{FACE_PX, Shape};

/// Height of the forehead above the brows, in sizes of the face.
const FOREHEAD: f32 = 0.2;
/// Directions in which the outline's extent is known.
const DIRECTIONS: usize = 16;

/// A convex outline around the landmarks and the forehead.
pub(super) struct Outline {
    /// Unit vectors, and the extent from the face's centre along them \[px of the reduced image\].
    extents: [([f32; 2], f32); DIRECTIONS],
}

impl Outline {
    /// Of landmarks relative to the face's centre \[px of the reduced image\], and its roll
    /// \[rad\].
    pub fn of(shape: &Shape, roll: f32) -> Outline {
        let up = [libm::sinf(roll), -libm::cosf(roll)];
        let mut extents = [([0.0; 2], 0.0); DIRECTIONS];
        for (i, (direction, extent)) in extents.iter_mut().enumerate() {
            let angle = i as f32 * (core::f32::consts::TAU / DIRECTIONS as f32);
            let d = [libm::cosf(angle), libm::sinf(angle)];
            let along = shape.iter().map(|p| p[0] * d[0] + p[1] * d[1]);
            let upward = (up[0] * d[0] + up[1] * d[1]).max(0.0);
            *direction = d;
            *extent = along.fold(0.0, f32::max) + upward * FOREHEAD * FACE_PX;
        }
        Outline { extents }
    }

    /// Whether a point lies inside \[px of the reduced image, relative to the face's centre\].
    pub fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let mut extents = self.extents.iter();
        extents.all(|(d, extent)| x * d[0] + y * d[1] <= *extent)
    }
}
