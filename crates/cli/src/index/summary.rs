//! What the manifest says of a video: spans with a face, where it looks, gaps between them.

use posewise::{State, TrackResult};
use serde_json::{Value, json};

/// A face whose nose points to the camera within this angle faces it \[deg\].
const FACING_DEG: f32 = 15.0;

/// Frames in a row with a face: tracked, or coasted for a moment.
struct Span {
    start_us: i64,
    end_us: i64,
    frames: u64,
    /// Of the frames that were tracked: count, those that face the camera, and of yaw, pitch and
    /// roll the sum, least and greatest \[deg\].
    tracked: u64,
    facing: u64,
    angles: [Angle; 3],
}

#[derive(Clone, Copy)]
struct Angle {
    sum: f64,
    least: f32,
    greatest: f32,
}

impl Angle {
    const NONE: Angle = Angle {
        sum: 0.0,
        least: f32::INFINITY,
        greatest: f32::NEG_INFINITY,
    };

    fn add(&mut self, value: f32) {
        self.sum += f64::from(value);
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }

    fn json(&self, count: u64) -> Value {
        let tenths = |value: f64| (10.0 * value).round() / 10.0;
        json!({
            "mean": tenths(self.sum / count.max(1) as f64),
            "min": tenths(self.least.into()),
            "max": tenths(self.greatest.into()),
        })
    }
}

/// Collects a video's frames.
pub struct Summary {
    /// Time that a frame is shown \[µs\].
    frame_us: i64,
    frames: u64,
    tracked: u64,
    end_us: i64,
    spans: Vec<Span>,
    /// Whether the last frame had a face.
    is_open: bool,
}

impl Summary {
    /// Of a video with this frame rate.
    pub fn new(fps: f64) -> Self {
        Summary {
            frame_us: (1e6 / fps) as i64,
            frames: 0,
            tracked: 0,
            end_us: 0,
            spans: Vec::new(),
            is_open: false,
        }
    }

    /// The next frame.
    pub fn add(&mut self, result: &TrackResult) {
        let start_us = result.timestamp_us;
        self.end_us = start_us + self.frame_us;
        self.frames += 1;
        let (was_open, has_face) = (self.is_open, result.state != State::Searching);
        self.is_open = has_face;
        if !has_face {
            return;
        }
        if !was_open {
            self.spans.push(Span {
                start_us,
                end_us: start_us,
                frames: 0,
                tracked: 0,
                facing: 0,
                angles: [Angle::NONE; 3],
            });
        }
        let Some(span) = self.spans.last_mut() else {
            return;
        };
        span.end_us = self.end_us;
        span.frames += 1;
        if result.state == State::Tracking {
            self.tracked += 1;
            span.tracked += 1;
            span.facing += u64::from(angle_to_camera_deg(result) <= FACING_DEG);
            let angles = [result.yaw_deg, result.pitch_deg, result.roll_deg];
            for (all, angle) in span.angles.iter_mut().zip(angles) {
                all.add(angle);
            }
        }
    }

    /// The fields of the manifest.
    pub fn finish(self) -> Value {
        let mut gaps = Vec::new();
        let mut last_us = 0;
        let ends = [(self.end_us, self.end_us)];
        for (start, end) in (self.spans.iter().map(|s| (s.start_us, s.end_us))).chain(ends) {
            if start > last_us {
                gaps.push(json!({ "start_s": seconds(last_us), "end_s": seconds(start) }));
            }
            last_us = end;
        }
        json!({
            "frames": self.frames,
            "duration_s": seconds(self.end_us),
            "tracked_frames": self.tracked,
            "spans": self.spans.iter().map(Span::json).collect::<Vec<_>>(),
            "gaps": gaps,
        })
    }
}

impl Span {
    fn json(&self) -> Value {
        let [yaw, pitch, roll] = self.angles.map(|angle| angle.json(self.tracked));
        let share = self.facing as f64 / self.tracked.max(1) as f64;
        json!({
            "start_s": seconds(self.start_us),
            "end_s": seconds(self.end_us),
            "frames": self.frames,
            "yaw_deg": yaw,
            "pitch_deg": pitch,
            "roll_deg": roll,
            "facing_share": (1e3 * share).round() / 1e3,
        })
    }
}

fn seconds(us: i64) -> f64 {
    us as f64 / 1e6
}

/// Angle between where the nose points and the way from the head to the camera \[deg\].
fn angle_to_camera_deg(result: &TrackResult) -> f32 {
    let nose = glam::Quat::from_array(result.rotation) * glam::Vec3::NEG_Z;
    let to_camera = -glam::Vec3::from_array(result.translation_mm);
    nose.angle_between(to_camera).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_and_gaps_by_hand() {
        let mut summary = Summary::new(10.0);
        let mut result = TrackResult::default();
        result.rotation = [0.0, 0.0, 0.0, 1.0];
        result.translation_mm = [0.0, 0.0, 500.0];
        use State::{Coasting, Searching, Tracking};
        let states = [
            Searching, Tracking, Coasting, Searching, Searching, Tracking,
        ];
        for (i, state) in (0..).zip(states) {
            (result.state, result.timestamp_us) = (state, 100_000 * i);
            result.yaw_deg = 10.0 * i as f32;
            if i == 5 {
                // The nose points along the axis, the camera is 45° to the side.
                result.translation_mm = [500.0, 0.0, 500.0];
            }
            summary.add(&result);
        }
        let found = summary.finish();
        assert_eq!(
            (&found["frames"], &found["tracked_frames"]),
            (&json!(6), &json!(2))
        );
        assert_eq!(found["duration_s"], 0.6);
        let gap = |a: f64, b: f64| json!({ "start_s": a, "end_s": b });
        assert_eq!(found["gaps"], json!([gap(0.0, 0.1), gap(0.3, 0.5)]));
        let [first, second] = &found["spans"].as_array().unwrap()[..] else {
            panic!("two spans: {found}");
        };
        assert_eq!(
            (&first["start_s"], &first["end_s"]),
            (&json!(0.1), &json!(0.3))
        );
        assert_eq!(
            (&first["frames"], &first["facing_share"]),
            (&json!(2), &json!(1.0))
        );
        assert_eq!(
            first["yaw_deg"],
            json!({ "mean": 10.0, "min": 10.0, "max": 10.0 })
        );
        assert_eq!(
            (&second["end_s"], &second["facing_share"]),
            (&json!(0.6), &json!(0.0))
        );
    }

    #[test]
    fn a_video_without_a_face_is_one_gap() {
        let mut summary = Summary::new(10.0);
        summary.add(&TrackResult::default());
        let found = summary.finish();
        assert_eq!(found["gaps"], json!([{ "start_s": 0.0, "end_s": 0.1 }]));
        assert_eq!(found["spans"], json!([]));
    }
}
