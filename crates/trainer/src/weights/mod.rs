//! Trains section `WGHT`: animation weights that the 3D face has no modes for, from what the
//! refiners' networks see.
//!
//! Rendered people show mixtures of all weights (`shots`). What the last heads of the refiners read
//! is reduced to a few numbers by ridge regression (`views`); then a tracker with these numbers is
//! shown each person's pictures, one after the other, and a small network learns the weights from
//! what it is given (`network`). What is the same on all pictures of a person counts little: the
//! tracker takes the face at rest off.

mod network;
mod shots;
mod tracked;
mod views;

pub use network::Trained;
pub use shots::{PICTURES, Shot, expression, read, spec, write};
pub use tracked::{go_on, show};

use anyhow::{Result, ensure};
use posewise::align::{
    GEOMETRY, Inputs, MAX_SEEN, MIDDLE_WEIGHTS, SIDE_WEIGHTS, WEIGHT_OUTPUTS, WEIGHTS_TAG,
};
use posewise::track::Model;
use posewise_format::{AlignedBytes, Blob, SHEET_TAG, SectionWriter, blob};
use serde::{Deserialize, Serialize};

/// Outputs of a run that belong to no side, and stems of the names of those of a side.
const MIDDLE: [&str; MIDDLE_WEIGHTS] = [
    "cheekPuff",
    "jawForward",
    "mouthClose",
    "mouthRollLower",
    "mouthRollUpper",
    "mouthShrugLower",
    "mouthShrugUpper",
];
const SIDES: [&str; SIDE_WEIGHTS] = [
    "eyeSquint",
    "mouthDimple",
    "mouth",
    "mouthPress",
    "noseSneer",
];

/// All weights that the network is trained on. The library offers those that it sees well enough.
pub const NAMES: [&str; SEEN] = [
    "cheekPuff",
    "eyeSquintLeft",
    "eyeSquintRight",
    "jawForward",
    "mouthClose",
    "mouthDimpleLeft",
    "mouthDimpleRight",
    "mouthLeft",
    "mouthRight",
    "mouthPressLeft",
    "mouthPressRight",
    "mouthRollLower",
    "mouthRollUpper",
    "mouthShrugLower",
    "mouthShrugUpper",
    "noseSneerLeft",
    "noseSneerRight",
];
/// Number of these.
pub const SEEN: usize = MIDDLE_WEIGHTS + 2 * SIDE_WEIGHTS;

/// Numbers that are taken of each refiner: eye with brow, mouth, lids.
const TAKEN: [usize; 3] = [3, 5, 0];
const _: () = assert!(TAKEN[0] <= MAX_SEEN && TAKEN[1] <= MAX_SEEN && TAKEN[2] <= MAX_SEEN);

/// Share of the loss that the mean error on the pictures of a person has.
const OF_PERSON: f32 = 0.15;

/// Persons in this number, one is held out for measuring.
const HELD_OUT: u32 = 9;

/// How the network is trained.
#[derive(Clone, Debug, Serialize)]
pub struct Options {
    /// Seed of all randomness.
    pub seed: u64,
    /// Hidden values.
    pub hidden: usize,
    /// Rounds over all persons.
    pub rounds: usize,
    /// Numbers of the refiners.
    taken: [usize; 3],
    of_person: f32,
}

impl Options {
    /// With the defaults.
    pub fn new(seed: u64) -> Options {
        Options {
            seed,
            hidden: 12,
            rounds: 60,
            taken: TAKEN,
            of_person: OF_PERSON,
        }
    }
}

/// Correlation and error of each output on held-out people.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Figures {
    /// By weight of `ANIMATION_NAMES` after the fitted ones: correlation, r.m.s. error.
    pub weights: Vec<(String, f32, f32)>,
    /// Pictures of them.
    pub pictures: usize,
    /// Those of all others.
    pub trained_on: usize,
}

/// For each output of a run, for the person's right side or the left one, the weight that it is,
/// after the fitted ones.
pub fn places(left: bool) -> [usize; WEIGHT_OUTPUTS] {
    let side = if left { "Left" } else { "Right" };
    let names = MIDDLE.map(String::from).into_iter();
    let names = names.chain(SIDES.map(|stem| format!("{stem}{side}")));
    let place = |name: String| NAMES.iter().position(|n| *n == name);
    let all: Vec<usize> = names.filter_map(place).collect();
    all.try_into().expect("every output has a name")
}

/// The targets of a run.
pub fn targets(weights: &[f32; SEEN], left: bool) -> [f32; WEIGHT_OUTPUTS] {
    places(left).map(|at| weights[at])
}

/// What a tracker gives the network on a picture.
pub struct Row {
    /// The person.
    pub person: u32,
    /// Of the plain side, and of the mirrored one.
    pub inputs: [Inputs; 2],
    /// What is true of them.
    pub targets: [[f32; WEIGHT_OUTPUTS]; 2],
}

/// Trains the section for a finished model.
pub fn train(model: &[u8], shots: &[Shot], options: &Options) -> Result<(SectionWriter, Figures)> {
    let is_held_out = |person: u32| person.is_multiple_of(HELD_OUT);
    let bytes = AlignedBytes::new(model);
    let (without, views) = {
        let model = Model::load(&bytes)?;
        let views = views::train(&model, shots, &options.taken, is_held_out)?;
        let kept = (model.blob().sections())
            .filter(|(tag, _)| ![WEIGHTS_TAG, SHEET_TAG].contains(tag))
            .map(|(tag, bytes)| SectionWriter::of_bytes(tag, bytes.to_vec()))
            .collect::<Vec<_>>();
        (kept, views)
    };
    let inputs = GEOMETRY + 2 * options.taken.iter().sum::<usize>();
    let with = |network: &Trained| -> Result<Vec<u8>> {
        let mut sections = without.clone();
        sections.push(section(&views, network));
        Ok(blob(&sections))
    };
    let blank = AlignedBytes::new(&with(&Trained::blank(inputs))?);
    let model = Model::load(&blank)?;
    ensure!(model.align().weights().inputs() == inputs, "other inputs");
    let rows = tracked::rows(&model, shots)?;
    println!(
        "weights: {} of {} pictures tracked",
        rows.len(),
        shots.len()
    );
    let (tests, trains): (Vec<Row>, Vec<Row>) =
        rows.into_iter().partition(|r| is_held_out(r.person));
    let trained = network::train(&trains, &tests, inputs, options);
    let figures = trained.figures(&tests, trains.len());
    Ok((section(&views, &trained), figures))
}

/// Opens a model's blob again, to check that a section belongs to it.
pub fn check(model: &[u8]) -> Result<()> {
    let bytes = AlignedBytes::new(model);
    Blob::open(&bytes)?;
    Model::load(&bytes)?;
    Ok(())
}

fn section(views: &[views::View], network: &Trained) -> SectionWriter {
    let mut out = SectionWriter::new(WEIGHTS_TAG);
    views.iter().for_each(|view| view.write(&mut out));
    network.write(&mut out);
    out
}
