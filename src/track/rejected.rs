//! What is kept of rejected candidates: one to retry, and a region to suppress.

use super::policy::{SUPPRESS_DISTANCE, SUPPRESS_SIZES, SUPPRESS_US};
use crate::align::Shape;
use crate::detect::Detection;
use crate::shape::LANDMARKS;

/// The rejected detection of the highest confidence, to be retried: mostly on the next frame, as
/// its initial shape was poor.
#[derive(Clone)]
pub(super) struct PendingRetry {
    /// 0 if there is none.
    confidence: f32,
    /// Where the first attempt ended.
    shape: Shape,
    /// Whether that was before its last iteration.
    is_unfinished: bool,
}

impl PendingRetry {
    pub(super) const NONE: PendingRetry = PendingRetry {
        confidence: 0.0,
        shape: [[0.0; 2]; LANDMARKS],
        is_unfinished: false,
    };

    pub(super) fn is_some(&self) -> bool {
        self.confidence > 0.0
    }

    pub(super) fn clear(&mut self) {
        self.confidence = 0.0;
    }

    pub(super) fn offer(&mut self, confidence: f32, shape: &Shape, is_unfinished: bool) {
        if confidence > self.confidence {
            *self = PendingRetry {
                confidence,
                shape: *shape,
                is_unfinished,
            };
        }
    }

    /// Where the first attempt ended, and whether that was before its last iteration.
    pub(super) fn take(&mut self) -> (Shape, bool) {
        self.clear();
        (self.shape, self.is_unfinished)
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

    pub(super) fn contains(&self, face: &Detection, now_us: i64) -> bool {
        let distance = libm::hypotf(face.x - self.x, face.y - self.y);
        now_us.saturating_sub(self.since_us) < SUPPRESS_US
            && distance < SUPPRESS_DISTANCE * self.size
            && SUPPRESS_SIZES.contains(&(face.size / self.size))
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
        retry.offer(0.4, &[[4.0; 2]; LANDMARKS], true);
        retry.offer(0.3, &[[3.0; 2]; LANDMARKS], false);
        assert!(retry.is_some());
        assert_eq!(retry.take(), ([[4.0; 2]; LANDMARKS], true));
        assert!(!retry.is_some());
    }
}
