//! What pose-wise SVM templates on hand-made descriptors can do (thesis 4.4), measured against the
//! shipped classifiers on learned features and as a correction of the cascade's landmarks.
//!
//! Linear SVM templates per landmark and view on three descriptors ([`descriptor`]), trained on
//! photographs and renders with hard negatives, calibrated after Platt and multiplied into one
//! response map per landmark; a regularised mean-shift moves the shape ([`correct`]).

pub mod correct;
pub mod descriptor;
pub mod svm;

use anyhow::{Context, Result};
use correct::{Correction, ShapeModes};
use descriptor::{Patches, Placement};
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::shape::LANDMARKS;
use posewise::track::Model;
use posewise_format::AlignedBytes;
use posewise_metrics::{BoxJitter, auc};
use posewise_train::align::evaluate::{nme, start_of};
use posewise_train::align::{Accuracy, jittered_box, normal, start_from_box};
use posewise_train::detect::backgrounds;
use posewise_train::faces::{self, Face, Picture};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::PathBuf;
use svm::Bank;

/// Settings of `posewise-lab templates`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Renders to train on beside the photographs.
    #[arg(long)]
    pub renders: PathBuf,
    /// Renders that the model was not trained on, to measure on what is seen and hidden.
    #[arg(long)]
    pub fresh: PathBuf,
    /// The model whose cascade and classifiers they are measured against.
    #[arg(long, default_value = "models/default.posewise")]
    pub model: PathBuf,
}

/// Renders of each kind that are used.
const RENDERS: usize = 6000;
/// One fit of the cascade, and the confidences of both kinds of classifiers.
struct Fit {
    shape: Shape,
    /// By the model's classifiers.
    learned: Confidences,
    /// By the templates.
    templates: Confidences,
}

/// Confidences of a fit.
struct Confidences {
    face: f32,
    landmarks: [f32; LANDMARKS],
    seen: [f32; LANDMARKS],
}

/// Trains the templates and prints what they do.
pub fn run(args: &Args) -> Result<()> {
    let bytes = std::fs::read(&args.model).with_context(|| args.model.display().to_string())?;
    let bytes = AlignedBytes::new(&bytes);
    let model = Model::load(&bytes)?;
    let labels = args.data.join("faces68");
    let mut train = faces::photographs(&labels.join("train.csv"), &labels.join("train"))?;
    let modes = ShapeModes::fit(model.align().mean(), &train);
    train.extend(faces::rendered(&args.renders, RENDERS)?);
    println!("templates: {} faces to train on", train.len());
    let bank = Bank::train(model.align(), &train);
    let dev = faces::photographs(&labels.join("dev.csv"), &labels.join("dev"))?;

    let fits = fits(&model, &bank, &dev, 1.0, 11);
    print_corrections(&model, &bank, &modes, &dev, &fits);
    print_confidences(args, &model, &bank, &dev, &fits)
}

/// Prints the errors of shapes that the templates corrected.
fn print_corrections(
    model: &Model<'_>,
    bank: &Bank,
    modes: &ShapeModes,
    dev: &[Face],
    fits: &[Fit],
) {
    println!("\n| correction | strength | NME68 | median | NME51 | failures % |");
    println!("|---|---|---|---|---|---|");
    let row = |name: &str, strength: &str, shapes: &[Shape]| {
        let rows: Vec<(Shape, f32, f32)> = (dev.iter().zip(shapes))
            .map(|(face, s)| (*s, nme(face, s, 0), nme(face, s, 17)))
            .collect();
        let a = Accuracy::of(&rows);
        let failure = 100.0 * a.failure;
        println!(
            "| {name} | {strength} | {:.2} | {:.2} | {:.2} | {failure:.2} |",
            a.nme68, a.nme68_median, a.nme51
        );
    };
    let before: Vec<Shape> = fits.iter().map(|f| f.shape).collect();
    row("none: the cascade alone", "-", &before);
    for (name, correction) in Correction::all() {
        for strength in [0.25f32, 0.5, 1.0] {
            let after: Vec<Shape> = dev
                .par_iter()
                .zip(&before)
                .map(|(face, shape)| {
                    let mut shape = *shape;
                    let context = (model.align(), bank, modes);
                    correction.apply(context, &face.picture, &mut shape, strength);
                    shape
                })
                .collect();
            row(name, &format!("{strength}"), &after);
        }
    }
}

/// Prints how well the confidences of both separate right from wrong.
fn print_confidences(
    args: &Args,
    model: &Model<'_>,
    bank: &Bank,
    dev: &[Face],
    fits: &[Fit],
) -> Result<()> {
    println!("\n| area under the ROC | classifiers on learned features | templates |");
    println!("|---|---|---|");
    let far = self::fits(model, bank, dev, 3.5, 12);
    let both = || fits.iter().chain(&far).zip(dev.iter().chain(dev));
    let right = |pick: fn(&Fit) -> &Confidences| {
        let all = both().flat_map(|(fit, face)| {
            let limit = 0.1 * face.scale();
            (0..LANDMARKS).map(move |k| {
                let (p, q) = (fit.shape[k], face.landmarks[k]);
                let near = (p[0] - q[0]).hypot(p[1] - q[1]) <= limit;
                (pick(fit).landmarks[k], near)
            })
        });
        area(all)
    };
    let (learned, templates) = (right(|f| &f.learned), right(|f| &f.templates));
    println!("| landmark right or wrong (dev) | {learned:.3} | {templates:.3} |");
    let fresh = faces::rendered(&args.fresh, RENDERS)?;
    let seen_fits = self::fits(model, bank, &fresh, 1.0, 13);
    let seen = |pick: fn(&Fit) -> &Confidences| {
        let kept = seen_fits.iter().zip(&fresh);
        let kept = kept.filter(|(fit, face)| nme(face, &fit.shape, 0) < 10.0);
        let all = kept.flat_map(|(fit, face)| {
            (17..LANDMARKS).map(move |k| (pick(fit).seen[k], face.visible[k]))
        });
        area(all)
    };
    let (learned, templates) = (seen(|f| &f.learned), seen(|f| &f.templates));
    println!("| landmark seen or hidden (fresh renders) | {learned:.3} | {templates:.3} |");
    let empty = backgrounds::held_out(&args.data)?;
    let nobody = on_empty(model, bank, &empty, 4 * dev.len());
    let face = |pick: fn(&Fit) -> &Confidences| {
        let faces = fits.iter().map(|f| (pick(f).face, true));
        area(faces.chain(nobody.iter().map(|f| (pick(f).face, false))))
    };
    let (learned, templates) = (face(|f| &f.learned), face(|f| &f.templates));
    println!("| face or background (dev, held-out pictures) | {learned:.4} | {templates:.4} |");
    Ok(())
}

/// Area under the ROC; NaN when there is only one kind.
fn area(pairs: impl Iterator<Item = (f32, bool)>) -> f64 {
    let pairs: Vec<_> = pairs.map(|(v, truth)| (f64::from(v), truth)).collect();
    auc(&pairs).unwrap_or(f64::NAN)
}

/// Runs the cascade on every face from a box as far off as a detector's, times `off`.
fn fits(model: &Model<'_>, bank: &Bank, faces: &[Face], off: f32, seed: u64) -> Vec<Fit> {
    let jitter = BoxJitter::DETECTOR.times(off);
    let run = |work: &mut Box<Workspace>, (index, face): (usize, &Face)| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index as u64);
        let views = model.align().views();
        let (at, size, roll) = jittered_box(&views, &face.landmarks, &jitter, &mut rng);
        let start = start_of(model.align(), face.turn());
        let shape = start_from_box(&start, at, size, roll);
        fit(model, bank, &face.picture, shape, work)
    };
    let with_work = || Box::new(Workspace::new());
    let faces = faces.par_iter().enumerate();
    faces.map_init(with_work, run).collect()
}

/// The same from random boxes where there is no face.
fn on_empty(model: &Model<'_>, bank: &Bank, empty: &[Picture], count: usize) -> Vec<Fit> {
    let run = |work: &mut Box<Workspace>, index: usize| {
        let mut rng = ChaCha8Rng::seed_from_u64(14);
        rng.set_stream(index as u64);
        let picture = &empty[index % empty.len()];
        let [w, h] = picture.size.map(|s| s as f32);
        let size = rng.random_range(40.0..0.9 * w.min(h));
        let at = [rng.random_range(0.0..w), rng.random_range(0.0..h)];
        let start = start_of(model.align(), rng.random_range(-1.0..1.0));
        let shape = start_from_box(&start, at, size, 0.3 * normal(&mut rng));
        fit(model, bank, picture, shape, work)
    };
    let with_work = || Box::new(Workspace::new());
    let all = (0..count).into_par_iter();
    all.map_init(with_work, run).collect()
}

fn fit(
    model: &Model<'_>,
    bank: &Bank,
    picture: &Picture,
    mut shape: Shape,
    work: &mut Workspace,
) -> Fit {
    let align = model.align();
    align.run(&picture.frame(), align.iterations(), &mut shape, work);
    let confidence = model.verifier().evaluate(work.features(), work.view());
    // Templates know how well a place looks, and that is all they know of what is seen.
    let landmarks = responses(align, bank, picture, &shape);
    let face = landmarks.iter().map(|p| p.max(1e-6).ln()).sum();
    Fit {
        shape,
        learned: Confidences {
            face: confidence.face,
            landmarks: confidence.landmarks,
            seen: confidence.visibility,
        },
        templates: Confidences {
            face,
            landmarks,
            seen: landmarks,
        },
    }
}

/// The templates' combined response where the landmarks are.
fn responses(
    align: &AlignModel<'_>,
    bank: &Bank,
    picture: &Picture,
    shape: &Shape,
) -> [f32; LANDMARKS] {
    let Some(placement) = Placement::of(align, shape) else {
        return [0.0; LANDMARKS];
    };
    let patches = Patches::cut(picture, &placement);
    let points = placement.points(shape);
    let mut out = [0.0; LANDMARKS];
    for (k, p) in points.iter().enumerate() {
        out[placement.landmark(k)] = bank.response(placement.view, k, &patches, *p);
    }
    out
}
