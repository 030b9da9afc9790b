//! One JSON object per frame: what `--jsonl` writes. The same quantities as the CSV's, grouped.

use std::io::Write;

use anyhow::{Context, Result};
use posewise::eyes::{EYE_LOOK_NAMES, EyeUnknown};
use posewise::{ANIMATION_NAMES, TrackResult};
use serde_json::{Map, Value, json};

use crate::csv::Row;
use crate::fields::FIELDS;
use crate::retarget::SHAPES;
use crate::value::{MaybeGaze, camera, head, number, numbers, share, sigma_deg};

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
    out.insert("eyes".into(), eyes(r));
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
fn eyes(result: &TrackResult) -> Value {
    let eyes = &result.eyes;
    let share = |value| number(share(result, value));
    let gaze = |gaze: MaybeGaze| {
        json!({
            "status": EyeUnknown::name_of(gaze),
            "camera": numbers(&camera(gaze)),
            "head": numbers(&head(gaze)),
            "sigma_deg": number(sigma_deg(gaze)),
        })
    };
    let look: Map<String, Value> = EYE_LOOK_NAMES
        .iter()
        .zip(eyes.look)
        .map(|(name, weight)| (name.to_string(), number(weight)))
        .collect();
    let [left, right] = eyes.each.each_ref().map(|eye| {
        json!({
            "status": EyeUnknown::name_of(eye.open),
            "open": share(eye.open.ok()),
            "iris": numbers(&eye.iris),
            "gaze": gaze(eye.gaze),
        })
    });
    json!({
        "left": left,
        "right": right,
        "gaze": gaze(eyes.gaze),
        "glasses": share(eyes.glasses),
        "dark_glasses": share(eyes.dark_glasses),
        "look": look,
    })
}

/// Writes one frame's line, with the weights of an avatar where there is one.
pub fn write(
    out: &mut impl Write,
    row: &Row<'_>,
    avatar: Option<&[f32; SHAPES.len()]>,
) -> Result<()> {
    let mut object = object(row);
    if let Some(weights) = avatar {
        let weights = SHAPES.iter().zip(weights);
        let weights = weights.map(|(name, weight)| (name.to_string(), number(*weight)));
        object["avatar"] = weights.collect::<Map<String, Value>>().into();
    }
    writeln!(out, "{object}").context("cannot write the JSON lines")
}
