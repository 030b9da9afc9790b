//! `cargo xtask measure`: measures one model on the evaluation data, a quarter of an hour each.

mod bench;
mod clips;
mod photographs;
mod search;
mod sweeps;

use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::{Map, Value, json};

use super::programs::Programs;
use crate::root;
use bench::{Bench, Part};

/// Arguments of `measure`.
#[derive(clap::Args)]
pub struct Args {
    /// The data folder of docs/dev/training.md.
    #[arg(long, default_value = "../shared/data")]
    data: PathBuf,
    /// The model.
    #[arg(long, default_value = "models/default.posewise")]
    model: PathBuf,
    /// Clips that `posewise-lab sweeps` wrote, to be measured too.
    #[arg(long)]
    sweeps: Option<PathBuf>,
    /// The JSON to write; docs/figures/MODEL.json unless given.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let name = args.model.file_stem().context("the model is not a file")?;
    let name = name.to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| super::figures_of(&name));
    let model = args.model.canonicalize()?;
    let data = args.data.canonicalize()?;
    let scratch = root().join("target/measure").join(&name);
    let programs = Programs::build(&root(), &model, scratch)?;
    let clips = clips::rendered_clips(&data.join("clips-rendered"), "mp4", &programs.scratch)?;
    let sweeps = match &args.sweeps {
        Some(folder) => clips::rendered_clips(folder, "y4m.gz", &programs.scratch)?,
        None => vec![],
    };
    let bench = Bench {
        data,
        programs,
        clips,
        sweeps,
    };
    let mut figures = Map::new();
    let crc = super::value::checksum(&std::fs::read(&model)?)?;
    figures.insert("model".into(), json!({"name": name, "crc32": crc}));
    let parts: [(&str, Part); 14] = [
        ("photographs_manual", photographs::manual),
        ("photographs", |b| b.photographs(&[])),
        ("photographs_turned", photographs::photographs_turned),
        ("photographs_poor", photographs::photographs_poor),
        ("clips", clips::rendered),
        ("smoothed_clips", clips::smoothed),
        ("stills", clips::stills),
        ("real_eyes", clips::real_eyes),
        ("webcams", clips::webcams),
        ("fast_motion", search::fast_motion),
        ("first_lock", search::first_lock),
        ("lost_and_found", search::lost_and_found),
        ("drift", clips::drift),
        ("bench", |b| b.programs.json("posewise", &["bench"], true)),
    ];
    for (key, measure) in parts {
        figures.insert(key.into(), bench.part(key, measure)?);
    }
    if !bench.sweeps.is_empty() {
        figures.insert("sweeps".into(), bench.part("sweeps", sweeps::sweeps)?);
    }
    figures.insert("processor".into(), processor().into());
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let text = serde_json::to_string_pretty(&Value::Object(figures))?;
    std::fs::write(&out, text + "\n").with_context(|| out.display().to_string())
}

/// The name of the processor that the times are of, where the system has it.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(": "))
        .map_or("unknown", |(_, name)| name)
        .into()
}
