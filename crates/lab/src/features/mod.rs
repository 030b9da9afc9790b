//! Which local features a linear cascade should see: one table, all else equal.

pub mod cascade;
mod crop;
mod filters;
pub mod local;
mod rbm;
pub mod regression;
mod stored;

use anyhow::Result;
use cascade::{Cascade, Training};
use local::Kind;
use posewise_metrics::BoxJitter;
use posewise_train::align::{Boxes, StartShapes, mean_shape};
use posewise_train::faces::{self, Face};
use rayon::prelude::*;
use regression::Links;
use std::path::PathBuf;

/// Settings of `posewise-lab features`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Starts on each photograph and on each mirrored one.
    #[arg(long, default_value_t = 2)]
    pub starts: usize,
}

/// Trains the cascades and prints their errors on the dev photographs.
pub fn run(args: &Args) -> Result<()> {
    let labels = args.data.join("faces68");
    let dev = faces::photographs(&labels.join("dev.csv"), &labels.join("dev"))?;
    let photographs = faces::photographs(&labels.join("train.csv"), &labels.join("train"))?;
    let photographs = with_mirrors(photographs);
    println!("| features | samples | NME68 mean | median | NME51 mean | failures % |");
    println!("|---|---|---|---|---|---|");
    let kinds = [("gradient histograms", Kind::Hog), ("RBM", Kind::Rbm)];
    let mut best = (f32::MAX, kinds[0]);
    for (name, kind) in kinds {
        let error = print_row(args, name, &photographs, (kind, Links::Global), &dev);
        if error < best.0 {
            best = (error, (name, kind));
        }
    }
    let (name, kind) = best.1;
    let late = [
        ("own features", Links::Own),
        ("8 best landmarks", Links::Best(8)),
    ];
    for (what, late) in late {
        let name = format!("{name}; last two stages: {what}");
        print_row(args, &name, &photographs, (kind, late), &dev);
    }
    Ok(())
}

/// The faces and their mirror images.
fn with_mirrors(mut faces: Vec<Face>) -> Vec<Face> {
    let mirrors: Vec<Face> = faces.par_iter().map(Face::mirrored).collect();
    faces.extend(mirrors);
    faces
}

/// Trains a cascade of such features, whose last two stages read such landmarks; returns its mean
/// NME of 68 landmarks \[%\].
fn print_row(
    args: &Args,
    name: &str,
    faces: &[Face],
    (kind, late): (Kind, Links),
    dev: &[Face],
) -> f32 {
    let boxes = |count| Boxes {
        jitter: BoxJitter::DETECTOR,
        count,
    };
    let starts = StartShapes::fit(faces, &mean_shape(faces), &[0.0, 0.4, 0.8]);
    let training = Training::new(faces, &starts, &boxes(args.starts), args.seed ^ 0x1ab);
    let samples = training.samples();
    let cascade = Cascade::train(training, kind, late);
    let found = cascade.evaluate(dev, &starts, &boxes(3));
    println!(
        "| {name} | {samples} | {:.2} | {:.2} | {:.2} | {:.2} |",
        found.nme68,
        found.nme68_median,
        found.nme51,
        100.0 * found.failure
    );
    found.nme68
}
