//! Faces by their boxes: what a caller expects, and all faces of a frame, listed in calls of
//! bounded work without tracking.

use super::Excluded;
use super::scan::next_of_all;
use crate::align::Workspace;
use crate::detect::{Detection, Scan, ScanOutcome, TILE_UNITS};
use crate::track::align::{Candidate, Needed, Origin, Start};
use crate::track::config::Config;
use crate::track::geometry::{bounds, detection_of, is_same_face};
use crate::track::policy::{FIRST_ATTEMPT_CONFIDENCE, REFINE_UNITS};
use crate::track::step::{Step, WorkBudget};
use crate::track::verify::may_find;

/// Range of the longer side of a hint's box \[px\].
const SIDE_PX: core::ops::RangeInclusive<f32> = 16.0..=32_768.0;
/// Largest coordinate of a hint's box \[px\].
const FARTHEST_PX: f32 = 65_536.0;

/// Where a face is expected: what another detector, or a tracker of another camera, has found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FaceHint {
    /// Box of the landmarks: left, top, width, height \[px\]. It reaches from the brows to below
    /// the chin and from ear to ear; boxes of whole heads are larger.
    pub face_box: [f32; 4],
    /// Yaw \[deg\], 0 where it is not known.
    pub yaw_deg: f32,
    /// Roll \[deg\], 0 where it is not known.
    pub roll_deg: f32,
}

impl FaceHint {
    /// A face that looks at the camera.
    pub const fn new(face_box: [f32; 4]) -> Self {
        FaceHint {
            face_box,
            yaw_deg: 0.0,
            roll_deg: 0.0,
        }
    }

    /// With these angles \[deg\].
    pub const fn with_angles(self, yaw_deg: f32, roll_deg: f32) -> Self {
        FaceHint {
            yaw_deg,
            roll_deg,
            ..self
        }
    }

    /// The same as a detection; `None` where a number is out of range.
    pub(in crate::track) fn detection(&self) -> Option<Detection> {
        let [x, y, width, height] = self.face_box;
        let size = width.max(height);
        let is_valid = SIDE_PX.contains(&size)
            && width > 0.0
            && height > 0.0
            && x.abs() <= FARTHEST_PX
            && y.abs() <= FARTHEST_PX
            && self.yaw_deg.abs() <= 180.0
            && self.roll_deg.abs() <= 360.0;
        is_valid.then_some(Detection {
            x: x + width / 2.0,
            y: y + height / 2.0,
            size,
            roll: self.roll_deg.to_radians(),
            // Normalised: 1 is a profile.
            yaw: (self.yaw_deg / 90.0).clamp(-1.0, 1.0),
            ..Detection::default()
        })
    }
}

/// A face of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FoundFace {
    /// Box of the landmarks: left, top, width, height \[px of the upright frame\].
    pub face_box: [f32; 4],
    /// > 0: the face turns to the image right \[deg\]; rough.
    pub yaw_deg: f32,
    /// > 0: the face tilts clockwise in the image \[deg\].
    pub roll_deg: f32,
    /// Calibrated probability that it is a face and that its landmarks are right, 0..1.
    pub confidence: f32,
}

impl FoundFace {
    /// For [`crate::Tracker::step_at`].
    pub fn hint(&self) -> FaceHint {
        FaceHint::new(self.face_box).with_angles(self.yaw_deg, self.roll_deg)
    }
}

/// What one call of [`crate::Tracker::detect`] found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Detected {
    /// Faces that were written.
    pub count: usize,
    /// Whether the scan has come to its end: every place was searched since it began.
    pub finished: bool,
}

/// Lists faces as [`crate::Tracker::detect`] says, within a step's work.
#[inline(never)]
pub fn list(
    step: &Step<'_>,
    config: &Config,
    scan: &mut Scan,
    excluded: &Excluded,
    work: &mut Workspace,
    found: &mut [FoundFace],
) -> Detected {
    let mut budget = WorkBudget::new(config.scan_budget, 0);
    let mut detected = Detected::default();
    while detected.count < found.len() && budget.left() >= TILE_UNITS {
        match next_of_all(scan, config, step, &mut budget, work) {
            ScanOutcome::Candidate(face) => {
                let (face, units) = evaluate(step, &face, excluded, work);
                budget.spend(units);
                if let Some(face) = face {
                    detected.count = add(found, detected.count, face);
                }
            }
            ScanOutcome::Finished => {
                detected.finished = true;
                break;
            }
            ScanOutcome::BudgetSpent => break,
        }
    }
    detected
}

/// Aligns and verifies a candidate; also returns what it has cost \[units\].
#[inline(never)]
fn evaluate(
    step: &Step<'_>,
    face: &Detection,
    excluded: &Excluded,
    work: &mut Workspace,
) -> (Option<FoundFace>, u32) {
    let needed = Needed::to_refine(FIRST_ATTEMPT_CONFIDENCE);
    let Some(start) = Start::at(step, face, Origin::NewFace, needed) else {
        return (None, 0);
    };
    let candidate = Candidate::new(step, &start, work);
    let confidence = candidate.confidence.face;
    let is_face = candidate.is_finite && confidence >= start.needed.to_refine;
    if !is_face || !may_find(step, &candidate.shape, excluded) {
        return (None, candidate.units);
    }
    let mut aligned = None;
    candidate.refine(step, work, &mut aligned);
    let found = aligned.as_ref().map(|aligned| FoundFace {
        face_box: bounds(&aligned.shape),
        yaw_deg: 90.0 * face.yaw,
        roll_deg: detection_of(step.model, &aligned.shape).roll.to_degrees(),
        confidence,
    });
    (found, candidate.units + REFINE_UNITS)
}

/// Adds a face to the first `count`, unless it is among them with a higher confidence; returns how
/// many there are.
fn add(found: &mut [FoundFace], count: usize, face: FoundFace) -> usize {
    let is_same = |other: &&mut FoundFace| {
        is_same_face(&face.face_box, &other.face_box)
            || is_same_face(&other.face_box, &face.face_box)
    };
    if let Some(other) = found.iter_mut().take(count).find(is_same) {
        if face.confidence > other.confidence {
            *other = face;
        }
        return count;
    }
    match found.get_mut(count) {
        Some(slot) => {
            *slot = face;
            count + 1
        }
        None => count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_is_listed_once() {
        let face = |x: f32, confidence: f32| FoundFace {
            face_box: [x, 0.0, 100.0, 100.0],
            confidence,
            ..FoundFace::default()
        };
        let mut found = [FoundFace::default(); 2];
        assert_eq!(add(&mut found, 0, face(0.0, 0.9)), 1);
        assert_eq!(add(&mut found, 1, face(30.0, 0.95)), 1);
        assert_eq!(found[0].confidence, 0.95);
        assert_eq!(add(&mut found, 1, face(20.0, 0.85)), 1);
        assert_eq!(found[0].confidence, 0.95);
        assert_eq!(add(&mut found, 1, face(90.0, 0.85)), 2);
        assert_eq!(add(&mut found, 2, face(200.0, 0.99)), 2);
    }

    #[test]
    fn a_hint_is_a_detection_or_out_of_range() {
        let hint = FaceHint::new([10.0, 20.0, 80.0, 100.0]).with_angles(-45.0, 90.0);
        let found = hint.detection().expect("in range");
        assert_eq!([found.x, found.y, found.size], [50.0, 70.0, 100.0]);
        assert_eq!(found.yaw, -0.5);
        for bad in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
            for k in 0..4 {
                let mut hint = hint;
                hint.face_box[k] = bad;
                let is_place = k < 2 && bad == -1.0;
                assert_eq!(hint.detection().is_some(), is_place, "{hint:?}");
            }
        }
        assert_eq!(hint.with_angles(f32::NAN, 0.0).detection(), None);
    }
}
