//! Clips with truth: which CSV belongs to which truth.

use std::path::PathBuf;

use anyhow::{Result, bail};

/// Truth and tables of tracked clips.
#[derive(clap::Args)]
pub struct ClipsArgs {
    /// Per-frame truth; repeat for several clips
    #[arg(long, value_name = "FILE", required = true)]
    pub truth: Vec<PathBuf>,
    /// What `posewise track --csv` wrote for the clip; as many as there are truths, in their order
    #[arg(long, value_name = "FILE", required = true)]
    pub csv: Vec<PathBuf>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

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
