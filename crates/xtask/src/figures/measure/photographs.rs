//! Labelled photographs, as they are and as a poor camera shows them.

use anyhow::Result;
use serde_json::{Value, json};

use super::bench::Bench;

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

/// Photographs whose landmarks people set: the first figures.
pub fn manual(bench: &Bench) -> Result<Value> {
    bench.photographs_of("faces300w/dev", &[])
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
