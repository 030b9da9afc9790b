//! `posewise-lab protocol`: the measures that papers print, on public data sets in their own
//! layouts. None of the sets is part of this repository; docs/dev/lab.md describes the layouts.

mod boston;
mod convention;
mod ibug;
mod pointing;
mod predictions;
mod profiles;
mod pts;
mod report;
mod subsets;
mod talking_face;
mod text;

use crate::compare::{Method, Settings, Trackers};
use anyhow::{Context, Result};
use predictions::Predictions;
use std::path::{Path, PathBuf};

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
    /// Pointing'04: heads turned by labelled yaw and pitch, as sweeps.
    Pointing04,
    /// CFP: frontal faces and profiles of which one half is marked.
    Cfp,
}

/// Settings of `posewise-lab protocol`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The layout.
    pub protocol: Protocol,
    /// The folder with the data set.
    #[arg(long)]
    pub data: PathBuf,
    /// Folder with a table per clip or picture, as `posewise track --csv` writes it; trackers run
    /// without it.
    #[arg(long)]
    pub csv: Option<PathBuf>,
    /// Trackers that run.
    #[arg(long, value_delimiter = ',', default_value = "posewise")]
    pub methods: Vec<Method>,
    /// Write the curves (CED, robustness) as CSV.
    #[arg(long)]
    pub curves: Option<PathBuf>,
    /// Points of the Talking Face labels.
    #[arg(long, default_value = "xm2vts")]
    pub markup: talking_face::Markup,
    #[command(flatten)]
    pub settings: Settings,
}

/// Prints the measures.
pub fn run(args: &Args) -> Result<()> {
    let trackers = Trackers::new(&args.settings, &args.methods)?;
    let focal = args.settings.product.focal;
    let systems = match &args.csv {
        Some(folder) => vec![Predictions::Tables(folder.clone())],
        None => {
            let of = |method: &Method| Predictions::Tracker(&trackers, *method, focal);
            args.methods.iter().map(of).collect()
        }
    };
    let report = report(args.protocol, &args.data, args.markup, &systems)?;
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

/// One table of all systems where the layout has that, else one report each.
fn report(
    protocol: Protocol,
    data: &Path,
    markup: talking_face::Markup,
    systems: &[Predictions<'_>],
) -> Result<report::Report> {
    let mut all = report::Report::default();
    for system in systems {
        let one = match protocol {
            Protocol::Buft => boston::run(data, system),
            Protocol::Ibug => ibug::run(data, system),
            Protocol::TalkingFace => talking_face::run(data, system, markup),
            Protocol::Subsets => subsets::run(data, system),
            Protocol::Pointing04 => return pointing::run(data, systems),
            Protocol::Cfp => return profiles::run(data, systems),
        }?;
        all.add(system.name(), systems.len() > 1, one);
    }
    Ok(all)
}

#[cfg(test)]
mod tests;
