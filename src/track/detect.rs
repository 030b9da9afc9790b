//! All faces of a frame, in calls of bounded work: the search without tracking.

use super::alignment::Needed;
use super::geometry::{bounds, centre, detection_of, initial_shape, is_same_face};
use super::policy::{FIRST_ATTEMPT_CONFIDENCE, NOISY};
use super::step::{Step, WorkBudget, tile_memory};
use super::{FaceHint, Model, StepError, Tracker};
use crate::detect::{Detection, ScanOutcome, TILE_UNITS};
use crate::image::{Frame, noise_share};

/// A face of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FoundFace {
    /// Box of the landmarks: left, top, width, height \[px of the upright frame\].
    pub face_box: [f32; 4],
    /// > 0: the face turns to the image right \[deg\]; rough.
    pub yaw_deg: f32,
    /// > 0: the face tilts clockwise in the image \[deg\].
    pub roll_deg: f32,
    /// Calibrated probability that it is a face and that its landmarks are right, 0..1. Without
    /// the feature `verifier` always 1.
    pub confidence: f32,
}

impl FoundFace {
    /// For [`Tracker::step_at`].
    pub fn hint(&self) -> FaceHint {
        FaceHint::new(self.face_box).with_angles(self.yaw_deg, self.roll_deg)
    }
}

/// What one call of [`Tracker::detect`] found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Detected {
    /// Faces that were written.
    pub count: usize,
    /// Whether the scan has come to its end: every place was searched since it began.
    pub finished: bool,
}

impl Tracker {
    /// Looks for faces and writes them to `found`, the largest first. The tracker's own face stays
    /// as it is, and no timestamp is needed.
    ///
    /// A call does the work of [`Config::scan_budget`](super::Config::scan_budget) and at most one
    /// alignment more, and ends early when `found` is full. The next call, on the same frame or
    /// the next one of a video, goes on from there, until [`Detected::finished`]; the one after
    /// that begins anew. A face is reported once or more in a whole scan, and once at most in a
    /// call. Only faces in the region of interest, and none that is excluded, are reported.
    ///
    /// The scan is that of the search: a step that searches goes on with it, and restarts it when
    /// it finds a face.
    ///
    /// # Errors
    /// [`StepError::Roi`].
    pub fn detect(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        found: &mut [FoundFace],
    ) -> Result<Detected, StepError> {
        self.check_roi(frame)?;
        let step = &Step {
            model,
            frame: &match noise_share(frame) >= NOISY {
                true => frame.box_filtered(),
                false => *frame,
            },
            now_us: 0,
        };
        let mut budget = WorkBudget::new(self.config.scan_budget);
        let mut detected = Detected::default();
        while detected.count < found.len() && budget.left() >= TILE_UNITS {
            let memory = &mut tile_memory(&mut self.work);
            match (self.scanner).next_of_all(&self.config, step, &mut budget, memory) {
                ScanOutcome::Candidate(face) => {
                    if let Some(face) = self.evaluate(step, &face) {
                        detected.count = add(found, detected.count, face);
                    }
                    budget.spend(self.alignment.units);
                }
                ScanOutcome::Finished => {
                    detected.finished = true;
                    break;
                }
                ScanOutcome::BudgetSpent => break,
            }
        }
        Ok(detected)
    }

    /// Aligns and verifies a candidate; the target is not touched.
    #[inline(never)]
    fn evaluate(&mut self, step: &Step<'_>, face: &Detection) -> Option<FoundFace> {
        let align = &step.model.align;
        let canonical = align.views().initial_shape(face.yaw)?;
        let initial = initial_shape(&canonical, face)?;
        let least = FIRST_ATTEMPT_CONFIDENCE;
        if !self.align(step, &initial, align.iterations(), Needed::to_refine(least)) {
            return None;
        }
        let (shape, confidence) = (&self.alignment.shape, self.alignment.confidence.face);
        let is_wanted = self.may_find(centre(shape)) && confidence >= least;
        is_wanted.then(|| FoundFace {
            face_box: bounds(shape),
            yaw_deg: 90.0 * face.yaw,
            roll_deg: detection_of(step.model, shape).roll.to_degrees(),
            confidence,
        })
    }
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
}
