//! What adaptive local models (thesis 3.4) would add to the verifier: means and variances of a
//! person's own features, per landmark and view, updated on line from trusted frames.
//!
//! The cascade follows rendered clips with exact truth. To each landmark's logit of being seen a
//! share of its distance from the person's own model is added, and the areas under the ROC are
//! printed for several shares and rates; share 0 is the verifier alone.

use crate::video::Video;
use anyhow::{Context, Result};
use posewise::align::{Shape, Workspace};
use posewise::shape::LANDMARKS;
use posewise::track::Model;
use posewise_format::AlignedBytes;
use posewise_metrics::auc;
use std::path::{Path, PathBuf};

/// Settings of `posewise-lab adaptive`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Folder of clips, `NAME.mp4` each with its truth `NAME.csv`.
    #[arg(long, default_value = "../shared/data/clips-rendered")]
    pub clips: PathBuf,
    /// The model.
    #[arg(long, default_value = "models/default.posewise")]
    pub model: PathBuf,
}

/// How fast means and variances follow.
const RATES: [f32; 3] = [0.02, 0.05, 0.1];
/// Shares of the distance in the logit.
const SHARES: [f32; 5] = [0.0, 0.5, 1.0, 2.0, 4.0];
/// Only frames at least this sure teach, and of them only landmarks that are seen at least so
/// surely.
const TRUST: f32 = 0.9;
const SEEN: f32 = 0.7;
/// Variance that keeps the distance finite.
const FLOOR: f32 = 16.0;
/// Frames that a view's model is built from before it has a say.
const FIRST: u32 = 10;
/// Inner landmarks are counted: the jaw's truth is another point.
const INNER: usize = 17;

/// What is measured of one landmark in one frame.
struct Row {
    /// The verifier's logit that it is seen.
    logit: f32,
    /// Distance from the person's own features, 0 for an average one; for each of [`RATES`].
    distance: [f32; RATES.len()],
    seen: bool,
}

/// A person's features at one landmark in one view.
#[derive(Clone, Default)]
struct Local {
    mean: Vec<f32>,
    variance: Vec<f32>,
    frames: u32,
}

impl Local {
    fn distance(&self, features: &[i8]) -> f32 {
        if self.frames < FIRST {
            return 0.0;
        }
        let terms = features.iter().zip(&self.mean).zip(&self.variance);
        let sum: f32 = terms
            .map(|((f, m), v)| (*f as f32 - m).powi(2) / (v + FLOOR))
            .sum();
        sum / features.len() as f32 - 1.0
    }

    fn learn(&mut self, features: &[i8], rate: f32) {
        if self.frames == 0 {
            self.mean = features.iter().map(|f| *f as f32).collect();
            self.variance = vec![FLOOR; features.len()];
        }
        // The first frames count alike.
        let rate = rate.max(1.0 / (self.frames + 1) as f32);
        let models = self.mean.iter_mut().zip(&mut self.variance);
        for ((mean, variance), f) in models.zip(features) {
            let off = *f as f32 - *mean;
            *mean += rate * off;
            *variance += rate * (off * off - *variance);
        }
        self.frames += 1;
    }
}

/// Prints the areas.
pub fn run(args: &Args) -> Result<()> {
    let bytes = std::fs::read(&args.model).with_context(|| args.model.display().to_string())?;
    let bytes = AlignedBytes::new(&bytes);
    let model = Model::load(&bytes)?;
    let list = std::fs::read_dir(&args.clips);
    let list = list.with_context(|| args.clips.display().to_string())?;
    let mut truths: Vec<PathBuf> = list.map(|f| Ok(f?.path())).collect::<Result<_>>()?;
    truths.retain(|p| p.extension().is_some_and(|e| e == "csv"));
    truths.sort();
    let mut rows = Vec::new();
    for truth in &truths {
        let before = rows.len();
        follow(&model, truth, &mut rows)?;
        println!(
            "{}: {} landmarks",
            truth.display(),
            rows.len().saturating_sub(before)
        );
    }
    println!("\n| share of the distance | rate 0.02 | 0.05 | 0.1 |\n|---|---|---|---|");
    for share in SHARES {
        let of = |k: usize| {
            let score = |r: &Row| (f64::from(r.logit - share * r.distance[k]), r.seen);
            auc(&rows.iter().map(score).collect::<Vec<_>>()).unwrap_or(f64::NAN)
        };
        println!("| {share} | {:.3} | {:.3} | {:.3} |", of(0), of(1), of(2));
    }
    Ok(())
}

/// Follows one clip from truth to truth where the cascade loses it.
fn follow(model: &Model<'_>, truth: &Path, rows: &mut Vec<Row>) -> Result<()> {
    let truths = read_truth(truth)?;
    let mut video = Video::open(&truth.with_extension("mp4"))?;
    let mut work = Box::new(Workspace::new());
    let views = model.align().signed_views();
    let mut locals: [Vec<Local>; RATES.len()] =
        std::array::from_fn(|_| vec![Local::default(); views * LANDMARKS]);
    let mut shape: Option<Shape> = None;
    for truth in &truths {
        let Some(luma) = video.next()? else { break };
        let frame = luma.frame()?;
        let mut fitted = shape.unwrap_or(truth.shape);
        let ran = model.align().run(&frame, 1, &mut fitted, &mut work);
        let confidence = model.verifier().evaluate(work.features(), work.view());
        shape = (ran && confidence.face > 0.1).then_some(fitted);
        if !ran || truth.in_frame < 0.5 || confidence.face < 0.1 {
            continue;
        }
        let n = model.align().features();
        for (k, features) in work.features().chunks_exact(n).enumerate() {
            let at = work.view() * LANDMARKS + k;
            let p = confidence.visibility[k].clamp(1e-4, 1.0 - 1e-4);
            if k >= INNER {
                rows.push(Row {
                    logit: (p / (1.0 - p)).ln(),
                    distance: std::array::from_fn(|r| locals[r][at].distance(features)),
                    seen: truth.seen[k],
                });
            }
            if confidence.face >= TRUST && confidence.visibility[k] >= SEEN {
                for (models, rate) in locals.iter_mut().zip(RATES) {
                    models[at].learn(features, rate);
                }
            }
        }
    }
    Ok(())
}

struct Truth {
    shape: Shape,
    seen: [bool; LANDMARKS],
    in_frame: f32,
}

fn read_truth(path: &Path) -> Result<Vec<Truth>> {
    let mut reader = csv::Reader::from_path(path)?;
    let names = reader.headers()?.clone();
    let column = |name: String| names.iter().position(|n| n == name);
    let need = |name: String| column(name.clone()).with_context(|| format!("no column {name}"));
    let mut of = Vec::new();
    for k in 0..LANDMARKS {
        let [x, y, v] = [format!("x{k}"), format!("y{k}"), format!("v{k}")];
        of.push((need(x)?, need(y)?, need(v)?, column(format!("o{k}"))));
    }
    let in_frame = column("in_frame".into());
    reader
        .records()
        .map(|record| {
            let record = record?;
            let number = |at: usize| -> Result<f32> { Ok(record[at].parse()?) };
            let mut truth = Truth {
                shape: [[0.0; 2]; LANDMARKS],
                seen: [false; LANDMARKS],
                in_frame: in_frame.map_or(Ok(1.0), number)?,
            };
            for (k, (x, y, v, o)) in of.iter().enumerate() {
                truth.shape[k] = [number(*x)?, number(*y)?];
                truth.seen[k] = number(*v)? > 0.5 && o.map_or(Ok(0.0), number)? < 0.5;
            }
            Ok(truth)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_is_near_and_another_far() {
        let mut local = Local::default();
        let own = |i: i32| [(40 + i % 5) as i8, (10 - i % 3) as i8];
        (0..50).for_each(|i| local.learn(&own(i), 0.05));
        assert!(local.distance(&own(51)) < 0.5);
        assert!(local.distance(&[90, -50]) > 20.0);
    }
}
