//! `posewise-lab compare`: methods side by side on clips with truth.

use super::follow::Frame;
use super::settings::{Method, Settings};
use super::trackers::Trackers;
use crate::truth::{self, Truth};
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use posewise_metrics::jitter::{Shape, landmark_jitter, second_difference};
use posewise_metrics::landmarks::{bounds, nme_percent};
use posewise_metrics::mean;
use posewise_metrics::pose::PoseErrors;
use std::path::{Path, PathBuf};

/// First landmark that is not on the jaw, which has two definitions.
const INNER: usize = 17;
/// Share of the landmarks in the picture from which on a frame counts.
const IN_FRAME: f64 = 0.5;
/// Mean angle error beyond which a frame is lost, whatever the tracker says \[deg\].
const LOST_DEG: f64 = 20.0;

/// Settings of `posewise-lab compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Clips, each beside its truth: `NAME.mp4` (or .y4m.gz, .y4m) and `NAME.csv`. The focal length
    /// is that of the truth.
    #[arg(required = true)]
    pub clips: Vec<PathBuf>,
    /// Trackers; all without it.
    #[arg(long, value_delimiter = ',')]
    pub methods: Vec<Method>,
    /// Print a row per clip too.
    #[arg(long)]
    pub each: bool,
    #[command(flatten)]
    pub settings: Settings,
}

/// What is measured of a method.
#[derive(Default)]
struct Sums {
    pose: PoseErrors,
    /// Mean distance of the inner landmarks in tracked frames \[% of the labels' box\].
    nme: Vec<f64>,
    /// Second differences of the landmarks' errors, over the box's size.
    jitter: Vec<Shape>,
    milliseconds: Vec<f64>,
}

impl Sums {
    fn add(&mut self, truth: &[Truth], frames: &[Frame]) {
        let mut before: Vec<Option<Shape>> = Vec::new();
        for (truth, frame) in truth.iter().zip(frames) {
            self.milliseconds.push(frame.milliseconds);
            if truth.in_frame < IN_FRAME {
                before.push(None);
                continue;
            }
            let tracked = frame.tracked.as_ref();
            self.pose.push(truth.angles, tracked.map(|t| t.angles));
            let [left, top, right, bottom] = bounds(&truth.points);
            let size = ((right - left) * (bottom - top)).sqrt().max(1.0);
            let found = tracked.map(|t| t.points);
            if let Some(found) = found {
                let pairs = truth.points.into_iter().zip(found).skip(INNER);
                self.nme.push(nme_percent(pairs, size));
            }
            before.push(found.map(|found| {
                std::array::from_fn(|i| [0, 1].map(|k| found[i][k] - truth.points[i][k]))
            }));
            if let [.., Some(a), Some(b), Some(c)] = &before[..] {
                self.jitter.push(second_difference([a, b, c], 1.0 / size));
            }
        }
    }

    fn print(&self, name: &str) {
        let cell = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.2}"));
        let axis = |i: usize| cell(self.pose.mean().map(|e| e[i]));
        let near = self
            .pose
            .per_frame()
            .iter()
            .filter(|e| **e <= LOST_DEG)
            .count();
        let kept = (!self.pose.is_empty()).then(|| near as f64 / self.pose.len() as f64);
        let cells = [
            name.into(),
            self.pose.len().to_string(),
            cell(self.pose.success().map(|s| 100.0 * s)),
            cell(kept.map(|s| 100.0 * s)),
            axis(0),
            axis(1),
            axis(2),
            cell(self.pose.mean_angle()),
            cell(mean(&self.nme)),
            cell(landmark_jitter(&self.jitter).map(|j| 100.0 * j)),
            cell(mean(&self.milliseconds)),
        ];
        println!("| {} |", cells.join(" | "));
    }
}

/// The clip's truth is beside it.
fn truth_of(clip: &Path) -> PathBuf {
    let name = clip.file_name().unwrap_or_default().to_string_lossy();
    let stem = ["y4m.gz", "y4m", "mp4", "avi"].iter().find_map(|ending| {
        let stem = name.strip_suffix(ending)?;
        stem.strip_suffix('.')
    });
    clip.with_file_name(format!("{}.csv", stem.unwrap_or(&name)))
}

/// Prints the table.
pub fn run(args: &Args) -> Result<()> {
    let methods = match args.methods.is_empty() {
        true => Method::ALL.to_vec(),
        false => args.methods.clone(),
    };
    let trackers = Trackers::new(&args.settings, &methods)?;
    println!(
        "| method | frames | P_s % | within {LOST_DEG}° % | E_yaw ° | E_pitch ° | E_roll ° | E_m ° \
         | NME % | jitter % | ms |\n|{}",
        "---|".repeat(11)
    );
    let progress = ProgressBar::new((methods.len() * args.clips.len()) as u64);
    for method in methods {
        let mut all = Sums::default();
        for clip in &args.clips {
            let truth = truth::read(&truth_of(clip))?;
            let first = truth.first().context("a truth without frames")?;
            let focal = first.focal.map(|f| f as f32);
            let frames = trackers.follow(method, clip, focal.or(args.settings.product.focal))?;
            progress.inc(1);
            all.add(&truth, &frames);
            if args.each {
                let mut one = Sums::default();
                one.add(&truth, &frames);
                let name = clip.file_name().unwrap_or_default().to_string_lossy();
                progress.suspend(|| one.print(&format!("{} {name}", method.name())));
            }
        }
        progress.suspend(|| all.print(method.name()));
    }
    progress.finish_and_clear();
    Ok(())
}
