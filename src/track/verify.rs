//! Second part of an attempt: whether a candidate may be a new or a lost face.
//!
//! | attempt | iterations | accepted from a confidence of |
//! |---|---|---|
//! | first, at a detection of the scan | all | `FIRST_ATTEMPT_CONFIDENCE` |
//! | rest of that, where one iteration was all that the step had work for | 1 | the same |
//! | first, at a detection near a lost target or of the caller | all | `ACCEPT_CONFIDENCE` |
//! | retry of a rejected detection, or a keyframe match | 1 | `ACCEPT_CONFIDENCE` |
//!
//! In the suppressed region each needs `TRUST_CONFIDENCE`. A face that is centred outside of the
//! region of interest, or is excluded, is never accepted.

use super::align::{Candidate, Start};
use super::geometry::{centre, detection_of};
use super::policy::{DISCARD_CONFIDENCE, RETRY_CONFIDENCE, TRUST_CONFIDENCE};
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
    match confidence >= start.needed.to_refine {
        true => Verdict::Fit,
        false if start.may_retry && confidence >= least => Verdict::Retry,
        false => Verdict::Reject,
    }
}

/// Whether a face with these landmarks may be found.
pub(super) fn may_find(step: &Step<'_>, shape: &Shape, excluded: &Excluded) -> bool {
    let centre = centre(shape);
    step.roi.is_none_or(|roi| roi.contains(centre)) && !excluded.contains(centre)
}
