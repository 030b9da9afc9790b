//! From the shared data to a finished model, section by section.
//!
//! Every section is kept in the cache under a name that tells its settings, so an interrupted run
//! goes on where it stopped and a change of one part does not train the others again.

use crate::align::{self, Accuracy};
use crate::detect::backgrounds;
use crate::faces::{self, Face, Picture};
use crate::fit::{FitSettings, fit_photographs_cached};
use crate::head::{Head, Wfm};
use crate::{detect, face_section, render, score};
use anyhow::{Context, Result};
use posewise::align::{AlignModel, EnsembleMember, Refiners, ShapeRegression};
use posewise::detect::DetectorModel;
use posewise_format::{AlignedBytes, Blob, Tag, crc32};
use posewise_format::{SectionWriter, blob};
use posewise_metrics::BoxJitter;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Rendered profiles that the detector learns from beside the photographs, which have none.
const PROFILES: usize = 400;
/// Renders that stand in for photographs where there are none: with more of them the thresholds
/// open.
const FRONTS: usize = 3000;
/// Share of the renders' windows given up by the detector: more of them than of photographs' are
/// dark or full of noise.
const HOPELESS_RENDERS: f32 = 0.15;

/// Settings of `posewise-train model`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for what is made once.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
    /// The model; its data sheet is written beside it, ending in `.md`.
    #[arg(long, default_value = "models/default.posewise")]
    pub out: PathBuf,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The model's 3D face: a Candide-3 wireframe (`.wfm`) in place of the morphable head, which
    /// still renders.
    #[arg(long)]
    pub wireframe: Option<PathBuf>,
    /// Rendered faces to train on.
    #[arg(long, default_value_t = 12_000)]
    pub renders: u64,
    /// Faces rendered from near, for the fine stages.
    #[arg(long, default_value_t = 9_000)]
    pub near_renders: u64,
    /// Further ones of what plain ones lack, for the second round: things worn, lids half way, odd
    /// eyes, larger turns.
    #[arg(long, default_value_t = 0)]
    pub hard_renders: u64,
    /// Batches that the network is trained on.
    #[arg(long, default_value_t = 30_000)]
    pub steps: usize,
    /// Use no photograph: procedural people before procedural backgrounds only. Give it a cache of
    /// its own.
    #[arg(long)]
    pub clean: bool,
}

/// Trains what the cache does not hold yet and writes the model and its data sheet.
pub fn run(args: &Args) -> Result<()> {
    let started = Instant::now();
    std::fs::create_dir_all(&args.cache)?;
    let head = Head::load(&args.data.join("facekit.npz"))?;
    let offsets_mm = if args.clean {
        head.conventional_offsets_mm()
    } else {
        let labels = args.data.join("faces68");
        let fits = fit_photographs_cached(
            &head,
            &labels.join("train.csv"),
            &labels.join("train"),
            &FitSettings::default(),
            &args.cache.join("fits.json"),
        )?;
        println!(
            "3D head fitted to {} photographs, {} dropped",
            fits.fits.len(),
            fits.dropped.len()
        );
        fits.offsets_mm
    };
    let face = match &args.wireframe {
        Some(path) => face_section::face_section(&Head::of_wfm(&Wfm::read(path)?)?, None)?,
        None => face_section::face_section(&head, Some(&offsets_mm))?,
    };
    let render = |kind, count| {
        render::run(&render::Args {
            data: args.data.clone(),
            cache: args.cache.clone(),
            count,
            seed: args.seed,
            clean: args.clean,
            kind,
        })
    };
    let training = Training {
        args,
        renders: render(render::Kind::Plain, args.renders)?,
        near_renders: render(render::Kind::Near, args.near_renders)?,
        hard_renders: match args.hard_renders {
            0 => None,
            count => Some(render(render::Kind::Hard, count)?),
        },
        loaded: OnceCell::new(),
        loaded_near: OnceCell::new(),
    };
    let detector = kept(args, b"DTCT", &format!("{}", args.seed), || {
        training.detector()
    })?;
    let Cascade {
        global: cascade,
        second,
        parts,
        correction,
        trained,
    } = training.cascade()?;
    let whole = [&cascade, &second, &parts, &correction].map(SectionWriter::clone);
    let alone = AlignedBytes::new(&blob(&whole));
    let opened = Blob::open(&alone)?;
    let model = AlignModel::open(
        &opened,
        EnsembleMember::open(&opened)?,
        Refiners::open(&opened)?,
    )?;
    let alone = AlignedBytes::new(&blob(std::slice::from_ref(&detector)));
    let with_detector = Blob::open(&alone)?;
    let scan = DetectorModel::open(with_detector.section(b"DTCT")?)?;
    // It goes with all of these, however they were made.
    let parents = [&cascade, &second, &parts, &correction, &detector];
    let key = format!("{:08x?}", parents.map(|s| crc32(s.bytes())));
    let verifier = kept(args, &posewise::verifier::Verifier::TAG, &key, || {
        let empty = training.empty()?;
        // Plain renders: with hard ones it gives covered faces up too soon.
        score::train(&model, &scan, training.faces()?, &empty, args.seed)
    })?;
    let dev = align::with_model(&[&cascade], |global| {
        evaluate(&model, global, trained.as_ref(), &args.data)
    })?;
    let mut info = SectionWriter::new(*b"INFO");
    let sheet = data_sheet(args, &dev);
    info.array(sheet.as_bytes());
    let bytes = blob(&[
        face, detector, cascade, second, parts, correction, verifier, info,
    ]);
    std::fs::write(&args.out, &bytes).with_context(|| format!("writing {}", args.out.display()))?;
    std::fs::write(
        args.out.with_extension("md"),
        format!("{sheet}\nSize: {} bytes.\n", bytes.len()),
    )?;
    println!(
        "{}: {} bytes, in {:.0?}",
        args.out.display(),
        bytes.len(),
        started.elapsed()
    );
    Ok(())
}

/// Sections of the cascade.
struct Cascade {
    global: SectionWriter,
    second: SectionWriter,
    parts: SectionWriter,
    correction: SectionWriter,
    /// The global stage before it was turned into integers, where its checkpoint is left.
    trained: Option<align::Trained>,
}

/// What the parts are trained on; faces are loaded when first asked for.
struct Training<'a> {
    args: &'a Args,
    renders: PathBuf,
    near_renders: PathBuf,
    hard_renders: Option<PathBuf>,
    loaded: OnceCell<Vec<Face>>,
    loaded_near: OnceCell<Vec<Face>>,
}

impl Training<'_> {
    /// Photographs with their mirrors, and renders; of a clean model renders only.
    fn faces(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded.get() {
            return Ok(faces);
        }
        let mut faces = vec![];
        if !self.args.clean {
            let labels = self.args.data.join("faces68");
            faces = faces::photographs(&labels.join("train.csv"), &labels.join("train"))?;
            let mirrors: Vec<Face> = faces.par_iter().map(Face::mirrored).collect();
            faces.extend(mirrors);
        }
        faces.extend(faces::rendered(&self.renders, self.args.renders as usize)?);
        Ok(self.loaded.get_or_init(|| faces))
    }

    fn hard(&self) -> Result<Vec<Face>> {
        match &self.hard_renders {
            Some(path) => faces::rendered(path, self.args.hard_renders as usize),
            None => Ok(Vec::new()),
        }
    }

    /// Renders from near.
    fn near(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded_near.get() {
            return Ok(faces);
        }
        let faces = faces::rendered(&self.near_renders, self.args.near_renders as usize)?;
        Ok(self.loaded_near.get_or_init(|| faces))
    }

    /// Pictures in which nobody is seen.
    fn empty(&self) -> Result<Vec<Picture>> {
        match self.args.clean {
            true => Ok(backgrounds::made_up(self.args.seed, 600)),
            false => backgrounds::load(&self.args.data),
        }
    }

    fn detector(&self) -> Result<SectionWriter> {
        let mut options = detect::Options {
            seed: self.args.seed,
            ..detect::Options::default()
        };
        let near = self.near()?;
        let mut faces;
        let told = if self.args.clean {
            options.hopeless = HOPELESS_RENDERS;
            faces = detect::faces::profiles(near, PROFILES);
            faces.extend(detect::faces::fronts(self.faces()?));
            PROFILES + FRONTS
        } else {
            faces = detect::faces::load(&self.args.data)?;
            faces.extend(detect::faces::profiles(near, PROFILES));
            faces.len()
        };
        detect::train(&faces, told, &self.empty()?, &self.args.cache, &options)
    }

    /// The cascade: global and fine stages. The global stage is trained on the labels as they are,
    /// then goes on with labels that it has bettered and faces without; without photographs, with
    /// the same renders, those from the front more often.
    fn cascade(&self) -> Result<Cascade> {
        let args = self.args;
        let mut options = align::Options {
            seed: args.seed,
            steps: args.steps,
            covered: if args.clean { 0.25 } else { 0.0 },
            ..align::Options::default()
        };
        let narrow = |key: &str| format!("{key}-{}", align::MODES);
        let mut key = format!("{options:?}-{}", args.renders);
        let mut checkpoint = self.checkpoint(&key);
        let mut global = kept(args, &AlignModel::TAG, &narrow(&key), || {
            align::cascade(self.faces()?, &options, &checkpoint, None)
        })?;
        options = align::Options {
            seed: args.seed ^ 0x5eed,
            // Faces are mostly seen from the front: what photographs tell by themselves.
            front: if args.clean { 4.0 } else { 0.0 },
            ..options.second()
        };
        key = format!("{options:?}-{key}");
        if args.hard_renders > 0 {
            key = format!("{key}-{}", args.hard_renders);
        }
        let taught = self.checkpoint(&key);
        global = kept(args, &AlignModel::TAG, &narrow(&key), || {
            let mut faces = self.bettered(&[&global])?;
            faces.extend(self.hard()?);
            align::cascade(&faces, &options, &taught, Some(&checkpoint))
        })?;
        checkpoint = taught;
        key = narrow(&key);
        let second = self.second(&global, &key)?;
        let trained = align::Trained::read(&checkpoint, &options.sizes);
        let options = align::parts::options(args.seed, args.steps);
        // No hard renders: lids half way that are hardly seen would teach the network to guess the
        // middle.
        let of_second = crc32(second.bytes());
        let key = format!("{options:?}-{key}-{}-{of_second:08x}", args.near_renders);
        let parts = kept(args, &Refiners::TAG, &key, || {
            let hash = crc32(key.as_bytes());
            let global = [&global, &second];
            let faces = [&self.bettered(&global)?, self.near()?].concat();
            let eyes = args.data.join("eyes");
            let training = align::parts::Training {
                global,
                faces: &faces,
                eyes: (!args.clean).then_some(&eyes),
                options: &options,
                cache: &args.cache,
                key: hash,
            };
            training.run()
        })?;
        let correction = kept(args, &ShapeRegression::TAG, &key, || {
            // As the annotator has them: labels that a network has bettered lack what it lacks.
            let faces = [self.faces()?, self.near()?].concat();
            align::with_model(&[&global, &second, &parts], |model| {
                align::correction::train(model, &faces)
            })
        })?;
        Ok(Cascade {
            global,
            second,
            parts,
            correction,
            trained,
        })
    }

    /// The global stage's second network, on labels that the first has bettered.
    fn second(&self, global: &SectionWriter, key: &str) -> Result<SectionWriter> {
        let options = align::Options {
            seed: self.args.seed,
            steps: self.args.steps,
            front: if self.args.clean { 4.0 } else { 0.0 },
            ..align::Options::default()
        };
        let options = options.second_network();
        let key = format!("{options:?}-{key}");
        kept(self.args, &EnsembleMember::TAG, &key, || {
            let faces = self.bettered(&[global])?;
            let checkpoint = self.checkpoint(&key);
            align::with_model(&[global], |model| {
                align::second(&faces, model.mean(), &options, &checkpoint)
            })
        })
    }

    /// Photographs with labels as a trained global stage would have them, those without labels too,
    /// and renders as they are.
    fn bettered(&self, global: &[&SectionWriter]) -> Result<Vec<Face>> {
        if self.args.clean {
            return Ok(self.faces()?.to_vec());
        }
        let mut faces = align::with_model(global, |teacher| {
            let labels = self.args.data.join("faces68");
            let photographs = faces::photographs(&labels.join("train.csv"), &labels.join("train"))?;
            let mut faces = align::relabel::blended(teacher, &photographs);
            let unlabelled = self.args.data.join("faces-unlabelled");
            let (found, dropped) = align::relabel::found(teacher, &unlabelled)?;
            println!(
                "{} faces without labels taken, {dropped} dropped",
                found.len()
            );
            faces.extend(found);
            Ok(faces)
        })?;
        faces.extend(faces::rendered(&self.renders, self.args.renders as usize)?);
        Ok(faces)
    }

    fn checkpoint(&self, key: &str) -> PathBuf {
        let hash = crc32(key.as_bytes());
        self.args
            .cache
            .join(format!("network-{hash:08x}.checkpoint"))
    }
}

/// The section of these settings from the cache, or made and put there.
fn kept(
    args: &Args,
    tag: &Tag,
    key: &str,
    make: impl FnOnce() -> Result<SectionWriter>,
) -> Result<SectionWriter> {
    let hash = crc32(key.as_bytes());
    let name = format!("{}-{hash:08x}.section", tag.escape_ascii());
    let path = args.cache.join(name);
    if let Ok(bytes) = std::fs::read(&path) {
        println!("{} from {}", tag.escape_ascii(), path.display());
        return Ok(SectionWriter::of_bytes(*tag, bytes));
    }
    let section = make()?;
    std::fs::write(&path, section.bytes())?;
    Ok(section)
}

/// The cascade alone on the dev photographs, from jittered true boxes; its global stage also before
/// it was turned into integers.
fn evaluate(
    model: &AlignModel<'_>,
    global: &AlignModel<'_>,
    trained: Option<&align::Trained>,
    data: &Path,
) -> Result<Accuracy> {
    let labels = data.join("faces68");
    let dev = faces::photographs(&labels.join("dev.csv"), &labels.join("dev"))?;
    let boxes = |count| align::Boxes {
        jitter: BoxJitter::DETECTOR,
        count,
    };
    if let Some(trained) = trained {
        let all = trained.network.heads.len();
        for answers in 1..=all {
            let rows = align::evaluate_float(global, trained, answers, &dev, &boxes(1));
            let float = Accuracy::of(&rows);
            println!("dev, global stage in f32, {answers} of {all} answers: {float:.3?}");
        }
        let integers = Accuracy::of(&align::evaluate(global, &dev, &boxes(1), 0));
        println!("dev, global stage in i8: {integers:.3?}");
    }
    for rounds in [1, 10] {
        let again = Accuracy::of(&align::evaluate(model, &dev, &boxes(1), rounds));
        println!("dev, {rounds} more passes: {again:.2?}");
    }
    let accuracy = Accuracy::of(&align::evaluate(model, &dev, &boxes(3), 0));
    println!("dev: {accuracy:.2?}");
    Ok(accuracy)
}

fn data_sheet(args: &Args, dev: &Accuracy) -> String {
    let hard = args.hard_renders;
    let renders = args.renders + args.near_renders + hard;
    let made_from = if args.clean {
        format!(
            "\
- {renders} rendered faces: ICT Face Model Light (MIT, (c) 2020 USC Institute for Creative
  Technologies) with procedural skin, hair and light before procedural backgrounds;
- procedural backgrounds as negatives.
No photograph was used, of anybody or anything. The 3D face holds numbers derived from the ICT Face
Model Light.
"
        )
    } else {
        format!(
            "\
- 2,986 labelled photographs (video frames of 245 public figures) of the facial-keypoints set
  published by Udacity (repository MIT) out of the YouTube Faces database (research), with mirrors;
- news photographs of 115 people out of Labeled Faces in the Wild (research), without labels;
- 816 photographs of single eyes, open and shut, of a public drowsiness set (Kaggle, research);
- {renders} rendered faces: ICT Face Model Light (MIT, (c) 2020 USC Institute for Creative
  Technologies) with procedural skin and skin from those photographs, before procedural backgrounds
  and BSDS500 (research);
- natural photographs without people of BSDS500 (research) as negatives.
The 3D face holds numbers derived from the ICT Face Model Light.

Research terms on some of these data may restrict the use of a model trained on them.
"
        )
    };
    format!(
        "\
# Data sheet of {name}

Made by `cargo run --release -p posewise-train -- model{clean} --seed {seed} --renders {plain}
--near-renders {near} {hard}--steps {steps}`.

Trained on:
{made_from}
Cascade on 511 photographs of 42 other people, from boxes 5 % shifted, 8 % resized and 8 degrees
turned (r.m.s.): mean error over 68 landmarks {mean:.2} % of the inter-ocular distance, median
{median:.2} %, above 10 %: {failure:.2} %.
",
        name = args
            .out
            .file_name()
            .and_then(|n| n.to_str())
            .unwrap_or("the model"),
        clean = if args.clean { " --clean" } else { "" },
        seed = args.seed,
        plain = args.renders,
        near = args.near_renders,
        hard = match hard {
            0 => String::new(),
            _ => format!("--hard-renders {hard} "),
        },
        steps = args.steps,
        mean = dev.nme68,
        median = dev.nme68_median,
        failure = 100.0 * dev.failure,
    )
}
