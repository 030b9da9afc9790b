//! Angles of heads whose yaw and pitch are labelled.
//!
//! Yaw is compared by |label|, towards the label's side; pitch by label. Angles are given relative
//! to the line of sight ("facing") and along the camera's axes ("axis").

use posewise_metrics::statistics::centred;
use posewise_metrics::{mean, median};
use serde_json::{Map, Value, json};

/// Bands of |labelled pitch| in which yaw is compared \[deg\]: above the first, up to the second.
pub const PITCH_BANDS: [(&str, f64, f64); 3] = [
    ("0-15", f64::NEG_INFINITY, 15.0),
    ("15-30", 15.0, 30.0),
    ("30-60", 30.0, 60.0),
];
/// |labelled yaw| up to which pitch is compared \[deg\].
pub const PITCH_YAW_DEG: f64 = 15.0;

/// Yaw and pitch \[deg\]: > 0 to the image right, and up.
#[derive(Clone, Copy, Debug)]
pub struct Angles {
    /// > 0: to the image right \[deg\].
    pub yaw: f64,
    /// > 0: up \[deg\].
    pub pitch: f64,
}

/// The outcome of one picture.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// What the table says.
    pub label: Angles,
    /// `None` when no face was found.
    pub found: Option<Found>,
}

/// What was found in a picture.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Relative to the line of sight, and along the camera's axes.
    pub angles: [Angles; 2],
    /// Whether the first step found it.
    pub is_at_once: bool,
}

/// An angle of the found pictures with one label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// Median \[deg\].
    pub median: Option<f64>,
    /// Mean absolute difference from the label \[deg\].
    pub error: Option<f64>,
}

/// The pictures with one label.
#[derive(Clone, Debug)]
pub struct Row {
    /// The label \[deg\].
    pub label: f64,
    /// Number of pictures.
    pub count: usize,
    /// How many of them were found.
    pub found: usize,
    /// How many of them in the first step.
    pub at_once: usize,
    /// Relative to the line of sight, and along the camera's axes.
    pub angles: [Angle; 2],
}

/// Rows by label, and what belongs to all of them.
#[derive(Clone, Debug)]
pub struct Block {
    /// By label, in its order.
    pub rows: Vec<Row>,
    /// Slope of the least-squares line through angle over label: 1 when a head that turns by
    /// 1° is said to; facing and axis.
    pub slopes: [Option<f64>; 2],
}

/// Yaw of the pictures, by |label|.
pub fn by_yaw<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Block {
    block(outcomes.map(|o| {
        // To the left, both are mirrored. A label of 0 has no side.
        let side = if o.label.yaw < 0.0 { -1.0 } else { 1.0 };
        let found = o
            .found
            .map(|f| (f.angles.map(|a| side * a.yaw), f.is_at_once));
        (o.label.yaw.abs(), found)
    }))
}

/// Pitch of the pictures, by label.
pub fn by_pitch<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Block {
    block(outcomes.map(|o| {
        let found = o.found.map(|f| (f.angles.map(|a| a.pitch), f.is_at_once));
        (o.label.pitch, found)
    }))
}

/// A picture's label, its two angles, and whether it was found at once.
type Labelled = (f64, Option<([f64; 2], bool)>);

fn block(pictures: impl Iterator<Item = Labelled>) -> Block {
    let pictures: Vec<Labelled> = pictures.collect();
    let mut labels: Vec<f64> = pictures.iter().map(|(label, _)| *label).collect();
    labels.sort_by(f64::total_cmp);
    labels.dedup();
    let pairs = |k: usize| -> Vec<(f64, f64)> {
        let of = |(label, found): &Labelled| found.map(|(angles, _)| (*label, angles[k]));
        pictures.iter().filter_map(of).collect()
    };
    Block {
        rows: labels.into_iter().map(|l| row(l, &pictures)).collect(),
        slopes: [0, 1].map(|k| slope(&pairs(k))),
    }
}

fn row(label: f64, pictures: &[Labelled]) -> Row {
    let pictures = || pictures.iter().filter(|(l, _)| *l == label);
    let found = || pictures().filter_map(|(_, found)| *found);
    let angle = |k: usize| {
        let angles: Vec<f64> = found().map(|(angles, _)| angles[k]).collect();
        let errors: Vec<f64> = angles.iter().map(|a| (a - label).abs()).collect();
        Angle {
            median: median(&angles),
            error: mean(&errors),
        }
    };
    Row {
        label,
        count: pictures().count(),
        found: found().count(),
        at_once: found().filter(|(_, is_at_once)| *is_at_once).count(),
        angles: [0, 1].map(angle),
    }
}

/// Slope of the least-squares line; `None` when the labels do not vary.
fn slope(pairs: &[(f64, f64)]) -> Option<f64> {
    let (xy, xx) = centred(pairs).fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + x * y, xx + x * x));
    (xx > 1e-9).then(|| xy / xx)
}

impl Block {
    /// The numbers as JSON.
    pub fn json(&self) -> Value {
        let row = |row: &Row| {
            let share = |part: usize| part as f64 / row.count.max(1) as f64;
            let angle = |a: Angle| json!({"median": a.median, "error": a.error});
            let [facing, axis] = row.angles.map(angle);
            let value = json!({"count": row.count, "found": share(row.found),
                "at_once": share(row.at_once), "facing": facing, "axis": axis});
            (row.label.to_string(), value)
        };
        let rows: Map<String, Value> = self.rows.iter().map(row).collect();
        let [facing, axis] = self.slopes;
        json!({"labels": rows, "slope": {"facing": facing, "axis": axis}})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(label: f64, yaws: Option<[f64; 2]>) -> Outcome {
        let angles = |yaw: f64| Angles { yaw, pitch: 0.0 };
        Outcome {
            label: angles(label),
            found: yaws.map(|yaws| Found {
                angles: yaws.map(angles),
                is_at_once: label == 30.0,
            }),
        }
    }

    #[test]
    fn sides_are_joined() {
        let outcomes = [
            outcome(-30.0, Some([-28.0, -20.0])),
            outcome(30.0, Some([26.0, 24.0])),
            outcome(30.0, None),
            outcome(0.0, Some([2.0, 0.0])),
        ];
        let block = by_yaw(outcomes.iter());
        let [zero, thirty] = &block.rows[..] else {
            panic!("{block:?}");
        };
        assert_eq!((zero.label, zero.count, zero.found), (0.0, 1, 1));
        assert_eq!((thirty.label, thirty.count), (30.0, 3));
        assert_eq!((thirty.found, thirty.at_once), (2, 1));
        let angle = |median, error| Angle {
            median: Some(median),
            error: Some(error),
        };
        assert_eq!(thirty.angles, [angle(27.0, 3.0), angle(22.0, 8.0)]);
        // Through (0, 2) and the mean of the others, (30, 27).
        assert!((block.slopes[0].unwrap() - 25.0 / 30.0).abs() < 1e-12);
    }

    #[test]
    fn one_label_has_no_slope() {
        let block = by_pitch([outcome(5.0, Some([1.0; 2]))].iter());
        assert_eq!(block.slopes, [None, None]);
        assert_eq!(block.rows[0].angles[0].median, Some(0.0));
    }
}
