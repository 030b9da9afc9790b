//! Errors of a tracked clip against per-frame truth.
//!
//! Frames that count are those whose truth has at least half of its landmarks in the picture. Of
//! these, P_s is the share with `success` = 1; errors are means over the tracked ones, whatever
//! their size, so a wrong lock cannot hide. Angle differences wrap at ±180°.

use posewise::{State, TrackResult};
use posewise_metrics::landmarks::{box_size, distance};
use posewise_metrics::pose::mean_angle;
use posewise_metrics::{auc, mean};
use serde_json::{Map, Value, json};

/// Share of landmarks inside the picture from which on a frame counts.
pub const MIN_IN_FRAME: f64 = 0.5;
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

/// One frame's truth.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Yaw, pitch, roll \[deg\].
    pub angles: [f64; 3],
    /// Midpoint of the eyeballs, camera frame \[mm\].
    pub eye_mid: [f64; 3],
    /// Share of the landmarks inside the picture.
    pub in_frame: f64,
    /// Landmarks \[px\].
    pub points: [[f64; 2]; 68],
    /// Landmarks that are neither hidden by the head nor covered.
    pub visible: [bool; 68],
    /// Whether something covers at least half of the landmarks; `None` if the truth has no such
    /// columns.
    pub covered: Option<bool>,
    /// Landmarks that something covers, whether or not the head hides them too.
    pub under: [bool; 68],
    /// Whether something passes before the face; `None` if the truth has no such column.
    pub occluder: Option<bool>,
}

/// One frame as tracked.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// Yaw, pitch, roll \[deg\].
    pub angles: [f64; 3],
    /// Head position \[mm\].
    pub translation: [f64; 3],
    /// Landmarks \[px\].
    pub points: [[f64; 2]; 68],
    /// Probabilities that each landmark is visible and that it is right, if the CSV has them.
    pub confidence: Option<[[f64; 2]; 68]>,
}

impl Tracked {
    /// A step's result without probabilities; `None` unless the face was fitted on that frame.
    pub fn of(result: &TrackResult) -> Option<Self> {
        (result.state == State::Tracking).then(|| Tracked {
            angles: [result.yaw_deg, result.pitch_deg, result.roll_deg].map(f64::from),
            translation: result.translation_mm.map(f64::from),
            points: result.landmarks.map(|l| [l.x, l.y].map(f64::from)),
            confidence: None,
        })
    }
}

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
    translation: f64,
    depth: f64,
    landmarks: Option<f64>,
    flipped: bool,
    /// Visibility and confidence of each inner landmark, and whether it is seen.
    seen: Vec<[(f64, bool); 2]>,
    /// Visibility of each inner landmark that is seen (`true`) or covered; those that the head
    /// hides are left out.
    uncovered: Vec<(f64, bool)>,
}

impl FrameOutcome {
    /// Compares; `tracked` is `None` when the tracker reported no success.
    pub fn new(truth: &Truth, tracked: Option<&Tracked>) -> Self {
        FrameOutcome {
            yaw: truth.angles[0],
            covered: truth.covered,
            occluder: truth.occluder,
            counts: truth.in_frame >= MIN_IN_FRAME,
            absent: truth.in_frame < OUT_OF_FRAME,
            errors: tracked.map(|t| errors(truth, t)),
        }
    }
}

/// a − b wrapped to −180..180.
pub fn angle_difference(a: f64, b: f64) -> f64 {
    (a - b + 180.0).rem_euclid(360.0) - 180.0
}

fn errors(truth: &Truth, tracked: &Tracked) -> Errors {
    let angles =
        std::array::from_fn(|i| angle_difference(tracked.angles[i], truth.angles[i]).abs());
    let d: [f64; 3] = std::array::from_fn(|i| tracked.translation[i] - truth.eye_mid[i]);
    let (true_yaw, yaw) = (truth.angles[0], tracked.angles[0]);
    Errors {
        angles,
        shrinkage: true_yaw.signum() * angle_difference(true_yaw, yaw),
        translation: d.iter().map(|v| v * v).sum::<f64>().sqrt(),
        depth: d[2].abs(),
        landmarks: landmark_error(truth, tracked),
        flipped: true_yaw.abs() >= PROFILE_YAW_DEG && true_yaw.signum() != yaw.signum(),
        seen: tracked.confidence.map_or(vec![], |confidence| {
            (17..68)
                .map(|i| confidence[i].map(|p| (p, truth.visible[i])))
                .collect()
        }),
        uncovered: tracked.confidence.map_or(vec![], |confidence| {
            let known = (17..68).filter(|i| truth.visible[*i] || truth.under[*i]);
            known
                .map(|i| (confidence[i][0], truth.visible[i]))
                .collect()
        }),
    }
}

/// Mean distance over the visible inner landmarks (17..67), over the square root of the area of
/// the box around all true landmarks; `None` when no inner landmark is visible.
pub fn landmark_error(truth: &Truth, tracked: &Tracked) -> Option<f64> {
    let distances: Vec<f64> = (17..68)
        .filter(|i| truth.visible[*i])
        .map(|i| distance(truth.points[i], tracked.points[i]))
        .collect();
    let size = box_size(&truth.points).max(1e-9);
    mean(&distances).map(|d| d / size)
}

/// The numbers of a set of frames.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Frames with truth.
    pub frames: usize,
    /// Frames that count.
    pub counted: usize,
    /// Of these, tracked.
    pub tracked: usize,
    /// Mean absolute error of yaw, pitch, roll \[deg\].
    pub angles: Option<[f64; 3]>,
    /// Mean distance from the true eye midpoint, and of that along the view \[mm\].
    pub translation: Option<(f64, f64)>,
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
    /// How well visibility and confidence separate visible inner landmarks from hidden ones: areas
    /// under the ROC.
    pub seen_auc: [Option<f64>; 2],
    /// How much smaller than the true yaw the found one is on average, towards the camera \[deg\].
    pub shrinkage: Option<f64>,
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
    let landmarks: Vec<f64> = errors.iter().filter_map(|e| e.landmarks).collect();
    let count = |f: &dyn Fn(&Errors) -> bool| errors.iter().filter(|e| f(e)).count();
    Summary {
        frames: all.len(),
        counted: counted.len(),
        tracked: errors.len(),
        angles: axis(0)
            .zip(axis(1))
            .zip(axis(2))
            .map(|((y, p), r)| [y, p, r]),
        translation: mean_of(&|e| e.translation).zip(mean_of(&|e| e.depth)),
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
        seen_auc: [0, 1].map(|k| {
            let pairs = errors.iter().flat_map(|e| e.seen.iter().map(|s| s[k]));
            auc(&pairs.collect::<Vec<_>>())
        }),
        shrinkage: mean_of(&|e| e.shrinkage),
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

impl Summary {
    /// Share of the counted frames that were tracked; `None` when none counts.
    pub fn success(&self) -> Option<f64> {
        (self.counted > 0).then(|| self.tracked as f64 / self.counted as f64)
    }

    /// Mean of the three angle errors \[deg\].
    pub fn mean_angle(&self) -> Option<f64> {
        self.angles.map(mean_angle)
    }

    /// The numbers as JSON; `null` where there are none.
    pub fn json(&self) -> Value {
        let mut map = Map::new();
        let mut put = |key: &str, value: Value| map.insert(key.into(), value);
        put("frames", json!(self.frames));
        put("counted", json!(self.counted));
        put("tracked", json!(self.tracked));
        put("p_s", json!(self.success()));
        for (i, key) in ["e_yaw_deg", "e_pitch_deg", "e_roll_deg"]
            .iter()
            .enumerate()
        {
            put(key, json!(self.angles.map(|a| a[i])));
        }
        put("e_m_deg", json!(self.mean_angle()));
        put("translation_mm", json!(self.translation.map(|t| t.0)));
        put("depth_mm", json!(self.translation.map(|t| t.1)));
        put("landmarks", json!(self.landmarks));
        put("wrong", json!(self.wrong));
        put("lost_within_60", json!(self.lost_within_60));
        put("sign_flips", json!(self.sign_flips));
        put("false_tracks", json!(self.false_tracks));
        put("visibility_auc", json!(self.seen_auc[0]));
        put("confidence_auc", json!(self.seen_auc[1]));
        put("shrinkage_deg", json!(self.shrinkage));
        put("off", json!(self.off));
        put("covered_auc", json!(self.covered_auc));
        Value::Object(map)
    }
}

#[cfg(test)]
mod tests;
