//! `cargo xtask measure`: measures one model on the evaluation data, a quarter of an hour each.

mod bench;
mod clips;
mod photographs;
mod search;
mod sweeps;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
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
    #[arg(long, default_value = "models/posewise.posewise")]
    model: PathBuf,
    /// Clips that `posewise-lab sweeps` wrote, to be measured too.
    #[arg(long)]
    sweeps: Option<PathBuf>,
    /// The JSON to write; docs/figures/MODEL.json unless given.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Measure only these parts, separated by commas, and keep the others in the JSON.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let name = args.model.file_stem().context("the model is not a file")?;
    let name = name.to_string_lossy().into_owned();
    let out = args.out.clone().unwrap_or_else(|| super::figures_of(&name));
    let model = args.model.canonicalize()?;
    let data = args.data.canonicalize()?;
    let scratch = root().join("target/measure").join(&name);
    let is_wanted = |key: &str| args.only.is_empty() || args.only.iter().any(|name| name == key);
    let mut built = vec![
        ("posewise-cli", "posewise"),
        ("posewise-lab", "posewise-lab"),
    ];
    if is_wanted("real_eyes") {
        built.push(("posewise-train", "posewise-train"));
    }
    let programs = Programs::build(&root(), &model, scratch, &built)?;
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
    let crc = super::value::checksum(&std::fs::read(&model)?)?;
    let mut figures = match args.only.is_empty() {
        true => Map::new(),
        false => others(&out, &crc)?,
    };
    figures.insert("model".into(), json!({"crc32": crc}));
    let parts = parts(!bench.sweeps.is_empty());
    for name in &args.only {
        ensure!(parts.iter().any(|(key, _)| key == name), "no part {name}");
    }
    for (key, measure) in parts.into_iter().filter(|(key, _)| is_wanted(key)) {
        figures.insert(key.into(), bench.part(key, measure)?);
    }
    if is_wanted("bench") {
        figures.insert("processor".into(), processor().into());
    }
    let all = bench.programs.scratch.join("all.json");
    let figures = Value::Object(figures);
    std::fs::write(all, serde_json::to_string_pretty(&figures)?)?;
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let shown = super::pages::shown(&name, figures)?;
    std::fs::write(&out, super::value::lines(&shown)).with_context(|| out.display().to_string())
}

/// What is measured, in the order of the JSON.
fn parts(has_sweeps: bool) -> Vec<(&'static str, Part)> {
    let mut parts: Vec<(&str, Part)> = vec![
        ("photographs_manual", photographs::manual),
        ("profiles", photographs::profiles),
        ("angles", photographs::angles),
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
        ("bench", |b| {
            b.programs.json("posewise-lab", &["bench"], true)
        }),
    ];
    if has_sweeps {
        parts.push(("sweeps", sweeps::sweeps));
    }
    parts
}

/// The figures that a file has, which must be those of this model.
fn others(file: &Path, crc: &str) -> Result<Map<String, Value>> {
    let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
    let figures: Map<String, Value> = serde_json::from_str(&text)?;
    let measured = figures.get("model").map(|model| &model["crc32"]);
    ensure!(
        measured == Some(&Value::from(crc)),
        "{} has the figures of another model",
        file.display()
    );
    Ok(figures)
}

/// The name of the processor that the times are of, where the system has it.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(": "))
        .map_or("unknown", |(_, name)| name)
        .into()
}
