//! `posewise-lab compare`: methods side by side on clips with truth.

use super::comparison::{Comparison, Selection};
use super::measures::Row;
use anyhow::{Context, Result};
use std::path::PathBuf;

/// Settings of `posewise-lab compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub selection: Selection,
    /// Keep the results in this folder, `METHOD/CLIP.csv`; what is in it is not tracked again.
    #[arg(long)]
    pub results: Option<PathBuf>,
    /// A row per clip too.
    #[arg(long)]
    pub each: bool,
    /// Write the table as JSON, with all digits.
    #[arg(long)]
    pub json: Option<PathBuf>,
}

/// Prints the table.
pub fn run(args: &Args) -> Result<()> {
    let comparison = Comparison::new(&args.selection, args.results.as_deref())?;
    let rows = comparison.rows(args.each)?;
    println!("{}", Row::head());
    for row in &rows {
        println!("{}", row.markdown());
    }
    if let Some(path) = &args.json {
        let text = serde_json::to_string_pretty(&rows)?;
        std::fs::write(path, text + "\n").with_context(|| path.display().to_string())?;
    }
    Ok(())
}
