//! Which local features a linear cascade should see: one table, all else equal; beside it the
//! networks of models, and the settings that the thesis' author published.

mod canvas;
pub mod cascade;
mod crop;
mod descent;
mod filters;
pub mod local;
mod rbm;
pub mod regression;
mod stored;
mod yardstick;

use anyhow::Result;
use cascade::{Cascade, Training, starts_on};
use descent::{Descent, stretched};
use local::Kind;
use posewise::align::{Shape, Workspace};
use posewise::image::Frame;
use posewise_cli::model_file::ModelFile;
use posewise_metrics::BoxJitter;
use posewise_metrics::landmarks::INNER;
use posewise_train::align::evaluate::{Accuracy, evaluate, nme};
use posewise_train::align::{Boxes, StartShapes, mean_shape};
use posewise_train::faces::{self, Face};
use posewise_train::photographs::{DEV, MANUAL, MANUAL_MORE};
use rayon::prelude::*;
use regression::Links;
use std::path::{Path, PathBuf};
use yardstick::Yardstick;

/// Settings of `posewise-lab features`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Photographs to train on and to measure on.
    #[arg(long, default_value = "300w")]
    pub labels: Labels,
    /// Models whose networks are measured too, as often as wanted.
    #[arg(long, value_name = "FILE")]
    pub model: Vec<PathBuf>,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Starts on each photograph and on each mirrored one.
    #[arg(long, default_value_t = 2)]
    pub starts: usize,
}

/// Who set the labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Labels {
    /// People, in the convention of 300-W: HELEN, AFW, train set of LFPW
    #[value(name = "300w")]
    Ibug,
    /// An automatic annotator: video frames
    Faces68,
}

impl Labels {
    /// Faces to train on, and others to measure on.
    fn read(self, data: &Path) -> Result<[Vec<Face>; 2]> {
        match self {
            Labels::Ibug => {
                let mut train = faces::of_set(&MANUAL, data)?;
                train.extend(faces::of_set(&MANUAL_MORE, data)?);
                Ok([train, faces::of_set(&DEV, data)?])
            }
            Labels::Faces68 => {
                let folder = data.join("faces68");
                let part = |name: &str| {
                    faces::photographs(&folder.join(format!("{name}.csv")), &folder.join(name))
                };
                Ok([part("train")?, part("dev")?])
            }
        }
    }
}

/// Trains the cascades and prints their errors on the photographs that are measured on.
pub fn run(args: &Args) -> Result<()> {
    let [train, dev] = args.labels.read(&args.data)?;
    let train = with_mirrors(train);
    let shipped = ModelFile::read(None)?;
    let dev = Yardstick::new(dev, shipped.model()?.detector());
    let (found, all) = (dev.found(), dev.faces.len());
    println!(
        "The detector of the {} finds {found} of {all} faces.\n",
        shipped.name()
    );
    println!("| features | samples | starts | NME68 mean | median | NME51 mean | failures % |");
    println!("|---|---|---|---|---|---|---|");
    let kinds = [("gradient histograms", Kind::Hog), ("RBM", Kind::Rbm)];
    let mut best = (f32::MAX, kinds[0]);
    for (name, kind) in kinds {
        let error = print_cascade(args, name, &train, (kind, Links::Global), &dev);
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
        print_cascade(args, &name, &train, (kind, late), &dev);
    }
    if args.labels == Labels::Ibug {
        print_published(args, &dev)?;
    }
    let files = args.model.iter().map(|path| ModelFile::read(Some(path)));
    for file in [Ok(shipped)].into_iter().chain(files) {
        print_network(&file?, &dev)?;
    }
    Ok(())
}

/// The faces and their mirror images.
fn with_mirrors(mut faces: Vec<Face>) -> Vec<Face> {
    let mirrors: Vec<Face> = faces.par_iter().map(Face::mirrored).collect();
    faces.extend(mirrors);
    faces
}

/// Boxes around a face, as far off as the detector's.
fn boxes(count: usize) -> Boxes {
    Boxes {
        jitter: BoxJitter::DETECTOR,
        count,
    }
}

/// One start shape for all views.
fn only(shape: &Shape) -> StartShapes {
    StartShapes {
        shapes: vec![*shape],
        turns: vec![0.0],
    }
}

fn print(name: &str, samples: &str, starts: &str, found: &Accuracy) {
    println!(
        "| {name} | {samples} | {starts} | {:.2} | {:.2} | {:.2} | {:.2} |",
        found.nme68,
        found.nme68_median,
        found.nme51,
        100.0 * found.failure
    );
}

/// Trains a cascade of such features, whose last two stages read such landmarks; returns its mean
/// NME of 68 landmarks from boxes \[%\].
fn print_cascade(
    args: &Args,
    name: &str,
    faces: &[Face],
    (kind, late): (Kind, Links),
    dev: &Yardstick,
) -> f32 {
    let starts = StartShapes::fit(faces, &mean_shape(faces), &[0.0, 0.4, 0.8]);
    let training = Training::new(faces, &starts, &boxes(args.starts), args.seed ^ 0x1ab);
    let samples = training.samples().to_string();
    let cascade = Cascade::train(training, kind, late);
    let found = cascade.evaluate(&dev.faces, &starts, &boxes(3));
    print(name, &samples, "boxes", &found);
    let run = |frame: &Frame<'_>, shape, _: &mut Workspace| cascade.run(frame, shape);
    let detected = dev.detected_errors(&starts.views(), run);
    print(name, &samples, "detector", &detected);
    found.nme68
}

/// What the author published, trained on the train set of LFPW as his is; then from boxes.
fn print_published(args: &Args, dev: &Yardstick) -> Result<()> {
    let faces = with_mirrors(faces::of_set(&MANUAL_MORE, &args.data)?);
    let mean = mean_shape(&faces);
    let labelled = faces.iter().map(|f| (f, stretched(&mean, &f.landmarks)));
    print_descent(
        "the author's settings",
        &labelled.collect::<Vec<_>>(),
        &mean,
        dev,
    );
    let starts = only(&mean);
    let drawn = |(index, face)| {
        let shapes = starts_on(face, &starts, &boxes(1), args.seed, index);
        shapes.into_iter().map(move |shape| (face, shape))
    };
    let jittered: Vec<_> = faces.iter().enumerate().flat_map(drawn).collect();
    print_descent("the same, trained from boxes", &jittered, &mean, dev);
    Ok(())
}

/// Trains a descent on faces with a start each; it is measured from the mean shape.
fn print_descent(name: &str, samples: &[(&Face, Shape)], mean: &Shape, dev: &Yardstick) {
    let descent = Descent::train(samples);
    let count = samples.len().to_string();
    let from = |start: &(dyn Fn(usize, &Face) -> Vec<Shape> + Sync)| {
        let rows = (dev.faces.par_iter().enumerate()).flat_map_iter(|(index, face)| {
            let run = |start: Shape| {
                let shape = descent.run(&face.picture.frame(), &start);
                (shape, nme(face, &shape, 0), nme(face, &shape, INNER))
            };
            start(index, face).into_iter().map(run).collect::<Vec<_>>()
        });
        Accuracy::of(&rows.collect::<Vec<_>>())
    };
    let labelled = from(&|_, face| vec![stretched(mean, &face.landmarks)]);
    print(name, &count, "labelled boxes", &labelled);
    let starts = only(mean);
    let jittered = from(&|index, face| starts_on(face, &starts, &boxes(3), 7, index));
    print(name, &count, "boxes", &jittered);
    let run = |frame: &Frame<'_>, shape, _: &mut Workspace| Some(descent.run(frame, &shape));
    print(
        name,
        &count,
        "detector",
        &dev.detected_errors(&starts.views(), run),
    );
}

/// Measures the network of a model, without a tracker.
fn print_network(file: &ModelFile, dev: &Yardstick) -> Result<()> {
    let model = file.model()?;
    let (align, name) = (model.align(), format!("network of the {}", file.name()));
    let found = Accuracy::of(&evaluate(align, &dev.faces, &boxes(3), 0));
    print(&name, "", "boxes", &found);
    let run = |frame: &Frame<'_>, mut shape, work: &mut Workspace| {
        align
            .run(frame, align.iterations(), &mut shape, work)
            .then_some(shape)
    };
    print(
        &name,
        "",
        "detector",
        &dev.detected_errors(&align.views(), run),
    );
    Ok(())
}
