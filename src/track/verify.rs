//! Second part of an attempt: whether a candidate may be a new or a lost face.
//!
//! | attempt | iterations | accepted from a confidence of |
//! |---|---|---|
//! | first, at a detection of the scan | all | `FIRST_ATTEMPT_CONFIDENCE` |
//! | rest of that, where one iteration was all that the step had work for | 1 | the same |
//! | first, at a detection near a lost target or of the caller | all | `ACCEPT_CONFIDENCE` |
//! | retry of a rejected detection, or a keyframe match | 1 | `ACCEPT_CONFIDENCE` |
//! | the former in a frame with many tiles | 1 | `FIRST_ATTEMPT_CONFIDENCE` |
//!
//! An attempt that goes astray starts from a place that is off: the detector looks there again, at
//! the size that it found, and the face is attempted from what it then reports.
//!
//! In the suppressed region each needs `TRUST_CONFIDENCE`. A face that is centred outside of the
//! region of interest, or is excluded, is never accepted.

use super::align::{Candidate, Start};
use super::geometry::{centre, detection_of};
use super::policy::{
    DISCARD_CONFIDENCE, LOOK_AGAIN_CONFIDENCE, LOOK_AGAIN_SCORE, RETRY_CONFIDENCE, TRUST_CONFIDENCE,
};
use super::search::{Excluded, Suppressed};
use super::step::Step;
use crate::align::Shape;

/// What becomes of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is a face if a pose explains it.
    Fit,
    /// It is none by now, but worth another iteration.
    Retry,
    /// It is none, but the detector was sure of a face.
    LookAgain,
    /// It is none.
    Reject,
}

/// Judges a candidate by its place and its confidence.
pub(super) fn verify(
    step: &Step<'_>,
    start: &Start,
    candidate: &Candidate,
    excluded: &Excluded,
    suppressed: &Suppressed,
) -> Verdict {
    let confidence = candidate.confidence.face;
    let is_suppressed = || {
        let place = detection_of(step.model, &candidate.shape);
        suppressed.contains(&place, step.now_us)
    };
    if !candidate.is_finite || !may_find(step, &candidate.shape, excluded) {
        return Verdict::Reject;
    }
    if confidence < TRUST_CONFIDENCE && is_suppressed() {
        return Verdict::Reject;
    }
    let least = match candidate.iterations_left {
        0 => RETRY_CONFIDENCE,
        _ => DISCARD_CONFIDENCE,
    };
    let is_astray = candidate.iterations_left == 0 || confidence < least;
    match confidence >= start.needed.to_refine {
        true => Verdict::Fit,
        false if is_astray && may_look_again(start, confidence) => Verdict::LookAgain,
        false if start.may_retry && confidence >= least => Verdict::Retry,
        false => Verdict::Reject,
    }
}

/// Whether the detector looks again at what an attempt with this confidence started from.
fn may_look_again(start: &Start, confidence: f32) -> bool {
    start.seen.looks > 0
        && start.seen.face.score >= LOOK_AGAIN_SCORE
        && confidence < LOOK_AGAIN_CONFIDENCE
}

/// Whether a face with these landmarks may be found.
pub(super) fn may_find(step: &Step<'_>, shape: &Shape, excluded: &Excluded) -> bool {
    let centre = centre(shape);
    step.roi.is_none_or(|roi| roi.contains(centre)) && !excluded.contains(centre)
}

#[cfg(test)]
mod tests {
    use super::super::align::Origin;
    use super::super::search::Seen;
    use super::*;
    use crate::detect::Detection;
    use crate::shape::LANDMARKS;

    #[test]
    fn the_detector_looks_again_where_it_was_sure_and_the_attempt_went_astray() {
        let may_look = |score: f32, looks: u8, confidence: f32| {
            let mut start = Start::near([[0.0; 2]; LANDMARKS], Origin::NewFace);
            let face = Detection {
                score,
                ..Detection::NONE
            };
            start.seen = Seen { face, looks };
            may_look_again(&start, confidence)
        };
        assert!(may_look(2.0, 1, 0.1));
        assert!(
            !may_look(2.0, 1, 0.6),
            "another iteration goes on from there"
        );
        assert!(!may_look(2.0, 0, 0.1), "it has looked often enough");
        assert!(!may_look(0.5, 1, 0.1), "it was not sure");
    }
}
