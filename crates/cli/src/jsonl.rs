//! One JSON object per frame: what `--jsonl` writes. The same quantities as the CSV's, grouped.

use std::io::Write;

use anyhow::{Context, Result};
use posewise::{ANIMATION_NAMES, EYE_LOOK_NAMES, EyeUnknown, Eyes, Gaze};
use serde_json::{Map, Value, json};

use crate::csv::Row;
use crate::fields::FIELDS;
use crate::value::{number, numbers};

/// The object of one frame.
pub fn object(row: &Row<'_>) -> Value {
    let r = row.result;
    let animation: Map<String, Value> = ANIMATION_NAMES
        .iter()
        .zip(r.animation)
        .map(|(name, weight)| (name.to_string(), number(weight)))
        .collect();
    let landmarks: Vec<Value> = r
        .landmarks
        .iter()
        .map(|l| numbers(&[l.x, l.y, l.confidence, l.visibility]))
        .collect();
    let points: Vec<Value> = r.points_mm.iter().map(|p| numbers(p)).collect();
    let mut out = Map::new();
    out.insert("frame".into(), row.frame.into());
    out.insert("face_id".into(), row.face_id.into());
    let fields = FIELDS.iter().filter(|field| !NESTED.contains(&field.name));
    let (times, others): (Vec<_>, Vec<_>) = fields.partition(|field| field.name.ends_with("_us"));
    for field in times.into_iter().chain(others) {
        let name = match field.name {
            "face_box" => "box",
            name => name,
        };
        out.insert(name.into(), (field.value)(r).json());
    }
    out.insert("eyes".into(), eyes(&r.eyes));
    out.insert("animation".into(), animation.into());
    out.insert("landmarks".into(), landmarks.into());
    out.insert("points_mm".into(), points.into());
    out.into()
}

/// Fields that are in the object `eyes`.
const NESTED: [&str; 13] = [
    "eye_open_probability",
    "eye_status",
    "iris_left",
    "iris_right",
    "gaze_status",
    "gaze_sigma_deg",
    "gaze_left",
    "gaze_right",
    "gaze",
    "gaze_head",
    "glasses",
    "dark_glasses",
    "eye_look",
];

/// What is seen of the eyes: the person's left and right one, then both together.
fn eyes(eyes: &Eyes) -> Value {
    let gaze = |gaze: &Gaze| {
        json!({
            "status": EyeUnknown::name_of(gaze.unknown),
            "camera": numbers(&gaze.camera),
            "head": numbers(&gaze.head),
            "sigma_deg": number(gaze.sigma_deg),
        })
    };
    let look: Map<String, Value> = EYE_LOOK_NAMES
        .iter()
        .zip(eyes.look)
        .map(|(name, weight)| (name.to_string(), number(weight)))
        .collect();
    let [left, right] = eyes.each.each_ref().map(|eye| {
        json!({
            "status": EyeUnknown::name_of(eye.unknown),
            "open": number(eye.open),
            "iris": numbers(&eye.iris),
            "gaze": gaze(&eye.gaze),
        })
    });
    json!({
        "left": left,
        "right": right,
        "gaze": gaze(&eyes.gaze),
        "glasses": number(eyes.glasses),
        "dark_glasses": number(eyes.dark_glasses),
        "look": look,
    })
}

/// Writes one frame's line.
pub fn write(out: &mut impl Write, row: &Row<'_>) -> Result<()> {
    writeln!(out, "{}", object(row)).context("cannot write the JSON lines")
}
