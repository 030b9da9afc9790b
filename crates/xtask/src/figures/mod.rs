//! The figures of the models: how they are measured, and the pages that show them.
//!
//! [`measure`] runs the programs on the evaluation data and writes `docs/figures/MODEL.json`.
//! [`pages`] writes `docs/accuracy.md` and a table in `README.md` from these files alone, so that a
//! test can compare what is committed.

pub mod measure;
pub mod pages;
mod programs;
mod tables;
mod value;

use std::path::PathBuf;

use crate::root;

/// The models that ship, by the names of their files.
const MODELS: [&str; 2] = ["posewise", "research"];

/// Where the figures of a model are committed.
fn figures_of(model: &str) -> PathBuf {
    root().join(format!("docs/figures/{model}.json"))
}
