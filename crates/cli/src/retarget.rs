//! Weights for an avatar: what a file of `track --retarget` makes of those that are tracked. The
//! page's `web/demo/avatar/retargeting.js` reads the same files, and says the same of wrong ones.

use std::path::Path;

use anyhow::{Context, Result, bail};
use posewise::eyes::EYE_LOOK_NAMES;
use posewise::{ANIMATION_NAMES, ANIMATIONS, State, TrackResult};
use serde_json::{Map, Value};

use crate::bounded;

/// ARKit's shapes, in its order.
pub const SHAPES: [&str; 52] = [
    "eyeBlinkLeft",
    "eyeLookDownLeft",
    "eyeLookInLeft",
    "eyeLookOutLeft",
    "eyeLookUpLeft",
    "eyeSquintLeft",
    "eyeWideLeft",
    "eyeBlinkRight",
    "eyeLookDownRight",
    "eyeLookInRight",
    "eyeLookOutRight",
    "eyeLookUpRight",
    "eyeSquintRight",
    "eyeWideRight",
    "jawForward",
    "jawLeft",
    "jawRight",
    "jawOpen",
    "mouthClose",
    "mouthFunnel",
    "mouthPucker",
    "mouthLeft",
    "mouthRight",
    "mouthSmileLeft",
    "mouthSmileRight",
    "mouthFrownLeft",
    "mouthFrownRight",
    "mouthDimpleLeft",
    "mouthDimpleRight",
    "mouthStretchLeft",
    "mouthStretchRight",
    "mouthRollLower",
    "mouthRollUpper",
    "mouthShrugLower",
    "mouthShrugUpper",
    "mouthPressLeft",
    "mouthPressRight",
    "mouthLowerDownLeft",
    "mouthLowerDownRight",
    "mouthUpperUpLeft",
    "mouthUpperUpRight",
    "browDownLeft",
    "browDownRight",
    "browInnerUp",
    "browOuterUpLeft",
    "browOuterUpRight",
    "cheekPuff",
    "cheekSquintLeft",
    "cheekSquintRight",
    "noseSneerLeft",
    "noseSneerRight",
    "tongueOut",
];

/// Largest file \[MB\].
const MOST_MB: u64 = 1;

/// Least and greatest numbers of a file.
const MOST_GAIN: [f64; 2] = [-10.0, 10.0];
const MOST_OFFSET: [f64; 2] = [-1.0, 1.0];
const MOST_CLAMP: [f64; 2] = [-2.0, 2.0];

/// How a shape is driven.
#[derive(Clone, Debug)]
struct Drive {
    gain: f64,
    offset: f64,
    clamp: [f64; 2],
    /// Weights that are tracked, by their number, and their shares.
    from: Vec<(usize, f64)>,
}

/// How all shapes are driven.
#[derive(Clone, Debug)]
pub struct Retargeting([Drive; SHAPES.len()]);

/// Names of the weights that are tracked: those of the animation, then those of the gaze.
fn tracked_names() -> impl Iterator<Item = &'static str> {
    ANIMATION_NAMES.into_iter().chain(EYE_LOOK_NAMES)
}

impl Default for Retargeting {
    /// Weights as they are tracked.
    fn default() -> Self {
        Retargeting(SHAPES.map(|shape| {
            Drive {
                gain: 1.0,
                offset: 0.0,
                clamp: [0.0, 1.0],
                from: tracked_names()
                    .position(|name| name == shape)
                    .map(|at| (at, 1.0))
                    .into_iter()
                    .collect(),
            }
        }))
    }
}

impl Retargeting {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self> {
        let text = bounded::read_text("retargeting", path, MOST_MB)?;
        Self::parse(&text).with_context(|| format!("cannot use retargeting {}", path.display()))
    }

    fn parse(text: &str) -> Result<Self> {
        let file: Value = match serde_json::from_str(text) {
            Ok(file) => file,
            Err(error) => bail!("not JSON: {error}"),
        };
        let file = named(&file, "the file")?;
        check_fields(file, &["shapes"], "")?;
        let mut retargeting = Self::default();
        let shapes = named(file.get("shapes").unwrap_or(&Value::Null), "shapes")?;
        for (name, entry) in shapes {
            let at = SHAPES.iter().position(|shape| shape == name);
            let at = at.with_context(|| format!("shapes.{name}: ARKit has no such shape"))?;
            retargeting.0[at].change(&format!("shapes.{name}"), entry)?;
        }
        Ok(retargeting)
    }

    /// The avatar's weights, in the order of [`SHAPES`]. What nothing drives is 0, and without a
    /// face everything.
    pub fn weights(&self, result: &TrackResult) -> [f32; SHAPES.len()] {
        if result.state == State::Searching {
            return [0.0; SHAPES.len()];
        }
        let tracked: Vec<f64> = (result.animation.iter())
            .chain(&result.eyes.look)
            .map(|weight| f64::from(*weight))
            .collect();
        self.0.each_ref().map(|drive| drive.weight(&tracked))
    }

    /// The weights that are tracked too, in the tracker's order: those of the person's own head.
    pub fn animation(&self, result: &TrackResult) -> [f32; ANIMATIONS] {
        let weights = self.weights(result);
        ANIMATION_NAMES.map(|name| {
            let at = SHAPES.iter().position(|shape| *shape == name);
            at.map_or(0.0, |at| weights[at])
        })
    }
}

impl Drive {
    fn change(&mut self, place: &str, entry: &Value) -> Result<()> {
        let entry = named(entry, place)?;
        let dotted = format!("{place}.");
        check_fields(entry, &["gain", "offset", "clamp", "from"], &dotted)?;
        let numbers = [("gain", MOST_GAIN), ("offset", MOST_OFFSET)];
        for ((name, range), number) in numbers.into_iter().zip([&mut self.gain, &mut self.offset]) {
            if let Some(value) = entry.get(name) {
                *number = within(value, range, &format!("{dotted}{name}"))?;
            }
        }
        if let Some(value) = entry.get("clamp") {
            self.clamp = clamp(value, &format!("{dotted}clamp"))?;
        }
        if let Some(value) = entry.get("from") {
            let from = named(value, &format!("{dotted}from"))?;
            let source = |(name, share): (&String, &Value)| {
                let place = format!("{dotted}from.{name}");
                let at = tracked_names().position(|tracked| tracked == name);
                let at = at.with_context(|| format!("{place}: no such weight is tracked"))?;
                Ok((at, within(share, MOST_GAIN, &place)?))
            };
            self.from = from.iter().map(source).collect::<Result<_>>()?;
        }
        Ok(())
    }

    fn weight(&self, tracked: &[f64]) -> f32 {
        if self.from.is_empty() {
            return 0.0;
        }
        let sum: f64 = self
            .from
            .iter()
            .map(|(at, share)| share * tracked[*at])
            .sum();
        let [least, most] = self.clamp;
        (self.gain * sum + self.offset).clamp(least, most) as f32
    }
}

fn named<'a>(value: &'a Value, place: &str) -> Result<&'a Map<String, Value>> {
    value
        .as_object()
        .with_context(|| format!("{place}: not an object"))
}

/// Refuses fields that are not known.
fn check_fields(value: &Map<String, Value>, known: &[&str], before: &str) -> Result<()> {
    let unknown = value.keys().find(|name| !known.contains(&name.as_str()));
    match unknown {
        Some(name) => bail!("{before}{name}: no such field"),
        None => Ok(()),
    }
}

fn within(value: &Value, [least, most]: [f64; 2], place: &str) -> Result<f64> {
    let number = value.as_f64().filter(|v| (least..=most).contains(v));
    number.with_context(|| format!("{place}: not a number from {least} to {most}"))
}

fn clamp(value: &Value, place: &str) -> Result<[f64; 2]> {
    let [least, most] = MOST_CLAMP;
    let ends: Option<Vec<f64>> = (value.as_array()).and_then(|ends| {
        ends.iter()
            .map(|end| within(end, MOST_CLAMP, "").ok())
            .collect()
    });
    match ends.as_deref() {
        Some([low, high]) if low <= high => Ok([*low, *high]),
        _ => bail!("{place}: not two numbers from {least} to {most}, the lower first"),
    }
}

/// Names of the columns that `--retarget` adds to the CSV.
pub fn columns() -> Vec<String> {
    SHAPES
        .iter()
        .map(|shape| format!("avatar_{shape}"))
        .collect()
}

/// Their values.
pub fn cells(weights: &[f32]) -> Vec<String> {
    weights
        .iter()
        .map(|weight| format!("{weight:.3}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cases that the page's code passes too: `web/test/retargeting.mjs`.
    const CASES: &str = include_str!("../../../tests/data/retargeting.json");

    fn result(weights: &Map<String, Value>) -> TrackResult {
        let mut result = TrackResult::default();
        result.state = State::Tracking;
        let weight = |name: &str| weights.get(name).and_then(Value::as_f64).unwrap_or(0.0) as f32;
        result.animation = ANIMATION_NAMES.map(weight);
        result.eyes.look = EYE_LOOK_NAMES.map(weight);
        result
    }

    #[test]
    fn files_give_the_weights_that_they_should() {
        let cases: Value = serde_json::from_str(CASES).unwrap();
        let cases = cases.as_array().unwrap();
        assert!(cases.len() > 20);
        for case in cases {
            let file = match &case["file"] {
                Value::String(text) => text.clone(),
                file => file.to_string(),
            };
            let read = Retargeting::parse(&file);
            if let Some(says) = case["says"].as_str() {
                let error = format!("{:#}", read.expect_err(says));
                assert!(error.starts_with(says), "{error}");
                continue;
            }
            let read = read.unwrap_or_else(|error| panic!("{file}: {error:#}"));
            let given = result(case["tracked"].as_object().unwrap());
            let expected = case["weights"].as_object().unwrap();
            for (shape, weight) in SHAPES.iter().zip(read.weights(&given)) {
                let expected = expected.get(*shape).and_then(Value::as_f64).unwrap_or(0.0);
                assert!(
                    (f64::from(weight) - expected).abs() < 1e-6,
                    "{file} {shape} {weight}"
                );
            }
        }
    }

    #[test]
    fn the_file_of_the_docs_is_read() {
        let docs = include_str!("../../../docs/avatar.md");
        let text = docs.split("```json\n").nth(1).expect("an example");
        Retargeting::parse(text.split("```").next().expect("its end")).unwrap();
    }

    #[test]
    fn every_weight_has_a_shape() {
        assert!(tracked_names().all(|name| SHAPES.contains(&name)));
        let mut result = TrackResult::default();
        result.animation = std::array::from_fn(|i| i as f32 / 100.0);
        let as_tracked = Retargeting::default();
        assert_eq!(as_tracked.weights(&result), [0.0; 52], "no face");
        result.state = State::Coasting;
        assert_eq!(as_tracked.animation(&result), result.animation);
    }
}
