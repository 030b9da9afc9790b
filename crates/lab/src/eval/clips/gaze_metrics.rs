//! Scores of a gaze against the truth of each frame.

use glam::DVec3;
use posewise_metrics::{mean, median};
use serde_json::{Value, json};

/// True |yaw| up to which a gaze is compared \[deg\].
const LIMITS_DEG: [f64; 2] = [30.0, 45.0];
/// Both lids of an eye that looks have at most this true `eyeBlink` weight.
const OPEN: f64 = 0.35;
/// Most covered landmarks of both eyes, of twelve: of one covered eye it would be six.
const MOST_COVERED: usize = 3;

/// One frame of the truth.
#[derive(Clone, Copy, Debug)]
pub struct TrueGaze {
    /// Mean direction of both eyes, camera frame.
    pub both: DVec3,
    /// Weights of both lids.
    pub blinks: [f64; 2],
    /// Covered landmarks of both eyes.
    pub covered: usize,
}

impl TrueGaze {
    /// The eyes are open, and nothing covers them.
    fn is_seen(&self) -> bool {
        self.blinks.iter().all(|blink| *blink <= OPEN) && self.covered <= MOST_COVERED
    }
}

/// Scores within one limit of yaw.
#[derive(Clone, Debug, Default)]
struct Within {
    frames: usize,
    /// Angles between the gaze that is found and the true one \[deg\].
    errors: Vec<f64>,
    /// Found less true angle, to the image right and down \[deg\].
    across: Vec<f64>,
    down: Vec<f64>,
}

/// Scores of the gaze in a clip, or in several.
#[derive(Clone, Debug, Default)]
pub struct GazeScores([Within; LIMITS_DEG.len()]);

impl GazeScores {
    /// Compares one frame. `found` has the angles of both eyes' gaze to the image right and down
    /// \[rad\]; `None`: the gaze is unknown.
    pub fn compare(&mut self, truth: &TrueGaze, yaw_deg: f64, found: Option<[f64; 2]>) {
        if !truth.is_seen() {
            return;
        }
        for (within, limit) in self.0.iter_mut().zip(LIMITS_DEG) {
            if yaw_deg.abs() > limit {
                continue;
            }
            within.frames += 1;
            let Some([right, down]) = found else {
                continue;
            };
            let gaze = DVec3::new(right.tan(), down.tan(), -1.0);
            let angles = |v: DVec3| [v.x.atan2(-v.z), v.y.atan2(-v.z)];
            let [true_right, true_down] = angles(truth.both);
            within
                .errors
                .push(gaze.angle_between(truth.both).to_degrees());
            within.across.push((right - true_right).to_degrees());
            within.down.push((down - true_down).to_degrees());
        }
    }

    /// Adds those of another clip.
    pub fn add(&mut self, other: &GazeScores) {
        for (within, more) in self.0.iter_mut().zip(&other.0) {
            within.frames += more.frames;
            within.errors.extend(&more.errors);
            within.across.extend(&more.across);
            within.down.extend(&more.down);
        }
    }

    /// The numbers; `null` where the truth has no such frame.
    pub fn json(&self) -> Value {
        let of = |(within, limit): (&Within, f64)| {
            json!({
                "yaw_deg": limit,
                "frames": within.frames,
                "known": within.errors.len() as f64 / within.frames as f64,
                "mean_deg": mean(&within.errors),
                "median_deg": median(&within.errors),
                "right_deg": mean(&within.across),
                "down_deg": mean(&within.down),
            })
        };
        let compared = |(within, _): &(&Within, f64)| within.frames > 0;
        let all = self.0.iter().zip(LIMITS_DEG).filter(compared);
        let all: Vec<Value> = all.map(of).collect();
        match all.is_empty() {
            true => Value::Null,
            false => all.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AHEAD: TrueGaze = TrueGaze {
        both: DVec3::new(0.0, 0.0, -2.0),
        blinks: [0.1, 0.2],
        covered: 0,
    };

    #[test]
    fn a_gaze_is_compared_where_eyes_are_seen() {
        let mut scores = GazeScores::default();
        let (right, down) = (3f64.to_radians(), 4f64.to_radians());
        scores.compare(&AHEAD, 10.0, Some([right, down]));
        scores.compare(&AHEAD, -40.0, None);
        scores.compare(&AHEAD, 60.0, None);
        let shut = TrueGaze {
            blinks: [0.1, 0.5],
            ..AHEAD
        };
        scores.compare(&shut, 0.0, Some([0.0; 2]));
        let covered = TrueGaze {
            covered: 6,
            ..AHEAD
        };
        scores.compare(&covered, 0.0, Some([0.0; 2]));
        let [near, wide] = &scores.0;
        assert_eq!((near.frames, near.errors.len()), (1, 1));
        assert_eq!((wide.frames, wide.errors.len()), (2, 1));
        assert!((near.errors[0] - 5.0).abs() < 0.01, "{near:?}");
        assert!((near.across[0] - 3.0).abs() < 1e-9 && (near.down[0] - 4.0).abs() < 1e-9);
    }

    #[test]
    fn sums_are_of_all_clips() {
        let mut one = GazeScores::default();
        assert_eq!(one.json(), Value::Null);
        one.compare(&AHEAD, 0.0, Some([0.1, 0.0]));
        let mut all = one.clone();
        all.add(&one);
        all.compare(&AHEAD, 0.0, None);
        let json = all.json();
        assert_eq!(json[0]["frames"], 3);
        assert!((json[0]["known"].as_f64().unwrap() - 2.0 / 3.0).abs() < 1e-9);
        assert!((json[1]["right_deg"].as_f64().unwrap() - 0.1f64.to_degrees()).abs() < 1e-9);
    }
}
