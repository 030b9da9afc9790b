//! `posewise-lab report`: the comparison as one HTML page, and its figures as JSON and CSV.
//!
//! ```text
//! compare ─► calibration ─► figures ─► page
//! compare ─► pictures ─► page
//! ```
//!
//! The page holds everything that it shows: figures and pictures as data, `page.css`, `charts.js`
//! and `page.js`, which draws. Its content security policy forbids any request.

mod calibration;
mod figures;
mod page;
mod pictures;

use crate::compare::{Comparison, Selection};
use anyhow::{Context, Result, ensure};
use figures::Figures;
use pictures::Pictures;
use std::path::{Path, PathBuf};

/// Settings of `posewise-lab report`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub selection: Selection,
    /// Folder with the results of `compare`; what is missing in it is tracked.
    #[arg(long)]
    pub results: Option<PathBuf>,
    /// The page. The figures go beside it, with the endings .json and .csv.
    #[arg(long)]
    pub out: PathBuf,
    /// Clip of the scrubber, by its name below the folder that all clips are in; the first without
    /// it.
    #[arg(long)]
    pub scrub: Option<String>,
    /// Worst frames that are shown of each method, one of a clip.
    #[arg(long, default_value_t = 4)]
    pub worst: usize,
    /// Show pictures of clips of which no description says that they are rendered.
    #[arg(long)]
    pub show_people: bool,
}

/// Writes the page and its figures.
pub fn run(args: &Args) -> Result<()> {
    let is_html = args.out.extension().is_some_and(|ending| ending == "html");
    ensure!(is_html, "{}: not a name with .html", args.out.display());
    let comparison = Comparison::new(&args.selection, args.results.as_deref())?;
    let scrub = match &args.scrub {
        Some(name) => {
            let found = comparison.clips.iter().position(|clip| clip.name == *name);
            found.with_context(|| format!("no clip {name}"))?
        }
        None => 0,
    };
    let figures = Figures::of(&comparison, args.worst, scrub)?;
    let pictures = Pictures::of(&comparison, &figures, args.show_people)?;
    let json = serde_json::to_string_pretty(&figures)? + "\n";
    write(&args.out.with_extension("json"), &json)?;
    write(&args.out.with_extension("csv"), &figures.csv()?)?;
    let page = page::text(&figures, &pictures)?;
    write(&args.out, &page)?;
    println!("{}: {} KB", args.out.display(), page.len() / 1000);
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).with_context(|| path.display().to_string())
}
