//! The type of all landmarks of a face.

use crate::shape::LANDMARKS;

/// 68 landmarks, x and y, in the frame that the context names.
pub type Shape = [[f32; 2]; LANDMARKS];

pub(super) fn is_finite(shape: &Shape) -> bool {
    shape.iter().all(|p| p[0].is_finite() && p[1].is_finite())
}

/// Shapes in a section's list of coordinates.
pub(super) fn shapes_of(coordinates: &[f32]) -> &[Shape] {
    coordinates.as_chunks::<2>().0.as_chunks::<LANDMARKS>().0
}
