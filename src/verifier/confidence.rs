//! The confidence of an alignment.

use crate::shape::LANDMARKS;

/// Calibrated probabilities for one set of 68 landmarks, each 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confidence {
    /// Probability that this is a face whose landmarks are right: the mean error is below a tenth
    /// of the distance between the outer eye corners.
    pub face: f32,
    /// Per landmark, probability that its error is below a tenth of the distance between the outer
    /// eye corners.
    pub landmarks: [f32; LANDMARKS],
    /// Per landmark, probability that it is visible: neither the head itself nor anything in front
    /// of it hides it.
    pub visibility: [f32; LANDMARKS],
}

impl Confidence {
    /// All probabilities 0.
    pub const NONE: Confidence = Confidence {
        face: 0.0,
        landmarks: [0.0; LANDMARKS],
        visibility: [0.0; LANDMARKS],
    };

    /// Mean of the landmarks' visibilities.
    pub fn visible_share(&self) -> f32 {
        self.visibility.iter().sum::<f32>() / LANDMARKS as f32
    }
}
