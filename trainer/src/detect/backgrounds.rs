//! Photographs without people.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::grey::Grey;

/// Each fifth picture is kept from training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Train,
    HeldOut,
}

/// The usable backgrounds of a part, in the order of their names.
///
/// # Errors
/// When a file cannot be read.
pub fn load(data: &Path, part: Part) -> Result<Vec<Grey>> {
    let folder = data.join("backgrounds");
    let listed = std::fs::read_to_string(folder.join("with-people.txt"))
        .context("backgrounds/with-people.txt")?;
    let people: HashSet<&str> = listed.lines().map(str::trim).collect();
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "jpg"))
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            !people.contains(name.as_ref())
        })
        .collect();
    paths.sort();
    paths
        .par_iter()
        .enumerate()
        .filter(|(i, _)| (i % 5 == 4) == (part == Part::HeldOut))
        .map(|(_, path)| Grey::open(path))
        .collect()
}
