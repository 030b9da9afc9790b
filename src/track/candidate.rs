//! Candidates: shapes that may be a new or a lost face. Each is aligned, verified and fitted.
//!
//! | attempt | iterations | accepted from a confidence of |
//! |---|---|---|
//! | first, at a detection of the scan | all | `FIRST_ATTEMPT_CONFIDENCE` |
//! | first, at a detection near a lost target or of the caller | all | `ACCEPT_CONFIDENCE` |
//! | retry of a rejected detection, or a keyframe match | 1 | `ACCEPT_CONFIDENCE` |
//!
//! In the suppressed region each needs `TRUST_CONFIDENCE`.

use super::geometry::{detection_of, initial_shape};
use super::policy::{
    ACCEPT_CONFIDENCE, RETRY_CONFIDENCE, SUPPRESS_DISTANCE, SUPPRESS_SIZES, SUPPRESS_US,
    TRUST_CONFIDENCE,
};
use super::step::{Outcome, Step};
use super::target::Origin;
use super::{Loss, Tracker};
use crate::align::Shape;
use crate::detect::Detection;
use crate::shape::LANDMARKS;

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

/// The rejected detection of the highest confidence, to be retried: mostly on the next frame, as
/// its initial shape was poor.
#[derive(Clone)]
pub(super) struct PendingRetry {
    /// 0 if there is none.
    confidence: f32,
    /// Where the first attempt ended.
    shape: Shape,
}

impl PendingRetry {
    pub(super) const NONE: PendingRetry = PendingRetry {
        confidence: 0.0,
        shape: [[0.0; 2]; LANDMARKS],
    };

    pub(super) fn is_some(&self) -> bool {
        self.confidence > 0.0
    }

    pub(super) fn clear(&mut self) {
        self.confidence = 0.0;
    }

    fn offer(&mut self, confidence: f32, shape: &Shape) {
        if confidence > self.confidence {
            (self.confidence, self.shape) = (confidence, *shape);
        }
    }

    fn take(&mut self) -> Shape {
        self.clear();
        self.shape
    }
}

/// A region in which something was accepted as a face, never was trusted, and was lost.
#[derive(Clone)]
pub(super) struct Suppressed {
    /// Centre \[px\].
    x: f32,
    y: f32,
    /// As [`Detection::size`]; 0 if nothing is suppressed \[px\].
    size: f32,
    since_us: i64,
}

impl Suppressed {
    pub(super) const NONE: Suppressed = Suppressed {
        x: 0.0,
        y: 0.0,
        size: 0.0,
        since_us: 0,
    };

    pub(super) fn at(region: &Detection, now_us: i64) -> Suppressed {
        Suppressed {
            x: region.x,
            y: region.y,
            size: region.size,
            since_us: now_us,
        }
    }

    fn contains(&self, face: &Detection, now_us: i64) -> bool {
        let distance = libm::hypotf(face.x - self.x, face.y - self.y);
        now_us.saturating_sub(self.since_us) < SUPPRESS_US
            && distance < SUPPRESS_DISTANCE * self.size
            && SUPPRESS_SIZES.contains(&(face.size / self.size))
    }
}

impl Tracker {
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
        let Some(mut shape) = canonical.and_then(|canonical| initial_shape(&canonical, face))
        else {
            return Outcome::NotFound;
        };
        let attempt = Attempt {
            iterations: align.iterations(),
            origin,
            min_confidence,
        };
        let outcome = self.attempt(step, &mut shape, &attempt);
        if let Outcome::Retry { confidence } = outcome {
            self.retry.offer(confidence, self.work.global_shape());
        }
        outcome
    }

    /// Second and last attempt at a rejected detection.
    #[inline(never)]
    pub(super) fn retry(&mut self, step: &Step<'_>) -> Outcome {
        let mut shape = self.retry.take();
        self.attempt(step, &mut shape, &Attempt::near(Origin::NewFace))
    }

    /// Align, verify, fit. `shape` is moved in place.
    pub(super) fn attempt(
        &mut self,
        step: &Step<'_>,
        shape: &mut Shape,
        attempt: &Attempt,
    ) -> Outcome {
        let Step {
            model,
            frame,
            now_us,
        } = *step;
        let iterations = attempt.iterations;
        if !model.align.run(frame, iterations, shape, &mut self.work) {
            return Outcome::Reject(Loss::LowConfidence);
        }
        let mut confidence = self.verify(model);
        if confidence.face < TRUST_CONFIDENCE
            && self
                .suppressed
                .contains(&detection_of(model, shape), now_us)
        {
            return Outcome::Reject(Loss::LowConfidence);
        }
        let outcome = match confidence.face >= attempt.min_confidence {
            true => self.accept(step, shape, attempt.origin, &mut confidence),
            false => Outcome::Reject(Loss::LowConfidence),
        };
        let retry = RETRY_CONFIDENCE..attempt.min_confidence;
        match outcome {
            Outcome::Reject(_) if retry.contains(&confidence.face) => Outcome::Retry {
                confidence: confidence.face,
            },
            _ => outcome,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_is_suppressed_where_it_is_and_for_a_while() {
        let region = Detection {
            x: 100.0,
            y: 80.0,
            size: 60.0,
            ..Detection::default()
        };
        assert!(!Suppressed::NONE.contains(&region, 0));
        let suppressed = Suppressed::at(&region, 1_000_000);
        let at = |x: f32, size: f32| Detection { x, size, ..region };
        let end = 1_000_000 + SUPPRESS_US;
        assert!(suppressed.contains(&at(120.0, 70.0), end - 1));
        assert!(!suppressed.contains(&region, end));
        assert!(!suppressed.contains(&at(140.0, 60.0), end - 1));
        assert!(!suppressed.contains(&at(100.0, 120.0), end - 1));
    }

    #[test]
    fn the_most_confident_candidate_is_retried_once() {
        let mut retry = PendingRetry::NONE;
        retry.offer(0.4, &[[4.0; 2]; LANDMARKS]);
        retry.offer(0.3, &[[3.0; 2]; LANDMARKS]);
        assert!(retry.is_some());
        assert_eq!(retry.take(), [[4.0; 2]; LANDMARKS]);
        assert!(!retry.is_some());
    }
}
