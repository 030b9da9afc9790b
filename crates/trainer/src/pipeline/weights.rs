//! Stage `weights`: animation weights that are seen (section `WGHT`). It depends on a finished
//! model's networks, so it is added to one.

use super::add::{self, Added};
use super::data_sheet::WEIGHTS_HEADING;
use super::sections;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::render::{self, Kind};
use crate::weights::{self, Figures, Options};
use anyhow::Result;
use posewise::align::WEIGHTS_TAG;
use posewise_format::Blob;

/// The rendered pictures.
const SHOTS: &str = "shots.bin";
/// What the network reaches.
const FIGURES: &str = "figures.json";

/// Options of `posewise-train add-weights`.
#[derive(Clone, Debug, clap::Args)]
pub struct AddArgs {
    #[command(flatten)]
    pub add: add::Args,
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
    let data = &args.add.data;
    let spec = [weights::spec(0), weights::spec(1)];
    let stage = Stage::new("weights-renders", 1)
        .options(&(args.seed, args.persons, spec))?
        .input("facekit.npz", store.data(&data.join("facekit.npz"))?)
        .input(
            "makehuman",
            store.data(&data.join(render::MAKEHUMAN_FOLDER))?,
        )
        .input("panoramas", store.data(&data.join(render::PANORAMA_FILE))?);
    store.make(&stage, &[SHOTS], |folder| {
        let seed = args.seed ^ PEOPLE;
        let procedural = render::Args::procedural(data, seed, Kind::Near);
        let renderer = render::renderer(&procedural, None)?;
        weights::write(&folder.join(SHOTS), &renderer, seed, args.persons)
    })
}

/// Writes a model with section `WGHT` added or replaced.
pub fn add(args: &AddArgs) -> Result<()> {
    let store = Store::open(&args.add.cache)?;
    let bytes = add::read(&args.add.model)?;
    let model = Blob::open(&bytes)?;
    let options = Options::new(args.seed);
    let shots = shots(&store, args)?;
    let stage = Stage::new("weights", 1)
        .options(&options)?
        .input("model", store.data(&args.add.model)?)
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
    let added = Added {
        tag: WEIGHTS_TAG,
        section: sections::read(&(&output, WEIGHTS_TAG))?,
        heading: WEIGHTS_HEADING,
        about: &about(args, &figures),
    };
    add::write(&model, &added, &args.add.out)
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
