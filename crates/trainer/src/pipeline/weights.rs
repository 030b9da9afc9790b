//! Stage `weights`: animation weights that are seen (section `WGHT`). It depends on a finished
//! model's networks, so it is added to one.

use super::data_sheet::{self, WEIGHTS_HEADING};
use super::sections;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::render::{self, Kind};
use crate::weights::{self, Figures, Options};
use anyhow::{Context, Result};
use posewise::align::WEIGHTS_TAG;
use posewise_format::{AlignedBytes, Blob, SHEET_TAG, SectionWriter, blob};
use std::path::PathBuf;

/// The rendered pictures.
const SHOTS: &str = "shots.bin";
/// What the network reaches.
const FIGURES: &str = "figures.json";

/// Options of `posewise-train add-weights`.
#[derive(Clone, Debug, clap::Args)]
pub struct AddArgs {
    /// The finished model.
    #[arg(long)]
    pub model: PathBuf,
    /// The shared data: `facekit.npz`, `free/`.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for the outputs of stages.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
    /// Where the model with the section goes; its data sheet is written beside it, ending in `.md`.
    #[arg(long)]
    pub out: PathBuf,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Rendered people, of whom there are ten pictures each.
    #[arg(long, default_value_t = 1000)]
    pub persons: u64,
}

/// Changes the seed of people from that of other renders.
const PEOPLE: u64 = 0x3e16;

fn shots(store: &Store, args: &AddArgs) -> Result<Output> {
    let spec = [weights::spec(0), weights::spec(1)];
    let stage = Stage::new("weights-renders", 1)
        .options(&(args.seed, args.persons, spec))?
        .input("facekit.npz", store.data(&args.data.join("facekit.npz"))?)
        .input(
            "makehuman",
            store.data(&args.data.join(render::MAKEHUMAN_FOLDER))?,
        )
        .input(
            "panoramas",
            store.data(&args.data.join(render::PANORAMA_FILE))?,
        );
    store.make(&stage, &[SHOTS], |folder| {
        let renderer = render::renderer(
            &render::Args {
                data: args.data.clone(),
                cache: PathBuf::new(),
                count: 0,
                seed: args.seed ^ PEOPLE,
                clean: true,
                makehuman: render::MAKEHUMAN,
                panoramas: render::PANORAMAS,
                kind: Kind::Near,
            },
            None,
        )?;
        let seed = args.seed ^ PEOPLE;
        weights::write(&folder.join(SHOTS), &renderer, seed, args.persons)
    })
}

/// Writes a model with section `WGHT` added or replaced; every other section stays as it is.
pub fn add(args: &AddArgs) -> Result<()> {
    let store = Store::open(&args.cache)?;
    let path = args.model.display();
    let bytes = std::fs::read(&args.model).with_context(|| format!("reading {path}"))?;
    let options = Options::new(args.seed);
    let shots = shots(&store, args)?;
    let stage = Stage::new("weights", 1)
        .options(&options)?
        .input("model", store.data(&args.model)?)
        .input("weights-renders", shots.hash(SHOTS)?);
    let output = store.make(&stage, &[sections::FILE, FIGURES], |folder| {
        let shots = weights::read(&shots.path(SHOTS))?;
        let (section, figures) = weights::train(&bytes, &shots, &options)?;
        std::fs::write(folder.join(FIGURES), serde_json::to_vec(&figures)?)?;
        sections::write(folder, &section)
    })?;
    let figures: Figures = serde_json::from_slice(&output.read(FIGURES)?)?;
    for (name, correlation, error) in &figures.weights {
        println!("{name:20} correlation {correlation:.3}, r.m.s. error {error:.3}");
    }
    let aligned = AlignedBytes::new(&bytes);
    let model = Blob::open(&aligned)?;
    let mut all: Vec<SectionWriter> = (model.sections())
        .filter(|(tag, _)| ![WEIGHTS_TAG, SHEET_TAG].contains(tag))
        .map(|(tag, bytes)| SectionWriter::of_bytes(tag, bytes.to_vec()))
        .collect();
    all.push(sections::read(&(&output, WEIGHTS_TAG))?);
    weights::check(&blob(&all))?;
    let sheet = model.sections().find(|(tag, _)| *tag == SHEET_TAG);
    let sheet = std::str::from_utf8(sheet.map_or(&[], |(_, bytes)| bytes))?;
    let sheet = data_sheet::titled(sheet, &args.out);
    let sheet = data_sheet::with_part(&sheet, WEIGHTS_HEADING, &about(args, &figures));
    let size = super::pack::write(&args.out, all, &format!("{sheet}\n"))?;
    println!("{}: {size} bytes", args.out.display());
    Ok(())
}

/// What a data sheet says of the section.
fn about(args: &AddArgs, figures: &Figures) -> String {
    let each = figures
        .weights
        .iter()
        .map(|(_, correlation, _)| correlation);
    let count = figures.weights.len() as f32;
    format!(
        "\
added by `cargo run --release -p posewise-train -- add-weights --seed {seed}
--persons {persons}`. Trained on {trained} pictures of rendered heads of facekit and makehuman
above; no photograph was used. On {pictures} pictures of other such heads the correlation with the
truth is {mean:.2} on average and {least:.2} at least, the mean error of each person taken off.",
        seed = args.seed,
        persons = args.persons,
        trained = figures.trained_on,
        pictures = figures.pictures,
        mean = each.clone().sum::<f32>() / count,
        least = each.fold(1.0, |least: f32, r| least.min(*r)),
    )
}
