//! One JSON object per frame: what `--jsonl` writes. The same quantities as the CSV's, grouped.

use std::io::Write;

use anyhow::{Context, Result};
use posewise::{ANIMATION_NAMES, EYE_LOOK_NAMES, EyeUnknown, Eyes, Gaze};
use serde_json::{Map, Value, json};

use crate::csv::Row;

/// Shortest decimal form of an f32, so that 0.1 is not written as 0.10000000149011612.
pub fn number(value: f32) -> Value {
    value
        .to_string()
        .parse::<f64>()
        .map_or(Value::Null, Value::from)
}

/// A list of them.
pub fn numbers(values: &[f32]) -> Value {
    values.iter().copied().map(number).collect()
}

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
    json!({
        "frame": row.frame,
        "face_id": row.face_id,
        "timestamp_us": r.timestamp_us,
        "age_us": r.age_us,
        "state": r.state.name(),
        "confidence": number(r.confidence),
        "box": numbers(&r.face_box),
        "rotation": numbers(&r.rotation),
        "yaw_deg": number(r.yaw_deg),
        "pitch_deg": number(r.pitch_deg),
        "roll_deg": number(r.roll_deg),
        "translation_mm": numbers(&r.translation_mm),
        "eye_open": numbers(&r.eye_open),
        "loss": r.loss.name(),
        "visible_share": number(r.visible_share),
        "rotation_sigma_deg": numbers(&r.rotation_sigma_deg),
        "translation_sigma_mm": numbers(&r.translation_sigma_mm),
        "facing_yaw_deg": number(r.facing_yaw_deg),
        "facing_pitch_deg": number(r.facing_pitch_deg),
        "facing_roll_deg": number(r.facing_roll_deg),
        "facing_sigma_deg": numbers(&r.facing_sigma_deg),
        "focal_px": number(r.focal_px),
        "camera_assumed": r.camera_assumed,
        "eyes": eyes(&r.eyes),
        "animation": animation,
        "landmarks": landmarks,
        "points_mm": points,
    })
}

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
