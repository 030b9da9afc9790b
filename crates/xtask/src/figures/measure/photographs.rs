//! Labelled photographs, as they are and as a poor camera shows them.

use anyhow::Result;
use serde_json::{Value, json};

use super::bench::{Bench, text, words};

/// Options of `eval landmarks` for photographs that are turned.
const ROLLS: [&str; 3] = ["30", "45", "-45"];
/// Options of `eval landmarks` for photographs as a poor camera shows them.
const POOR: [&[&str]; 5] = [
    &["--gain", "0.15", "--noise", "3"],
    &["--contrast", "0.15"],
    &["--noise", "15"],
    &["--noise", "25"],
    &["--blur", "3"],
];

/// Focal length of the pictures with labelled angles \[px\].
const POINTING_FOCAL: &str = "1300";

/// Photographs whose landmarks people set: the first figures.
pub fn manual(bench: &Bench) -> Result<Value> {
    bench.photographs_of("faces300w/dev", &[])
}

/// Real profiles, found as `posewise track` finds faces.
pub fn profiles(bench: &Bench) -> Result<Value> {
    heads(bench, "profiles", "profiles/dev.csv", "profiles/dev", &[])
}

/// Real heads with labelled angles, with the camera left unknown and told.
pub fn angles(bench: &Bench) -> Result<Value> {
    let of = |options: &[&str]| {
        let csv = "pointing04/labels.csv";
        heads(bench, "angles", csv, "pointing04", options)
    };
    let unknown = of(&["--yaw-left"])?;
    Ok(json!({"unknown": unknown, "told": of(&["--yaw-left", "--focal", POINTING_FOCAL])?}))
}

/// What `eval` says of labelled pictures.
fn heads(bench: &Bench, what: &str, csv: &str, images: &str, options: &[&str]) -> Result<Value> {
    let mut args = words(&["eval", what, "--min-face", "40", "--csv"]);
    args.extend([
        text(&bench.at(csv)),
        "--images".into(),
        text(&bench.at(images)),
    ]);
    args.extend(words(options));
    bench.programs.json("posewise-lab", &args, true)
}

pub fn photographs_turned(bench: &Bench) -> Result<Value> {
    let one = |roll: &&str| {
        Ok(json!({"roll_deg": roll, "result": bench.photographs(&["--roll", roll])?}))
    };
    ROLLS.iter().map(one).collect()
}

pub fn photographs_poor(bench: &Bench) -> Result<Value> {
    let one = |options: &&[&str]| {
        let result = bench.photographs(options)?;
        Ok(json!({"options": options.join(" "), "result": result}))
    };
    POOR.iter().map(one).collect()
}
