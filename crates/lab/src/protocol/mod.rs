//! `posewise-lab protocol`: the measures that papers print, on public data sets in their own
//! layouts. None of the sets is part of this repository; docs/lab.md describes the layouts.

mod aflw2000;
mod biwi;
mod boston;
mod convention;
mod ibug;
mod landmarks;
mod mat;
mod predictions;
mod pts;
mod report;
mod subsets;
mod talking_face;
mod text;
mod wflw;

use crate::product::{self, Product};
use crate::shard::Shard;
use anyhow::{Context, Result, ensure};
use predictions::{Kept, Predictions};
use std::path::PathBuf;

/// A data set's layout and measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Protocol {
    /// Boston University head tracking: pose of videos, absolute and since the first frame.
    Buft,
    /// 300-W: landmarks of pictures.
    #[value(name = "300w")]
    Ibug,
    /// Talking Face: landmarks of a video.
    TalkingFace,
    /// AFLW2000-3D: pose and landmarks of pictures.
    Aflw2000,
    /// BIWI: pose of videos.
    Biwi,
    /// WFLW: landmarks of pictures, by subset.
    Wflw,
    /// Folders of clips with truth: robustness curves, as of the thesis' U3PT.
    Subsets,
}

/// Settings of `posewise-lab protocol`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The layout.
    pub protocol: Protocol,
    /// The folder with the data set.
    #[arg(long)]
    pub data: PathBuf,
    /// Folder with a table per clip or picture, as `posewise track --csv` writes it; posewise runs
    /// without it.
    #[arg(long)]
    pub csv: Option<PathBuf>,
    /// Keep posewise's results in this folder; what is in it is not tracked again.
    #[arg(long, conflicts_with = "csv")]
    pub results: Option<PathBuf>,
    /// Track only a share of the clips or pictures, the i-th of n, and print nothing: the same
    /// command without it does.
    #[arg(long, value_name = "I/N", requires = "results")]
    pub shard: Option<Shard>,
    /// Write the curves (CED, robustness) as CSV.
    #[arg(long)]
    pub curves: Option<PathBuf>,
    /// Points of the Talking Face labels.
    #[arg(long, default_value = "xm2vts")]
    pub markup: talking_face::Markup,
    #[command(flatten)]
    pub product: product::Options,
}

/// Prints the measures.
pub fn run(args: &Args) -> Result<()> {
    let predictions = match (&args.csv, &args.results) {
        (Some(folder), _) => Predictions::Tables(folder.clone()),
        (None, Some(folder)) => {
            let is_clear = args.protocol != Protocol::Wflw;
            ensure!(
                is_clear,
                "pictures of WFLW show several faces; no --results"
            );
            let product = Product::new(&args.product)?;
            let shard = args.shard.unwrap_or(Shard::WHOLE);
            Predictions::Kept(Kept::new(product, folder, shard))
        }
        (None, None) => Predictions::Product(Product::new(&args.product)?),
    };
    let report = report(args, &predictions)?;
    if args.shard.is_some() {
        return Ok(());
    }
    print!("{}", report.text);
    if let Some(path) = &args.curves {
        let shown = || path.display().to_string();
        let mut writer = csv::Writer::from_path(path).with_context(shown)?;
        writer.write_record(["curve", "error", "share"])?;
        for (name, corners) in &report.curves {
            for (error, share) in corners {
                writer.write_record([name, &error.to_string(), &share.to_string()])?;
            }
        }
        writer.flush()?;
    }
    Ok(())
}

fn report(args: &Args, predictions: &Predictions) -> Result<report::Report> {
    let data = args.data.as_path();
    match args.protocol {
        Protocol::Buft => boston::run(data, predictions),
        Protocol::Ibug => ibug::run(data, predictions),
        Protocol::TalkingFace => talking_face::run(data, predictions, args.markup),
        Protocol::Aflw2000 => aflw2000::run(data, predictions),
        Protocol::Biwi => biwi::run(data, predictions),
        Protocol::Wflw => wflw::run(data, predictions),
        Protocol::Subsets => subsets::run(data, predictions),
    }
}

#[cfg(test)]
mod tests;
