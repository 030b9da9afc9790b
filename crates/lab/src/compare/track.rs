//! `posewise-lab track`: one tracker on one clip.

use super::settings::{Method, Settings};
use super::trackers::Trackers;
use crate::tracked;
use anyhow::Result;
use std::path::PathBuf;

/// Settings of `posewise-lab track`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The clip.
    pub input: PathBuf,
    /// The tracker.
    #[arg(long)]
    pub method: Method,
    /// Where the result goes, one row a frame; `posewise-lab eval pose` reads it.
    #[arg(long)]
    pub csv: PathBuf,
    #[command(flatten)]
    pub settings: Settings,
}

/// Follows one clip and writes its table.
pub fn run(args: &Args) -> Result<()> {
    let trackers = Trackers::new(&args.settings, &[args.method])?;
    let frames = trackers.follow(args.method, &args.input, args.settings.product.focal)?;
    tracked::write(&args.csv, &frames)?;
    let tracked = frames.iter().filter(|f| f.tracked.is_some()).count();
    let time: f64 = frames.iter().filter_map(|f| f.milliseconds).sum();
    println!(
        "{} frames, {tracked} tracked, {:.2} ms a frame",
        frames.len(),
        time / frames.len().max(1) as f64
    );
    Ok(())
}
