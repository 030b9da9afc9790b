//! Candidates: shapes that may be a new or a lost face. Each is aligned, verified and fitted.
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

use super::alignment::Needed;
use super::event::EventKind;
use super::geometry::{centre, detection_of, initial_shape};
use super::policy::{
    ACCEPT_CONFIDENCE, DISCARD_CONFIDENCE, FIRST_ATTEMPT_CONFIDENCE, RETRY_CONFIDENCE,
    TRUST_CONFIDENCE,
};
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
    needed: Needed,
}

impl Attempt {
    /// An attempt that starts near a face: one iteration.
    pub(super) fn near(origin: Origin) -> Attempt {
        Attempt {
            iterations: 1,
            origin,
            needed: Needed::to_refine(ACCEPT_CONFIDENCE),
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
        needed: Needed,
    ) -> Outcome {
        let align = &step.model.align;
        let canonical = align.views().initial_shape(face.yaw);
        let Some(shape) = canonical.and_then(|canonical| initial_shape(&canonical, face)) else {
            return Outcome::NotFound;
        };
        let attempt = Attempt {
            iterations: align.iterations(),
            origin,
            needed,
        };
        let outcome = self.attempt(step, &shape, &attempt);
        if let Outcome::Retry { confidence } = outcome {
            let is_unfinished = self.alignment.iterations_left > 0;
            let shape = self.work.global_shape();
            self.retry.offer(confidence, shape, is_unfinished);
        }
        outcome
    }

    /// The rest of a first attempt, which may be left for a retry once more, or the second and last
    /// attempt at a rejected detection.
    #[inline(never)]
    pub(super) fn retry(&mut self, step: &Step<'_>) -> Outcome {
        let (shape, is_unfinished) = self.retry.take();
        let mut attempt = Attempt::near(Origin::NewFace);
        if is_unfinished {
            attempt.needed = Needed::to_refine(FIRST_ATTEMPT_CONFIDENCE);
        }
        let outcome = self.attempt(step, &shape, &attempt);
        if let (Outcome::Retry { confidence }, true) = (outcome, is_unfinished) {
            (self.retry).offer(confidence, self.work.global_shape(), false);
        }
        outcome
    }

    /// Align from an initial shape, verify, fit.
    pub(super) fn attempt(&mut self, step: &Step<'_>, shape: &Shape, attempt: &Attempt) -> Outcome {
        if !self.align(step, shape, attempt.iterations, attempt.needed) {
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
        let outcome = match confidence >= attempt.needed.to_refine {
            true => self.accept(step, attempt.origin),
            false => Outcome::Reject(Loss::LowConfidence),
        };
        if outcome.is_accept() {
            self.record(match attempt.origin {
                Origin::NewFace => EventKind::Acquired,
                Origin::Reacquired | Origin::Tracked => EventKind::Reacquired,
            });
        }
        let least = match self.alignment.iterations_left {
            0 => RETRY_CONFIDENCE,
            _ => DISCARD_CONFIDENCE,
        };
        let retry = least..attempt.needed.to_refine;
        match outcome {
            Outcome::Reject(_) if retry.contains(&confidence) => Outcome::Retry { confidence },
            _ => outcome,
        }
    }
}
