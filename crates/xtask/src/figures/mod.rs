//! The figures of the models: how they are measured, and the pages that show them.
//!
//! [`measure`] runs the programs on the evaluation data and writes `docs/figures/MODEL.json`.
//! [`pages`] writes `docs/accuracy.md` and a table in `README.md` from these files alone, so that a
//! test can compare what is committed. [`history`] keeps some of them for each version.

pub mod history;
pub mod measure;
pub mod pages;
mod programs;
mod tables;
mod value;

use anyhow::{Context, Result};
use std::path::PathBuf;

use crate::root;

/// The models that ship, by the names of their files.
const MODELS: [&str; 2] = ["posewise", "research"];

/// Where the figures of a model are committed.
fn figures_of(model: &str) -> PathBuf {
    root().join(format!("docs/figures/{model}.json"))
}

/// The figure in the row of a page's table that starts so.
pub fn documented(page: &str, row: &str) -> Result<f64> {
    let text = std::fs::read_to_string(root().join(page)).with_context(|| page.to_owned())?;
    let start = format!("| {row} | ");
    let line = text.lines().find_map(|line| line.strip_prefix(&start));
    let figure = line.and_then(|rest| rest.split(' ').next());
    let figure = figure.with_context(|| format!("{page}: no row '{row}'"))?;
    Ok(figure.replace(',', "").parse()?)
}
