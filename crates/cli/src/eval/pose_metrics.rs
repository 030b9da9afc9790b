//! Errors of a tracked clip against per-frame truth.
//!
//! Frames that count are those whose truth has at least half of its landmarks in the picture. Of
//! these, P_s is the share with `success` = 1; errors are means over the tracked ones, whatever
//! their size, so a wrong lock cannot hide. Angle differences wrap at ±180°.

use posewise::track::{State, TrackResult};
use posewise_metrics::landmarks::{bounds, distance};
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
    counts: bool,
    absent: bool,
    errors: Option<Errors>,
}

#[derive(Clone, Debug)]
struct Errors {
    angles: [f64; 3],
    translation: f64,
    depth: f64,
    landmarks: Option<f64>,
    flipped: bool,
    /// Visibility and confidence of each inner landmark, and whether it is seen.
    seen: Vec<[(f64, bool); 2]>,
}

impl FrameOutcome {
    /// Compares; `tracked` is `None` when the tracker reported no success.
    pub fn new(truth: &Truth, tracked: Option<&Tracked>) -> Self {
        FrameOutcome {
            yaw: truth.angles[0],
            covered: truth.covered,
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
        translation: d.iter().map(|v| v * v).sum::<f64>().sqrt(),
        depth: d[2].abs(),
        landmarks: landmark_error(truth, tracked),
        flipped: true_yaw.abs() >= PROFILE_YAW_DEG && true_yaw.signum() != yaw.signum(),
        seen: tracked.confidence.map_or(vec![], |confidence| {
            (17..68)
                .map(|i| confidence[i].map(|p| (p, truth.visible[i])))
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
    let [l, t, r, b] = bounds(&truth.points);
    let size = ((r - l) * (b - t)).max(1e-9).sqrt();
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
        self.angles.map(|a| a.iter().sum::<f64>() / 3.0)
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
        Value::Object(map)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(yaw: f64) -> Truth {
        // Box 100 × 64: its size is 80.
        let mut points = [[50.0, 32.0]; 68];
        points[0] = [0.0, 0.0];
        points[1] = [100.0, 64.0];
        Truth {
            angles: [yaw, 0.0, 0.0],
            eye_mid: [0.0, 0.0, 600.0],
            in_frame: 1.0,
            points,
            visible: [true; 68],
            covered: None,
        }
    }

    fn tracked(truth: &Truth, angles: [f64; 3]) -> Tracked {
        Tracked {
            angles: std::array::from_fn(|i| truth.angles[i] + angles[i]),
            translation: [3.0, 0.0, 604.0],
            points: truth.points,
            confidence: None,
        }
    }

    #[test]
    fn angles_wrap() {
        assert_eq!(angle_difference(179.0, -179.0), -2.0);
        assert_eq!(angle_difference(-179.0, 179.0), 2.0);
        assert_eq!(angle_difference(10.0, 4.0), 6.0);
    }

    #[test]
    fn landmarks_by_hand() {
        let mut t = truth(0.0);
        let mut found = tracked(&t, [0.0; 3]);
        // The jaw does not count, nor does what is hidden.
        found.points[5] = [500.0, 500.0];
        found.points[20] = [900.0, 0.0];
        t.visible[20] = false;
        (21..31).for_each(|i| found.points[i][0] += 8.0);
        let error = landmark_error(&t, &found).unwrap();
        assert!((error - 10.0 * 8.0 / 50.0 / 80.0).abs() < 1e-12, "{error}");
        t.visible = [false; 68];
        assert_eq!(landmark_error(&t, &found), None);
    }

    #[test]
    fn covered_frames_are_told_apart() {
        let outcome = |covered: Option<bool>, error: f64| {
            let t = Truth {
                covered,
                ..truth(0.0)
            };
            let found = tracked(&t, [error; 3]);
            FrameOutcome::new(&t, Some(&found))
        };
        assert!(summarize_covered(&[outcome(None, 1.0)], false).is_none());
        let some = [
            outcome(Some(true), 4.0),
            outcome(Some(false), 1.0),
            outcome(Some(false), 2.0),
        ];
        let covered = |is: bool| summarize_covered(&some, is).unwrap();
        assert_eq!(covered(true).mean_angle(), Some(4.0));
        assert_eq!(covered(false).mean_angle(), Some(1.5));
        assert_eq!((covered(true).counted, covered(false).counted), (1, 2));
    }

    #[test]
    fn summary_by_hand() {
        let frames = [
            (truth(10.0), Some([2.0, -1.0, 0.0])),
            (truth(-40.0), Some([4.0, 3.0, 6.0])),
            (truth(50.0), None),
            (truth(80.0), Some([-170.0, 0.0, 0.0])),
            (truth(70.0), None),
        ];
        let mut outcomes: Vec<FrameOutcome> = frames
            .iter()
            .map(|(t, e)| FrameOutcome::new(t, e.map(|e| tracked(t, e)).as_ref()))
            .collect();
        let mut gone = truth(0.0);
        gone.in_frame = 0.0;
        outcomes.push(FrameOutcome::new(&gone, Some(&tracked(&gone, [0.0; 3]))));
        let s = summarize(outcomes.iter());
        assert_eq!((s.frames, s.counted, s.tracked), (6, 5, 3));
        assert_eq!(s.success(), Some(0.6));
        let angles = s.angles.unwrap();
        assert!((angles[0] - (2.0 + 4.0 + 170.0) / 3.0).abs() < 1e-9);
        assert!((angles[1] - 4.0 / 3.0).abs() < 1e-9);
        assert!((angles[2] - 2.0).abs() < 1e-9);
        assert_eq!(s.translation, Some((5.0, 4.0)));
        assert_eq!((s.wrong, s.lost_within_60), (1, 1));
        assert_eq!((s.sign_flips, s.false_tracks), (1, 1));
        let near = summarize_band(&outcomes, 0.0, 30.0);
        assert_eq!((near.counted, near.mean_angle()), (1, Some(1.0)));
        assert_eq!(summarize_band(&outcomes, 60.0, f64::INFINITY).counted, 2);
    }
}
