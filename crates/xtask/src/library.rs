//! The static library, as `make` builds it.

use crate::{output_of, root};
use anyhow::{Context, Result};
use std::path::PathBuf;
use std::process::Command;

/// One build of the static library.
#[derive(Clone, Debug)]
pub struct Library {
    /// The machine, by its name in Rust; `None` is this one.
    pub target: Option<String>,
    /// Optional parts that are left out: names of default features in Cargo.toml.
    pub without: Vec<String>,
    /// Cargo's build folder. Programs that link the library are written there too.
    pub target_dir: PathBuf,
}

impl Library {
    /// Builds the library unless it is up to date, and gives its path.
    pub fn build(&self) -> Result<PathBuf> {
        output_of(&mut self.make())?;
        let mut path = self.target_dir.clone();
        path.extend(&self.target);
        Ok(path.join("dist/lib/libposewise.a"))
    }

    /// Whether this machine has a Rust that knows the target.
    pub fn can_be_built(&self) -> bool {
        output_of(self.make().arg("--dry-run")).is_ok()
    }

    /// Suffix for the names of files that belong to the target.
    pub(crate) fn target_name(&self) -> &str {
        self.target.as_deref().unwrap_or("host")
    }

    fn make(&self) -> Command {
        let mut make = Command::new("make");
        make.args(["--silent", "--directory"]).arg(root());
        make.arg("lib");
        make.arg(format!("TARGET_DIR={}", self.target_dir.display()));
        make.arg(format!("WITHOUT={}", self.without.join(" ")));
        if let Some(target) = &self.target {
            make.arg(format!("TARGET={target}"));
        }
        make
    }
}

/// The parts that a build can leave out: the default features of Cargo.toml, but for the model.
pub fn optional_parts() -> Result<Vec<String>> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).context("Cargo.toml")?;
    let features = manifest
        .lines()
        .find_map(|line| line.strip_prefix("default = [")?.strip_suffix(']'))
        .context("no line of default features in Cargo.toml")?;
    let names = features
        .split(',')
        .map(|name| name.trim().trim_matches('"'));
    Ok(names
        .filter(|name| *name != "default-model")
        .map(String::from)
        .collect())
}
