//! The programs, clips and data that everything is measured with.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use super::super::programs::Programs;

pub const WEBCAMS: [&str; 2] = ["webcam-a", "webcam-b"];
/// Share of the landmarks in the picture from which on somebody is there.
pub const PRESENT: f64 = 0.9;

/// A rendered clip with its truth.
pub struct Clip {
    pub name: String,
    pub video: PathBuf,
    pub truth: PathBuf,
    pub focal: String,
    /// What the tracker makes of it.
    pub csv: PathBuf,
}

/// Measures one part of the figures.
pub type Part = fn(&Bench) -> Result<Value>;

/// What everything is measured with.
pub struct Bench {
    pub data: PathBuf,
    pub programs: Programs,
    pub clips: Vec<Clip>,
    /// Those of `posewise-lab sweeps`; none unless they are asked for.
    pub sweeps: Vec<Clip>,
}

impl Bench {
    /// One part of the figures. A run that was cut off goes on with the first part that is missing,
    /// unless programs or model have changed since.
    pub fn part(&self, key: &str, measure: Part) -> Result<Value> {
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

    pub fn at(&self, path: &str) -> PathBuf {
        self.data.join(path)
    }

    pub fn clip(&self, start: &str) -> Result<&Clip> {
        let found = self.clips.iter().find(|clip| clip.name.starts_with(start));
        found.with_context(|| format!("no rendered clip {start}"))
    }

    /// `eval landmarks` on the photographs with automatic labels.
    pub fn photographs(&self, options: &[&str]) -> Result<Value> {
        self.photographs_of("faces68/dev", options)
    }

    /// `eval landmarks` on the photographs of a folder, whose labels are in a file beside it.
    pub fn photographs_of(&self, folder: &str, options: &[&str]) -> Result<Value> {
        let mut args = words(&["eval", "landmarks", "--csv"]);
        args.extend([text(&self.at(&format!("{folder}.csv"))), "--images".into()]);
        args.push(text(&self.at(folder)));
        args.extend(words(options));
        self.programs.json("posewise-lab", &args, true)
    }

    /// Compares tables of tracked clips with the truth, by `eval pose` or `eval eyes`.
    pub fn compare(&self, what: &str, clips: &[(&Path, &Path)]) -> Result<Value> {
        let mut args = words(&["eval", what]);
        for (truth, csv) in clips {
            args.extend(["--truth".into(), text(truth), "--csv".into(), text(csv)]);
        }
        self.programs.json("posewise-lab", &args, false)
    }
}

pub fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| word.to_string()).collect()
}

pub fn text(path: &Path) -> String {
    path.display().to_string()
}
