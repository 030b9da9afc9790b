//! Candidates: shapes that may be a new or a lost face. Each is aligned, verified and fitted.
//!
//! | attempt | iterations | accepted from a confidence of |
//! |---|---|---|
//! | first, at a detection of the scan | all | `FIRST_ATTEMPT_CONFIDENCE` |
//! | first, at a detection near a lost target or of the caller | all | `ACCEPT_CONFIDENCE` |
//! | retry of a rejected detection, or a keyframe match | 1 | `ACCEPT_CONFIDENCE` |
//!
//! In the suppressed region each needs `TRUST_CONFIDENCE`. A face that is centred outside of the
//! region of interest, or is excluded, is never accepted.

use super::event::EventKind;
use super::geometry::{centre, detection_of, initial_shape};
use super::policy::{ACCEPT_CONFIDENCE, RETRY_CONFIDENCE, TRUST_CONFIDENCE};
use super::step::{Outcome, Step};
use super::target::Origin;
use super::{Loss, Tracker};
use crate::align::Shape;
use crate::detect::Detection;
use crate::image::Roi;

/// One attempt at a candidate.
pub(super) struct Attempt {
    /// Iterations of the cascade.
    iterations: usize,
    origin: Origin,
    /// Confidence from which the candidate is accepted.
    min_confidence: f32,
}

impl Attempt {
    /// An attempt that starts near a face: one iteration.
    pub(super) fn near(origin: Origin) -> Attempt {
        Attempt {
            iterations: 1,
            origin,
            min_confidence: ACCEPT_CONFIDENCE,
        }
    }
}

impl Tracker {
    /// Whether a face with this centre may be found.
    pub(super) fn may_find(&self, centre: [f32; 2]) -> bool {
        let in_roi = |roi: Roi| roi.contains(centre);
        self.config.roi.is_none_or(in_roi) && !self.excluded.contains(centre)
    }

    /// First attempt at a detection. A rejected one may be left for a retry.
    #[inline(never)]
    pub(super) fn attempt_detection(
        &mut self,
        step: &Step<'_>,
        face: &Detection,
        origin: Origin,
        min_confidence: f32,
    ) -> Outcome {
        let align = &step.model.align;
        let canonical = align.views().initial_shape(face.yaw);
        let Some(shape) = canonical.and_then(|canonical| initial_shape(&canonical, face)) else {
            return Outcome::NotFound;
        };
        let attempt = Attempt {
            iterations: align.iterations(),
            origin,
            min_confidence,
        };
        let outcome = self.attempt(step, &shape, &attempt);
        if let Outcome::Retry { confidence } = outcome {
            self.retry.offer(confidence, self.work.global_shape());
        }
        outcome
    }

    /// Second and last attempt at a rejected detection.
    #[inline(never)]
    pub(super) fn retry(&mut self, step: &Step<'_>) -> Outcome {
        let shape = self.retry.take();
        self.attempt(step, &shape, &Attempt::near(Origin::NewFace))
    }

    /// Align from an initial shape, verify, fit.
    pub(super) fn attempt(&mut self, step: &Step<'_>, shape: &Shape, attempt: &Attempt) -> Outcome {
        if !self.align(step, shape, attempt.iterations, attempt.min_confidence) {
            return Outcome::Reject(Loss::LowConfidence);
        }
        let alignment = &self.alignment;
        if !self.may_find(centre(&alignment.shape)) {
            return Outcome::NotFound;
        }
        let confidence = alignment.confidence.face;
        let place = detection_of(step.model, &alignment.shape);
        if confidence < TRUST_CONFIDENCE && self.suppressed.contains(&place, step.now_us) {
            return Outcome::Reject(Loss::LowConfidence);
        }
        let outcome = match confidence >= attempt.min_confidence {
            true => self.accept(step, attempt.origin),
            false => Outcome::Reject(Loss::LowConfidence),
        };
        if outcome.is_accept() {
            self.record(match attempt.origin {
                Origin::NewFace => EventKind::Acquired,
                Origin::Reacquired | Origin::Tracked => EventKind::Reacquired,
            });
        }
        let retry = RETRY_CONFIDENCE..attempt.min_confidence;
        match outcome {
            Outcome::Reject(_) if retry.contains(&confidence) => Outcome::Retry { confidence },
            _ => outcome,
        }
    }
}
