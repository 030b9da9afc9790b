//! `cargo xtask measure`: measures one model on the evaluation data, a quarter of an hour each.

mod clips;
mod photographs;
mod search;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::{Map, Value, json};

use super::programs::Programs;
use crate::root;

/// Arguments of `measure`.
#[derive(clap::Args)]
pub struct Args {
    /// The data folder of docs/training.md.
    #[arg(long, default_value = "../shared/data")]
    data: PathBuf,
    /// The model.
    #[arg(long, default_value = "models/default.posewise")]
    model: PathBuf,
    /// The JSON to write; docs/figures/MODEL.json unless given.
    #[arg(long)]
    out: Option<PathBuf>,
}

const WEBCAMS: [&str; 2] = ["webcam-a", "webcam-b"];
/// Share of the landmarks in the picture from which on somebody is there.
const PRESENT: f64 = 0.9;

/// A rendered clip with its truth.
struct Clip {
    name: String,
    video: PathBuf,
    truth: PathBuf,
    focal: String,
    /// What the tracker makes of it.
    csv: PathBuf,
}

/// Measures one part of the figures.
type Part = fn(&Bench) -> Result<Value>;

/// What everything is measured with.
struct Bench {
    data: PathBuf,
    programs: Programs,
    clips: Vec<Clip>,
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
    let clips = clips::rendered_clips(&data, &programs.scratch)?;
    let bench = Bench {
        data,
        programs,
        clips,
    };
    let mut figures = Map::new();
    let crc = super::value::checksum(&std::fs::read(&model)?)?;
    figures.insert("model".into(), json!({"name": name, "crc32": crc}));
    let parts: [(&str, Part); 13] = [
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
    figures.insert("processor".into(), processor().into());
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let text = serde_json::to_string_pretty(&Value::Object(figures))?;
    std::fs::write(&out, text + "\n").with_context(|| out.display().to_string())
}

impl Bench {
    /// One part of the figures. A run that was cut off goes on with the first part that is missing,
    /// unless programs or model have changed since.
    fn part(&self, key: &str, measure: Part) -> Result<Value> {
        let name = format!("{key}-{:016x}.json", self.programs.fingerprint);
        let path = self.programs.scratch.join(name);
        if let Ok(text) = std::fs::read_to_string(&path) {
            return Ok(serde_json::from_str(&text)?);
        }
        eprintln!("{key}");
        let value = measure(self)?;
        std::fs::write(&path, value.to_string())?;
        Ok(value)
    }

    fn at(&self, path: &str) -> PathBuf {
        self.data.join(path)
    }

    fn clip(&self, start: &str) -> Result<&Clip> {
        let found = self.clips.iter().find(|clip| clip.name.starts_with(start));
        found.with_context(|| format!("no rendered clip {start}"))
    }

    fn photographs(&self, options: &[&str]) -> Result<Value> {
        let mut args = words(&["eval", "landmarks", "--csv"]);
        args.extend([text(&self.at("faces68/dev.csv")), "--images".into()]);
        args.push(text(&self.at("faces68/dev")));
        args.extend(words(options));
        self.programs.json("posewise", &args, true)
    }

    /// Compares tables of tracked clips with the truth, by `eval pose` or `eval eyes`.
    fn compare(&self, what: &str, clips: &[(&Path, &Path)]) -> Result<Value> {
        let mut args = words(&["eval", what]);
        for (truth, csv) in clips {
            args.extend(["--truth".into(), text(truth), "--csv".into(), text(csv)]);
        }
        self.programs.json("posewise", &args, false)
    }
}

fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| word.to_string()).collect()
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// The name of the processor that the times are of, where the system tells it.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(": "))
        .map_or("unknown", |(_, name)| name)
        .into()
}
