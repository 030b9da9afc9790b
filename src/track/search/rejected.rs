//! Candidates that are rejected: one to retry, and where none is accepted, which is in excluded
//! boxes, whose faces other trackers follow, and in the region of a target that was no face.

use crate::align::Shape;
use crate::detect::Detection;
use crate::shape::LANDMARKS;
use crate::track::config::MAX_EXCLUDED;
use crate::track::policy::{SAME_FACE, SUPPRESS_DISTANCE, SUPPRESS_SIZES, SUPPRESS_US};

/// A detection that an attempt starts from, and how often the detector may look there again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    pub face: Detection,
    pub looks: u8,
}

impl Seen {
    /// No detection.
    pub const NONE: Seen = Seen {
        face: Detection::NONE,
        looks: 0,
    };
}

/// The rejected detection of the highest confidence, to be retried: mostly on the next frame, as
/// its initial shape was poor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendingRetry {
    /// 0 if there is none.
    pub confidence: f32,
    /// Where the first attempt ended.
    pub shape: Shape,
    /// Whether that was before its last iteration.
    pub is_unfinished: bool,
    /// The detection that it started from.
    pub seen: Seen,
}

impl PendingRetry {
    pub const NONE: PendingRetry = PendingRetry {
        confidence: 0.0,
        shape: [[0.0; 2]; LANDMARKS],
        is_unfinished: false,
        seen: Seen::NONE,
    };

    pub fn clear(&mut self) {
        self.confidence = 0.0;
    }

    /// Keeps what is better than what is kept.
    pub fn offer(&mut self, retry: &PendingRetry) {
        if retry.confidence > self.confidence {
            *self = *retry;
        }
    }

    /// What is kept; `None` if there is nothing.
    pub fn take(&mut self) -> Option<PendingRetry> {
        let retry = *self;
        self.clear();
        (retry.confidence > 0.0).then_some(retry)
    }
}

/// Range of the longer side of a box, and largest coordinate \[px\], as for hints.
const SIDE_PX: core::ops::RangeInclusive<f32> = 1.0..=32_768.0;
const FARTHEST_PX: f32 = 65_536.0;

/// A box by its centre \[px\].
#[derive(Clone, Copy)]
struct Place {
    x: f32,
    y: f32,
    /// Longer side.
    size: f32,
}

/// The boxes that a tracker excludes.
#[derive(Clone)]
pub struct Excluded {
    places: heapless::Vec<Place, MAX_EXCLUDED>,
}

impl Excluded {
    pub const NONE: Excluded = Excluded {
        places: heapless::Vec::new(),
    };

    /// Of boxes left, top, width, height \[px\]; `None` where there are too many, or a number is
    /// out of range.
    pub fn new(boxes: &[[f32; 4]]) -> Option<Excluded> {
        let mut excluded = Excluded::NONE;
        for face_box in boxes {
            excluded.places.push(place(face_box)?).ok()?;
        }
        Some(excluded)
    }

    /// Whether a face with this centre is one of them.
    pub fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let near = |p: &Place| libm::hypotf(x - p.x, y - p.y) < SAME_FACE * p.size;
        self.places.iter().any(near)
    }
}

fn place(&[x, y, width, height]: &[f32; 4]) -> Option<Place> {
    let size = width.max(height);
    let is_valid = SIDE_PX.contains(&size)
        && width > 0.0
        && height > 0.0
        && x.abs() <= FARTHEST_PX
        && y.abs() <= FARTHEST_PX;
    is_valid.then_some(Place {
        x: x + width / 2.0,
        y: y + height / 2.0,
        size,
    })
}

/// A region in which something was accepted as a face, never was trusted, and was lost.
#[derive(Clone)]
pub struct Suppressed {
    /// Centre \[px\].
    x: f32,
    y: f32,
    /// As [`Detection::size`]; 0 if nothing is suppressed \[px\].
    size: f32,
    since_us: i64,
}

impl Suppressed {
    pub const NONE: Suppressed = Suppressed {
        x: 0.0,
        y: 0.0,
        size: 0.0,
        since_us: 0,
    };

    pub fn at(region: &Detection, now_us: i64) -> Suppressed {
        Suppressed {
            x: region.x,
            y: region.y,
            size: region.size,
            since_us: now_us,
        }
    }

    pub fn contains(&self, face: &Detection, now_us: i64) -> bool {
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
    fn a_face_is_excluded_near_the_centre_of_a_box() {
        let excluded = Excluded::new(&[[100.0, 100.0, 80.0, 100.0]]).unwrap();
        assert!(excluded.contains([140.0, 150.0]) && excluded.contains([170.0, 170.0]));
        assert!(!excluded.contains([181.0, 150.0]));
        assert!(!Excluded::NONE.contains([0.0, 0.0]));
    }

    #[test]
    fn boxes_out_of_range_are_rejected() {
        let good = [0.0, 0.0, 50.0, 50.0];
        assert!(Excluded::new(&[good; MAX_EXCLUDED]).is_some());
        assert!(Excluded::new(&[good; MAX_EXCLUDED + 1]).is_none());
        for bad in [f32::NAN, f32::INFINITY, 1e9, -1e9] {
            for k in 0..4 {
                let mut face_box = good;
                face_box[k] = bad;
                assert!(Excluded::new(&[good, face_box]).is_none(), "{face_box:?}");
            }
        }
    }

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
        let of = |confidence: f32| PendingRetry {
            confidence,
            ..PendingRetry::NONE
        };
        let mut retry = PendingRetry::NONE;
        retry.offer(&of(0.4));
        retry.offer(&of(0.3));
        assert_eq!(retry.take(), Some(of(0.4)));
        assert_eq!(retry.take(), None);
    }
}
