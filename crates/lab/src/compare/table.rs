//! `posewise-lab compare`: methods side by side on clips with truth. `posewise-lab merge`: the same
//! from results that are there.

use super::comparison::{Comparison, Selection};
use super::measures::Row;
use crate::shard::Shard;
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
    /// Track only a share of all methods and clips, the i-th of n, and print no table:
    /// `posewise-lab merge` does.
    #[arg(long, value_name = "I/N", requires = "results")]
    pub shard: Option<Shard>,
    #[command(flatten)]
    pub output: Output,
}

/// Settings of `posewise-lab merge`. The selection is that of `compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct MergeArgs {
    #[command(flatten)]
    pub selection: Selection,
    /// The folder in which the shards kept their results.
    #[arg(long)]
    pub results: PathBuf,
    #[command(flatten)]
    pub output: Output,
}

/// How the table is printed.
#[derive(Clone, Debug, clap::Args)]
pub struct Output {
    /// A row per clip too.
    #[arg(long)]
    pub each: bool,
    /// Write the table as JSON, with all digits.
    #[arg(long)]
    pub json: Option<PathBuf>,
}

/// Prints the table, or tracks a shard.
pub fn run(args: &Args) -> Result<()> {
    let comparison = Comparison::new(&args.selection, args.results.as_deref())?;
    if let Some(shard) = args.shard {
        let (done, units) = comparison.run_shard(shard)?;
        println!("{units} results, {done} of them tracked now");
        return Ok(());
    }
    write(&comparison.rows(args.output.each)?, &args.output)
}

/// Prints the table of what is there.
pub fn run_merge(args: &MergeArgs) -> Result<()> {
    let comparison = Comparison::new(&args.selection, Some(&args.results))?;
    comparison.require_all()?;
    write(&comparison.rows(args.output.each)?, &args.output)
}

fn write(rows: &[Row], output: &Output) -> Result<()> {
    println!("{}", Row::head());
    for row in rows {
        println!("{}", row.markdown());
    }
    if let Some(path) = &output.json {
        let text = serde_json::to_string_pretty(rows)?;
        std::fs::write(path, text + "\n").with_context(|| path.display().to_string())?;
    }
    Ok(())
}
