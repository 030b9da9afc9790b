//! The truth of the clip that ships with posewise, `tests/data/demo.csv`, embedded; and how far off
//! the tracker is.

use anyhow::{Context, Result};
use posewise::{LANDMARKS, State, TrackResult};
use posewise_metrics::landmarks::seen_error;
use posewise_metrics::mean;
use posewise_metrics::pose::PoseErrors;

const TRUTH: &[u8] = include_bytes!("../../assets/data/demo.csv");

/// One frame.
struct Frame {
    /// Yaw, pitch, roll \[deg\].
    angles: [f64; 3],
    /// Midpoint of the eyeballs, camera frame \[mm\].
    eye_mid: [f64; 3],
    /// Landmarks \[px\].
    points: [[f64; 2]; LANDMARKS],
    /// Those that the head does not hide.
    seen: [bool; LANDMARKS],
}

/// Every frame of the clip.
pub struct Truth {
    /// Focal length \[px\].
    pub focal: f32,
    frames: Vec<Frame>,
}

/// Means over the tracked frames; `None` of none.
pub struct Errors {
    /// Of yaw, pitch, roll \[deg\].
    pub angles: Option<[f64; 3]>,
    /// Distance from the true place, and of that along the view \[mm\].
    pub place: Option<(f64, f64)>,
    /// Of the landmarks that are seen, over the size of the face.
    pub landmarks: Option<f64>,
}

impl Truth {
    /// Reads it.
    pub fn read() -> Result<Self> {
        let mut table = csv::Reader::from_reader(TRUTH);
        let names = table.headers()?.clone();
        let mut truth = Truth {
            focal: 0.0,
            frames: Vec::new(),
        };
        for row in table.records() {
            let row = row?;
            let number = |name: &str| -> Result<f64> {
                let at = names.iter().position(|n| n == name);
                let cell = at
                    .and_then(|at| row.get(at))
                    .with_context(|| name.to_string())?;
                cell.parse().with_context(|| name.to_string())
            };
            truth.focal = number("fx")? as f32;
            truth.frames.push(Frame::of(&number)?);
        }
        Ok(truth)
    }

    /// Compares the results of the clip's frames.
    pub fn errors<'r>(&self, results: impl Iterator<Item = &'r TrackResult>) -> Errors {
        let mut pose = PoseErrors::default();
        let (mut places, mut depths, mut landmarks) = (Vec::new(), Vec::new(), Vec::new());
        for (truth, result) in self.frames.iter().zip(results) {
            if result.state != State::Tracking {
                continue;
            }
            let angles = [result.yaw_deg, result.pitch_deg, result.roll_deg].map(f64::from);
            pose.push(truth.angles, Some(angles));
            let place = result.translation_mm.map(f64::from);
            let off: [f64; 3] = std::array::from_fn(|i| place[i] - truth.eye_mid[i]);
            places.push(off.iter().map(|v| v * v).sum::<f64>().sqrt());
            depths.push(off[2].abs());
            let found = result.landmarks.map(|l| [l.x, l.y].map(f64::from));
            landmarks.extend(seen_error(&truth.points, &truth.seen, &found));
        }
        Errors {
            angles: pose.mean(),
            place: mean(&places).zip(mean(&depths)),
            landmarks: mean(&landmarks),
        }
    }
}

impl Frame {
    fn of(number: &dyn Fn(&str) -> Result<f64>) -> Result<Self> {
        let mut frame = Frame {
            angles: [number("yaw")?, number("pitch")?, number("roll")?],
            eye_mid: [
                number("eye_mid_x")?,
                number("eye_mid_y")?,
                number("eye_mid_z")?,
            ],
            points: [[0.0; 2]; LANDMARKS],
            seen: [false; LANDMARKS],
        };
        for i in 0..LANDMARKS {
            let of = |letter: char| number(&format!("{letter}{i}"));
            frame.points[i] = [of('x')?, of('y')?];
            frame.seen[i] = of('v')? > 0.5;
        }
        Ok(frame)
    }
}
