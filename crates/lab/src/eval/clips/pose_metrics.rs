//! Errors of a tracked clip against per-frame truth.
//!
//! Frames that count are those whose truth has at least half of its landmarks in the picture. Of
//! these, P_s is the share with `success` = 1; errors are means over the tracked ones, whatever
//! their size, so a wrong lock cannot hide. Angle differences wrap at ±180°.

use crate::compare::counts;
use crate::tracked::{Confidence, Frame, Tracked};
use crate::truth::Truth;
use posewise_metrics::landmarks::{INNER, seen_error};
use posewise_metrics::pose::{angle_difference, mean_angle};
use posewise_metrics::{auc, mean};
use serde::Serialize;

/// Share below which a tracked frame is a false track.
pub const OUT_OF_FRAME: f64 = 0.1;
/// Largest angle error beyond which a tracked frame is a wrong lock \[deg\].
pub const WRONG_DEG: f64 = 30.0;
/// |yaw| within which no frame should be lost \[deg\].
pub const KEEP_YAW_DEG: f64 = 60.0;
/// |yaw| from which on the sign of the yaw is checked \[deg\].
pub const PROFILE_YAW_DEG: f64 = 60.0;

/// An angle error beyond which a tracked frame counts as off \[deg\].
pub const OFF_DEG: f64 = 20.0;
/// Width of the bands of |true yaw| in which the error's sign is measured \[deg\].
pub const STEP_DEG: f64 = 10.0;
/// The last of these bands begins here \[deg\].
pub const LAST_STEP_DEG: f64 = 90.0;
/// Wider bands of |true yaw| beside them \[deg\].
pub const WIDE: [(&str, f64, f64); 2] = [("0-60", 0.0, 60.0), ("60-95", 60.0, f64::INFINITY)];

/// Bands of |true yaw| \[deg\].
pub const BANDS: [(&str, f64, f64); 2] = [("0-45", 0.0, 45.0), ("45-90", 45.0, f64::INFINITY)];

/// What one frame adds to the numbers.
#[derive(Clone, Debug)]
pub struct FrameOutcome {
    yaw: f64,
    covered: Option<bool>,
    occluder: Option<bool>,
    counts: bool,
    absent: bool,
    errors: Option<Errors>,
}

#[derive(Clone, Debug)]
struct Errors {
    angles: [f64; 3],
    /// How much smaller the found yaw is, towards the camera \[deg\].
    shrinkage: f64,
    /// Distance from the true place, and of that along the view \[mm\].
    place: Option<[f64; 2]>,
    landmarks: Option<f64>,
    flipped: bool,
    /// Visibility and confidence of each inner landmark, and whether it is seen.
    seen: Vec<[(f64, bool); 2]>,
    /// Visibility of each inner landmark that is seen (`true`) or covered; those that the head
    /// hides are left out.
    uncovered: Vec<(f64, bool)>,
}

impl FrameOutcome {
    /// Compares.
    pub fn new(truth: &Truth, frame: &Frame) -> Self {
        let tracked = frame.tracked.as_ref();
        FrameOutcome {
            yaw: truth.angles[0],
            covered: truth.is_covered(),
            occluder: truth.occluder,
            counts: counts(truth),
            absent: truth.in_frame < OUT_OF_FRAME,
            errors: tracked.map(|tracked| Errors::of(truth, tracked, frame)),
        }
    }
}

impl Errors {
    fn of(truth: &Truth, tracked: &Tracked, frame: &Frame) -> Errors {
        let (true_yaw, yaw) = (truth.angles[0], tracked.angles[0]);
        let place = frame.translation.zip(truth.eye_mid).map(|(found, is)| {
            let off: [f64; 3] = std::array::from_fn(|i| found[i] - is[i]);
            [off.iter().map(|v| v * v).sum::<f64>().sqrt(), off[2].abs()]
        });
        let mut errors = Errors {
            angles: std::array::from_fn(|i| {
                angle_difference(tracked.angles[i], truth.angles[i]).abs()
            }),
            shrinkage: true_yaw.signum() * angle_difference(true_yaw, yaw),
            place,
            landmarks: seen_error(&truth.points, &truth.visible, &tracked.points),
            flipped: true_yaw.abs() >= PROFILE_YAW_DEG && true_yaw.signum() != yaw.signum(),
            seen: vec![],
            uncovered: vec![],
        };
        if let Some(Confidence {
            landmarks,
            visibility: Some(visibility),
            ..
        }) = &frame.confidence
        {
            let covered = truth.covered.unwrap_or([false; 68]);
            for i in INNER..68 {
                let is_seen = truth.visible[i];
                errors
                    .seen
                    .push([(visibility[i], is_seen), (landmarks[i], is_seen)]);
                if is_seen || covered[i] {
                    errors.uncovered.push((visibility[i], is_seen));
                }
            }
        }
        errors
    }
}

/// The numbers of a set of frames; `None` where there are none.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Frames with truth.
    pub frames: usize,
    /// Frames that count.
    pub counted: usize,
    /// Of these, tracked.
    pub tracked: usize,
    /// The same as a share.
    pub p_s: Option<f64>,
    /// Mean absolute errors.
    pub e_yaw_deg: Option<f64>,
    /// See `e_yaw_deg`.
    pub e_pitch_deg: Option<f64>,
    /// See `e_yaw_deg`.
    pub e_roll_deg: Option<f64>,
    /// Mean of the three.
    pub e_m_deg: Option<f64>,
    /// Mean distance from the true eye midpoint.
    pub translation_mm: Option<f64>,
    /// The same along the view.
    pub depth_mm: Option<f64>,
    /// Mean landmark error over the box's size.
    pub landmarks: Option<f64>,
    /// Tracked frames with an angle more than [`WRONG_DEG`] off.
    pub wrong: usize,
    /// Frames that count, within ±[`KEEP_YAW_DEG`], not tracked.
    pub lost_within_60: usize,
    /// Tracked frames beyond ±[`PROFILE_YAW_DEG`] with yaw of the other sign.
    pub sign_flips: usize,
    /// Frames without a face in the picture that were tracked.
    pub false_tracks: usize,
    /// How well visibility separates visible inner landmarks from hidden ones: area under the ROC.
    pub visibility_auc: Option<f64>,
    /// The same of confidence.
    pub confidence_auc: Option<f64>,
    /// How much smaller than the true yaw the found one is on average, towards the camera.
    pub shrinkage_deg: Option<f64>,
    /// Share of the tracked frames with an angle more than [`OFF_DEG`] off.
    pub off: Option<f64>,
    /// How well visibility separates visible inner landmarks from covered ones.
    pub covered_auc: Option<f64>,
}

/// Sums up.
pub fn summarize<'a>(outcomes: impl Iterator<Item = &'a FrameOutcome>) -> Summary {
    let all: Vec<&FrameOutcome> = outcomes.collect();
    let counted: Vec<&FrameOutcome> = all.iter().copied().filter(|o| o.counts).collect();
    let errors: Vec<&Errors> = counted.iter().filter_map(|o| o.errors.as_ref()).collect();
    let mean_of =
        |f: &dyn Fn(&Errors) -> f64| mean(&errors.iter().map(|e| f(e)).collect::<Vec<_>>());
    let axis = |i: usize| mean_of(&|e| e.angles[i]);
    let place = |k: usize| {
        let known = errors.iter().filter_map(|e| Some(e.place?[k]));
        mean(&known.collect::<Vec<_>>())
    };
    let landmarks: Vec<f64> = errors.iter().filter_map(|e| e.landmarks).collect();
    let count = |f: &dyn Fn(&Errors) -> bool| errors.iter().filter(|e| f(e)).count();
    let seen_auc = |k: usize| {
        let pairs = errors.iter().flat_map(|e| e.seen.iter().map(|s| s[k]));
        auc(&pairs.collect::<Vec<_>>())
    };
    let angles = axis(0).zip(axis(1)).zip(axis(2));
    Summary {
        frames: all.len(),
        counted: counted.len(),
        tracked: errors.len(),
        p_s: (!counted.is_empty()).then(|| errors.len() as f64 / counted.len() as f64),
        e_yaw_deg: axis(0),
        e_pitch_deg: axis(1),
        e_roll_deg: axis(2),
        e_m_deg: angles.map(|((yaw, pitch), roll)| mean_angle([yaw, pitch, roll])),
        translation_mm: place(0),
        depth_mm: place(1),
        landmarks: mean(&landmarks),
        wrong: count(&|e| e.angles.iter().any(|a| *a > WRONG_DEG)),
        lost_within_60: counted
            .iter()
            .filter(|o| o.errors.is_none() && o.yaw.abs() <= KEEP_YAW_DEG)
            .count(),
        sign_flips: count(&|e| e.flipped),
        false_tracks: all
            .iter()
            .filter(|o| o.absent && o.errors.is_some())
            .count(),
        visibility_auc: seen_auc(0),
        confidence_auc: seen_auc(1),
        shrinkage_deg: mean_of(&|e| e.shrinkage),
        off: mean_of(&|e| f64::from(u8::from(e.angles.iter().any(|a| *a > OFF_DEG)))),
        covered_auc: {
            let pairs = errors.iter().flat_map(|e| e.uncovered.iter().copied());
            auc(&pairs.collect::<Vec<_>>())
        },
    }
}

/// Sums up one band of |true yaw|.
pub fn summarize_band(outcomes: &[FrameOutcome], from: f64, to: f64) -> Summary {
    summarize(
        outcomes
            .iter()
            .filter(|o| (from..to).contains(&o.yaw.abs())),
    )
}

/// The bands of [`WIDE`], and those of [`STEP_DEG`] each, with their names.
pub fn summarize_steps(outcomes: &[FrameOutcome]) -> Vec<(String, Summary)> {
    let wide = WIDE.map(|(name, from, to)| (name.to_string(), from, to));
    let count = (LAST_STEP_DEG / STEP_DEG) as usize;
    let steps = (0..=count).map(|k| {
        let (from, to) = (STEP_DEG * k as f64, STEP_DEG * (k + 1) as f64);
        let end = if k == count { f64::INFINITY } else { to };
        (format!("{from}-{to}"), from, end)
    });
    wide.into_iter()
        .chain(steps)
        .map(|(name, from, to)| (name, summarize_band(outcomes, from, to)))
        .collect()
}

/// Sums up the frames in which something passes before the face; `None` when no truth has this
/// column.
pub fn summarize_occluded(outcomes: &[FrameOutcome]) -> Option<Summary> {
    let known = outcomes.iter().any(|o| o.occluder.is_some());
    known.then(|| summarize(outcomes.iter().filter(|o| o.occluder == Some(true))))
}

/// Sums up the frames in which at least half of the landmarks are covered, or the others; `None`
/// when no truth has these columns.
pub fn summarize_covered(outcomes: &[FrameOutcome], covered: bool) -> Option<Summary> {
    let known = outcomes.iter().filter(|o| o.covered.is_some());
    let mut known = known.peekable();
    known.peek()?;
    Some(summarize(known.filter(|o| o.covered == Some(covered))))
}

#[cfg(test)]
mod tests;
