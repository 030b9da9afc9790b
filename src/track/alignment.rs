//! One alignment of a face and what the classifiers say of it.

use super::policy::DISCARD_CONFIDENCE;
use crate::align::Shape;
use crate::shape::{LANDMARKS, RotationPrior};
use crate::verifier::Confidence;

/// Landmarks aligned on a frame, verified, and not yet fitted. Part of the tracker's memory,
/// because it would take much of a small stack.
#[derive(Clone)]
pub(super) struct Alignment {
    /// Where it started.
    pub(super) initial_shape: Shape,
    /// Its landmarks.
    pub(super) shape: Shape,
    /// The landmarks after the global stage, before the refiners.
    pub(super) global_shape: Shape,
    /// The rotation by what it has seen.
    pub(super) rotation: Option<RotationPrior>,
    pub(super) confidence: Confidence,
    /// Landmarks that are visible and match the target's appearance.
    pub(super) recognised: u32,
    /// Iterations that were not run, because the confidence was too low.
    pub(super) iterations_left: usize,
    /// What it has cost \[units of the detector\].
    pub(super) units: u32,
}

impl Alignment {
    pub(super) const EMPTY: Alignment = Alignment {
        initial_shape: [[0.0; 2]; LANDMARKS],
        shape: [[0.0; 2]; LANDMARKS],
        global_shape: [[0.0; 2]; LANDMARKS],
        rotation: None,
        confidence: Confidence {
            face: 0.0,
            landmarks: [0.0; LANDMARKS],
            visibility: [0.0; LANDMARKS],
        },
        recognised: 0,
        iterations_left: 0,
        units: 0,
    };
}

/// Confidence that an alignment needs to go on.
#[derive(Clone, Copy)]
pub(super) struct Needed {
    /// After an iteration, for the next one.
    pub(super) to_iterate: f32,
    /// After the last iteration.
    pub(super) to_refine: f32,
}

impl Needed {
    /// All iterations are run, unless the candidate is discarded.
    pub(super) fn to_refine(confidence: f32) -> Needed {
        Needed {
            to_iterate: DISCARD_CONFIDENCE.min(confidence),
            to_refine: confidence,
        }
    }
}
