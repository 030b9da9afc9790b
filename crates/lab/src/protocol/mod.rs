//! `posewise-lab protocol`: the measures that papers print, on public data sets in their own
//! layouts. None of the sets is part of this repository; docs/dev/lab.md describes the layouts.

mod boston;
mod convention;
mod ibug;
mod predictions;
mod pts;
mod report;
mod subsets;
mod talking_face;
mod text;

use crate::product;
use anyhow::{Context, Result};
use predictions::Predictions;
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
    let predictions = match &args.csv {
        Some(folder) => Predictions::Tables(folder.clone()),
        None => Predictions::Product(product::read(&args.product)?, args.product.focal),
    };
    let report = report(args, &predictions)?;
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
        Protocol::Subsets => subsets::run(data, predictions),
    }
}

#[cfg(test)]
mod tests;
