//! Stage `eyes`: the network of single eyes (section `EYES`). It depends on renders and photographs
//! alone, so that it can be added to a finished model.

use super::add::{self, Added};
use super::args::Args;
use super::context::Context;
use super::data_sheet::EYES_HEADING;
use super::renders;
use super::sections;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::eyes::{self, EyeOptions, PhotographedEye};
use crate::faces;
use crate::head::MARKS_VERSION;
use crate::render::{Kind, eye_cache};
use crate::sources::Terms;
use anyhow::Result;
use posewise::align::EYES_TAG;
use posewise_format::Blob;
use std::path::PathBuf;

/// Renders of other people, by which probabilities are calibrated.
const CALIBRATION: u64 = 1500;
/// Changes the seed of those.
const OTHERS: u64 = 0xca11;
/// The network after its first round, which the models share.
const NETWORK: &str = "network.checkpoint";
/// What the network reaches.
const FIGURES: &str = "figures.json";

/// Makes the section. The training goes on from the mean of the network of the finished model and
/// of those of these checkpoints.
fn make(context: &Context<'_>, others: &[PathBuf]) -> Result<Output> {
    let args = context.args;
    let mut options = EyeOptions::new(args.seed, args.eye_steps);
    options.network.rate = context.rate(options.network.rate);
    // Eyes are procedural in every render, so photographed skins bring little and take long.
    let render = crate::render::Args {
        clean: true,
        ..args.render(Kind::Eyes, &context.sources)
    };
    let calibrating = crate::render::Args {
        seed: render.seed ^ OTHERS,
        count: CALIBRATION,
        ..render.clone()
    };
    let rendered = renders::make(context.store, &render, None)?;
    let calibration = renders::make(context.store, &calibrating, None)?;
    let read = |output: &Output| eye_cache::read(&output.path(renders::FILE), usize::MAX);
    let sets = context.sources.whole();
    let photographed = || -> Result<Vec<PhotographedEye>> {
        let mut all = vec![];
        for set in &sets {
            all.extend(PhotographedEye::all(&faces::of_set(set, &args.data)?));
        }
        println!("{} eyes of photographed faces", all.len());
        Ok(all)
    };
    let shares = (options.by_nose, options.photographed_share, MARKS_VERSION);
    let mut stage = Stage::new("eyes-network", 5)
        .options(&(&options.network, shares))?
        .input("renders-eyes", rendered.hash(renders::FILE)?);
    for set in &sets {
        for name in [set.table, set.images] {
            stage = stage.input(name, context.store.data(&context.data(name))?);
        }
    }
    let mut stage = context.with_finished(stage);
    for (k, path) in others.iter().enumerate() {
        stage = stage.input(&format!("average-{k}"), context.store.data(path)?);
    }
    let network = context.store.make(&stage, &[NETWORK], |folder| {
        let first = context.section(EYES_TAG)?.into_iter();
        let mut before = (first.map(|section| eyes::of_section(section, &options)))
            .collect::<Result<Vec<_>>>()?;
        for path in others {
            before.push(eyes::of_checkpoint(path, &options)?);
        }
        let (rendered, checkpoint) = (read(&rendered)?, folder.join(NETWORK));
        eyes::train_first(&rendered, &photographed()?, &options, &checkpoint, &before)
    })?;
    let stage = Stage::new("eyes", 6)
        .options(&options)?
        .input("eyes-network", network.hash(NETWORK)?)
        .input("renders-eyes", rendered.hash(renders::FILE)?)
        .input("calibration", calibration.hash(renders::FILE)?);
    let folders = context.sources.single_eyes();
    let stage = folders.iter().try_fold(stage, |stage, name| {
        anyhow::Ok(stage.input(name, context.store.data(&context.data(name))?))
    })?;
    let files = [sections::FILE, FIGURES];
    let output = context.store.make(&stage, &files, |folder| {
        let (rendered, calibration) = (read(&rendered)?, read(&calibration)?);
        let photographs = |held_out| -> Result<Vec<_>> {
            let read = |name: &&str| eyes::read_single(&context.data(name), held_out);
            let all = folders.iter().map(read).collect::<Result<Vec<_>>>()?;
            Ok(all.concat())
        };
        let single = photographs(false)?;
        let section = eyes::section(
            &network.path(NETWORK),
            &rendered,
            &calibration,
            &photographed()?,
            &single,
            &options,
            &folder.join("second.checkpoint"),
        )?;
        let figures = eyes::figures(&section, &calibration, &photographs(true)?)?;
        std::fs::write(folder.join(FIGURES), serde_json::to_vec(&figures)?)?;
        sections::write(folder, &section)
    })?;
    println!("eyes: {}", String::from_utf8_lossy(&output.read(FIGURES)?));
    Ok(output)
}

/// Options of `posewise-train add-eyes`.
#[derive(Clone, Debug, clap::Args)]
pub struct AddArgs {
    /// The finished model.
    #[arg(long)]
    pub model: PathBuf,
    /// Begin with the mean of the network of `--from` and of that in this checkpoint of the stage
    /// `eyes-network`, which went on from it; repeat for several.
    #[arg(long, requires = "from")]
    pub average: Vec<PathBuf>,
    /// Those of a whole model; `--out` is where the model with the section goes.
    #[command(flatten)]
    pub args: Args,
}

/// Writes a model with section `EYES` added or replaced.
pub fn add(options: &AddArgs) -> Result<()> {
    let args = &options.args;
    let store = Store::open(&args.cache)?;
    let context = Context::new(args, &store, None)?;
    let output = make(&context, &options.average)?;
    let figures: serde_json::Value = serde_json::from_slice(&output.read(FIGURES)?)?;
    let bytes = add::read(&options.model)?;
    let added = Added {
        tag: EYES_TAG,
        section: sections::read(&(&output, EYES_TAG))?,
        heading: EYES_HEADING,
        about: &about(options, &figures),
    };
    add::write(&Blob::open(&bytes)?, &added, &args.out)
}

/// What a data sheet says of the section.
fn about(add: &AddArgs, figures: &serde_json::Value) -> String {
    let args = &add.args;
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
    let (terms, photographs) = match args.terms {
        Terms::Free => ("free", "no picture of an eye that was shut but by drawing"),
        Terms::Research => (
            "research",
            "four fifths of the photographs of single
eyes above, and of 4,000 in near-infrared light (MRL Eye Dataset, research)",
        ),
    };
    let averaged = |path: &PathBuf| format!("\n--average {}", path.display());
    let averaged: String = add.average.iter().map(averaged).collect();
    let begun = match add.average.is_empty() {
        true => "",
        false => {
            "\nIt began with the mean of these networks, which went on from the first as \
             docs/dev/records.md tells\n(Shut eyes of photographs)."
        }
    };
    format!(
        "\
added by `cargo run --release -p posewise-train -- add-eyes --terms {terms} --seed {seed}
--eye-renders {renders} --eye-steps {steps}{from}`. Trained on {renders} rendered faces,
which look up to 40 degrees down, and on the eyes of the photographed whole faces above, half of
them shut by drawing and a fifth looking down; {photographs}.{begun}
On {CALIBRATION} renders of other heads, which also set its 22 numbers of calibration:
gaze of both eyes within 30 degrees of yaw {gaze:.1} degrees; areas under the ROC of lids {lids:.3},
glasses {glasses:.3}, dark glasses {dark:.3}, visible eyes {visible:.3}.",
        seed = args.seed,
        from = args.from_option() + &averaged,
        renders = args.eye_renders,
        steps = args.eye_steps,
        gaze = number(&figures["both_deg"]),
        lids = number(&figures["auc"][0]),
        glasses = number(&figures["auc"][1]),
        dark = number(&figures["auc"][2]),
        visible = number(&figures["auc"][3]),
    )
}
