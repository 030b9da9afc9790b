//! `posewise-lab eval pose`: what `track --csv` wrote against per-frame truth.

use std::path::Path;

use anyhow::Result;
use serde_json::{Map, Value, json};

use super::pairs::{ClipsArgs, clips_of};
use super::pose_metrics::{
    BANDS, FrameOutcome, summarize, summarize_band, summarize_covered, summarize_occluded,
    summarize_steps,
};
use crate::table::Table;
use crate::{output, tracked, truth};

/// Runs the command.
pub fn run(args: &ClipsArgs) -> Result<()> {
    let mut clips = Map::new();
    let mut all = Vec::new();
    for (truth, csv) in clips_of(args)? {
        let outcomes = compare(truth, csv)?;
        clips.insert(truth.display().to_string(), figures(&outcomes));
        all.extend(outcomes);
    }
    let mut value = figures(&all);
    if clips.len() > 1 {
        value["clips"] = clips.into();
    }
    output::show(&value, args.json.as_deref())
}

fn compare(truth: &Path, csv: &Path) -> Result<Vec<FrameOutcome>> {
    let truth = truth::whole(&Table::read(truth)?)?;
    let mut frames = tracked::read(csv)?;
    let outcomes = truth.iter().map(|truth| {
        let frame = frames.remove(&truth.frame).unwrap_or_default();
        FrameOutcome::new(truth, &frame)
    });
    Ok(outcomes.collect())
}

fn figures(outcomes: &[FrameOutcome]) -> Value {
    let mut value = json!(summarize(outcomes.iter()));
    let bands = BANDS.map(|(name, from, to)| {
        let band = summarize_band(outcomes, from, to);
        (name.to_string(), json!(band))
    });
    let steps = summarize_steps(outcomes).into_iter();
    let steps: Map<String, Value> = steps.map(|(name, s)| (name, json!(s))).collect();
    value["yaw_bands"] = Map::from_iter(bands).into();
    value["yaw_steps"] = steps.into();
    value["occluded"] = json!(summarize_occluded(outcomes));
    value["covered"] = json!(summarize_covered(outcomes, true));
    value["uncovered"] = json!(summarize_covered(outcomes, false));
    value
}
