//! Clips with truth: which CSV belongs to which truth.

use std::path::PathBuf;

use anyhow::{Result, bail};

use crate::cli::ClipsArgs;

/// Each clip's truth and table.
pub fn clips_of(args: &ClipsArgs) -> Result<impl Iterator<Item = (&PathBuf, &PathBuf)>> {
    if args.truth.len() != args.csv.len() {
        bail!(
            "{} --truth files but {} --csv files: give one CSV per truth",
            args.truth.len(),
            args.csv.len()
        );
    }
    Ok(args.truth.iter().zip(&args.csv))
}
