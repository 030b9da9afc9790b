//! What is measured of a method on clips with truth.

use crate::tracked::Frame;
use crate::truth::Truth;
use posewise_metrics::jitter::{Shape, landmark_jitter, second_difference};
use posewise_metrics::landmarks::{INNER, box_size, nme_percent};
use posewise_metrics::pose::{PoseErrors, angle_difference};
use posewise_metrics::{mean, median};
use serde::Serialize;

/// Share of the landmarks in the picture from which on a frame counts.
const IN_FRAME: f64 = 0.5;
/// Mean angle error beyond which a frame is lost, whatever the tracker says \[deg\].
pub const LOST_DEG: f64 = 20.0;

/// Whether a frame counts: enough of the face is in the picture.
pub fn counts(truth: &Truth) -> bool {
    truth.in_frame >= IN_FRAME
}

/// Root of the area of the labels' box \[px\], at least 1.
pub fn size(truth: &Truth) -> f64 {
    box_size(&truth.points).max(1.0)
}

/// Mean distance of the inner landmarks \[% of [`size`]\].
pub fn nme(truth: &Truth, found: &Shape) -> f64 {
    let pairs = truth.points.into_iter().zip(*found).skip(INNER);
    nme_percent(pairs, size(truth))
}

/// Found less true angles, from −180 to 180.
pub fn signed(truth: &Truth, frame: &Frame) -> Option<[f64; 3]> {
    let angles = frame.tracked.as_ref()?.angles;
    Some([0, 1, 2].map(|i| angle_difference(angles[i], truth.angles[i])))
}

/// Mean over the axes of the mean distance of the errors from their median.
fn spread(errors: &[[f64; 3]]) -> Option<f64> {
    let axis = |i: usize| {
        let all: Vec<f64> = errors.iter().map(|e| e[i]).collect();
        let middle = median(&all)?;
        mean(&all.iter().map(|e| (e - middle).abs()).collect::<Vec<_>>())
    };
    Some((axis(0)? + axis(1)? + axis(2)?) / 3.0)
}

/// Sums over frames.
#[derive(Default)]
pub struct Sums {
    pose: PoseErrors,
    /// Errors with sign of tracked frames \[deg\].
    signed: Vec<[f64; 3]>,
    /// Mean distance of the inner landmarks in tracked frames \[%\].
    nme: Vec<f64>,
    /// Second differences of the landmarks' errors, over the box's size.
    jitter: Vec<Shape>,
    milliseconds: Vec<f64>,
}

impl Sums {
    /// The frames of one clip.
    pub fn add(&mut self, truth: &[Truth], frames: &[Frame]) {
        let mut before: Vec<Option<Shape>> = Vec::new();
        for (truth, frame) in truth.iter().zip(frames) {
            self.milliseconds.extend(frame.milliseconds);
            if !counts(truth) {
                before.push(None);
                continue;
            }
            let tracked = frame.tracked.as_ref();
            self.pose.push(truth.angles, tracked.map(|t| t.angles));
            self.signed.extend(signed(truth, frame));
            let found = tracked.map(|t| t.points).filter(|_| truth.is_marked());
            self.nme.extend(found.map(|found| nme(truth, &found)));
            before.push(found.map(|found| {
                std::array::from_fn(|i| [0, 1].map(|k| found[i][k] - truth.points[i][k]))
            }));
            if let [.., Some(a), Some(b), Some(c)] = &before[..] {
                let scale = 1.0 / size(truth);
                self.jitter.push(second_difference([a, b, c], scale));
            }
        }
    }

    /// The measures.
    pub fn row(&self, method: &str, clip: Option<&str>) -> Row {
        let errors = self.pose.per_frame();
        let near = errors.iter().filter(|e| **e <= LOST_DEG).count();
        let within = (!self.pose.is_empty()).then(|| near as f64 / self.pose.len() as f64);
        let axis = |i: usize| self.pose.mean().map(|e| e[i]);
        Row {
            method: method.into(),
            clip: clip.map(String::from),
            frames: self.pose.len(),
            tracked_percent: self.pose.success().map(|s| 100.0 * s),
            within_percent: within.map(|s| 100.0 * s),
            yaw_deg: axis(0),
            pitch_deg: axis(1),
            roll_deg: axis(2),
            mean_deg: self.pose.mean_angle(),
            centred_deg: spread(&self.signed),
            nme_percent: mean(&self.nme),
            jitter_percent: landmark_jitter(&self.jitter).map(|j| 100.0 * j),
            milliseconds: mean(&self.milliseconds),
        }
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The tracker.
    pub method: String,
    /// The clip; `None` for all of them.
    pub clip: Option<String>,
    /// Frames that count.
    pub frames: usize,
    /// Share of them that the tracker reports as tracked, P_s.
    pub tracked_percent: Option<f64>,
    /// Share of them with a mean angle error of at most [`LOST_DEG`].
    pub within_percent: Option<f64>,
    /// Mean error of the tracked frames.
    pub yaw_deg: Option<f64>,
    /// The same of pitch.
    pub pitch_deg: Option<f64>,
    /// The same of roll.
    pub roll_deg: Option<f64>,
    /// Mean of the three.
    pub mean_deg: Option<f64>,
    /// The same after the median error of each angle, with sign, is taken off: two definitions of
    /// a straight head differ by a constant.
    pub centred_deg: Option<f64>,
    /// Mean distance of the inner landmarks over the root of the area of the labels' box.
    pub nme_percent: Option<f64>,
    /// Second difference of the landmarks' errors over the same.
    pub jitter_percent: Option<f64>,
    /// Mean processor time of a step.
    pub milliseconds: Option<f64>,
}

impl Row {
    /// The head of [`Row::markdown`]'s rows.
    pub fn head() -> String {
        let head = "| method | frames | P_s % | within 20° % | E_yaw ° | E_pitch ° | E_roll ° \
                    | E_m ° | NME % | jitter % | ms |\n|";
        head.to_string() + &"---|".repeat(11)
    }

    /// A row of a table in Markdown.
    pub fn markdown(&self) -> String {
        let clip = self
            .clip
            .as_ref()
            .map_or(String::new(), |c| format!(" {c}"));
        let values = [
            self.tracked_percent,
            self.within_percent,
            self.yaw_deg,
            self.pitch_deg,
            self.roll_deg,
            self.mean_deg,
            self.nme_percent,
            self.jitter_percent,
            self.milliseconds,
        ];
        let cell = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.2}"));
        let cells = values.map(cell).join(" | ");
        format!("| {}{clip} | {} | {cells} |", self.method, self.frames)
    }
}
