//! What the network is trained on and for: its outputs, rows and settings.

use posewise::align::{Inputs, MAX_SEEN, MIDDLE_WEIGHTS, SIDE_WEIGHTS, WEIGHT_OUTPUTS};
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
pub const OF_PERSON: f32 = 0.15;

/// Persons in this number, one is held out for measuring.
pub const HELD_OUT: u32 = 9;

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
    pub taken: [usize; 3],
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
