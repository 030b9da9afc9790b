//! What is said of a fit.

use crate::shape::LANDMARKS;

/// How sure the answer is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confidence {
    /// Probability that this is a face and that its landmarks are right (mean error below a tenth
    /// of the inter-ocular distance).
    pub face: f32,
    /// Per landmark, probability that it lies within a tenth of the inter-ocular distance of the
    /// truth.
    pub landmarks: [f32; LANDMARKS],
    /// Per landmark, probability that nothing hides it from the camera, neither the head itself nor
    /// anything before it.
    pub visibility: [f32; LANDMARKS],
}
