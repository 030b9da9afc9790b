//! `posewise-lab eval drift`: do the angles get worse over many minutes?
//!
//! The clip is shown forwards, backwards, forwards … for so long, in real time by its timestamps.
//! What the tracker learns of the person and of the place goes on being learnt all the while; an
//! error that fed on itself would show as a last minute that is worse than the first.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use posewise_cli::cli::TrackerArgs;
use posewise_cli::model_file::ModelFile;
use serde_json::json;

use super::show::Show;
use crate::eval::clips::pose_metrics::{FrameOutcome, Summary, summarize};
use crate::footage::clip::{Clip, back_and_forth};
use crate::table::Table;
use crate::tracked::Frame;
use crate::truth::Truth;
use crate::{output, truth};

/// Options of `posewise-lab eval drift`.
#[derive(clap::Args)]
pub struct Args {
    /// The clip (any INPUT of `track`)
    #[arg(long, value_name = "FILE")]
    pub clip: String,
    /// Its per-frame truth, as for `eval pose`; its column fx is the default of --focal
    #[arg(long, value_name = "FILE")]
    pub truth: PathBuf,
    /// How long the clip is shown back and forth
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub minutes: f64,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Most frames of the clip that are kept in memory.
const MAX_FRAMES: usize = 3000;
/// Frames per second of a folder of pictures.
const FPS: f64 = 30.0;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if !(args.minutes > 0.0 && args.minutes <= 1e4) {
        bail!("--minutes must be positive");
    }
    let table = Table::read(&args.truth)?;
    let clip = Clip::open(&args.clip, FPS, MAX_FRAMES)?;
    let truth = truth_of(&table, &args.truth, clip.frames.len())?;
    let settings = TrackerArgs {
        focal: (args.tracker.focal).or(table.focal().filter(|_| args.tracker.fov.is_none())),
        ..args.tracker.clone()
    };
    let file = ModelFile::read(settings.model.as_deref())?;
    let model = file.model()?;
    let mut show = Show::new(&model, &settings, false, clip.fps)?;
    let steps = ((args.minutes * 60.0 * clip.fps).round() as usize).max(1);
    let mut outcomes = Vec::with_capacity(steps);
    for i in 0..steps {
        let at = back_and_forth(i, clip.frames.len());
        let result = show.frame(&clip.frames[at])?;
        outcomes.push(FrameOutcome::new(&truth[at], &Frame::of(result, 0.0)));
    }
    let (first, last) = ends(&outcomes, (60.0 * clip.fps).round() as usize);
    let (first, last) = (summarize(first.iter()), summarize(last.iter()));
    let all = summarize(outcomes.iter());
    let ratio = first.e_m_deg.zip(last.e_m_deg);
    let ratio = ratio.map(|(first, last)| last / first.max(1e-9));
    let figures = json!({"minutes": args.minutes, "frames": all.frames, "lost": lost(&all),
        "e_m_deg_first": first.e_m_deg, "e_m_deg_last": last.e_m_deg, "last_over_first": ratio,
        "all": all, "first": first, "last": last});
    output::show(&figures, args.json.as_deref())
}

/// The truth of each frame of the clip.
fn truth_of(table: &Table, path: &Path, frames: usize) -> Result<Vec<Truth>> {
    let truth = truth::whole(table)?.into_iter();
    let mut truth: HashMap<usize, Truth> = truth.map(|t| (t.frame, t)).collect();
    (0..frames)
        .map(|at| {
            let of_frame = truth.remove(&at);
            of_frame.with_context(|| format!("{} has no row for frame {at}", path.display()))
        })
        .collect()
}

/// The first and the last minute; the halves of what is shorter than two.
fn ends<T>(all: &[T], minute: usize) -> (&[T], &[T]) {
    let len = minute.min(all.len().div_ceil(2));
    (&all[..len], &all[all.len() - len..])
}

fn lost(summary: &Summary) -> usize {
    summary.counted - summary.tracked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_minute() {
        let all: Vec<usize> = (0..10).collect();
        assert_eq!(ends(&all, 2), (&all[..2], &all[8..]));
        assert_eq!(ends(&all, 9), (&all[..5], &all[5..]));
        assert_eq!(ends(&all[..1], 9), (&all[..1], &all[..1]));
    }
}
