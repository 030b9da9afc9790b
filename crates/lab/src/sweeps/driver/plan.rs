//! Which clips are rendered, and what a driver does in each.

use super::super::covers::Cover;
use super::super::plan::{Hair, Kind, SEED, Sweep};
use super::args::Args;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// First of the streams of the seed, behind those of the sweeps and the stand-in for U3PT.
const FIRST_STREAM: u64 = 2_000_000;
/// Most that the camera is off the direction of the road \[deg\].
const MOST_DEG: f32 = 40.0;

/// What makes a clip hard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Condition {
    /// Nothing.
    Alert,
    /// Many glances, and heads that turn by 60° from the camera.
    Mirrors,
    /// Half-shut lids, long closures and nods.
    Drowsy,
    /// Many yawns.
    Yawns,
    /// Clear glasses, with reflections.
    ClearGlasses,
    /// Dark glasses.
    DarkGlasses,
    /// Infrared light from beside the camera.
    Infrared,
    /// The same with clear glasses.
    InfraredGlasses,
    /// A hand comes before the eyes.
    HandOnEyes,
    /// A hand comes before the mouth.
    HandOnMouth,
    /// The rim of the wheel is before the chin, and before the eyes when the driver slumps.
    Wheel,
    /// Reads from the lap and looks at the instruments, up to 40° down with the eyes alone.
    Reading,
    /// Laughs with narrowed eyes, and looks down.
    Laughing,
    /// Looks at mirrors, instruments, screen, telephone and passenger with the eyes alone.
    Glances,
    /// A passenger is in view, and the driver ducks out of it.
    Passenger,
    /// Infrared light from beside the camera, at night, and pupils that send it back.
    BrightPupils,
    /// Sun through trees: bars of hard shade move over the face.
    SunBars,
    /// A dark cabin, and headlights behind.
    Headlights,
    /// The camera is turned by about 20° about its axis.
    TurnedCamera,
    /// Sunglasses are pushed up.
    PushedUp,
    /// A cloth mask.
    Mask,
    /// A cap.
    Cap,
}

/// How often a driver does what, in a minute.
pub struct Recipe {
    /// Lengths of closures \[s\].
    pub closures_s: &'static [f32],
    pub mirrors: usize,
    pub laps: usize,
    /// Long glances down, and short ones of the eyes.
    pub readings: usize,
    pub clusters: usize,
    /// Looks of the eyes alone at each of [`TARGETS`] in turn.
    pub looks: usize,
    pub laughs: usize,
    /// Turns by 60° and more from the camera.
    pub turns: usize,
    pub yawns: usize,
    pub nods: usize,
    pub talks: usize,
    /// Hands before the face, or slumps behind the wheel.
    pub covers: usize,
    /// Stoops out of the picture.
    pub ducks: usize,
    /// Most that the lids droop.
    pub droop: f32,
}

/// Something that a driver looks at with the eyes alone: ranges of the angle to the side of the
/// passenger and down, from the road \[deg\].
pub struct Target {
    pub aside_deg: [f32; 2],
    pub down_deg: [f32; 2],
}

/// What is farther off than eyes turn, as a telephone on the lap at 50°, is looked at from the
/// corner of the eye.
pub const TARGETS: [Target; 6] = [
    // The mirror of the driver's side, and that in the middle.
    Target::new([-38.0, -28.0], [2.0, 9.0]),
    Target::new([28.0, 38.0], [-9.0, -3.0]),
    // Instruments and the screen in the middle.
    Target::new([-5.0, 5.0], [18.0, 26.0]),
    Target::new([22.0, 32.0], [12.0, 20.0]),
    // A telephone on the lap.
    Target::new([-6.0, 12.0], [32.0, 40.0]),
    // The passenger.
    Target::new([34.0, 41.0], [-2.0, 5.0]),
];

impl Target {
    const fn new(aside_deg: [f32; 2], down_deg: [f32; 2]) -> Target {
        Target {
            aside_deg,
            down_deg,
        }
    }
}

const USUAL: Recipe = Recipe {
    closures_s: &[0.25, 0.5, 1.2, 2.3],
    mirrors: 3,
    laps: 1,
    readings: 0,
    clusters: 0,
    looks: 0,
    laughs: 0,
    turns: 1,
    yawns: 1,
    nods: 1,
    talks: 1,
    covers: 0,
    ducks: 0,
    droop: 0.15,
};

/// Someone who is awake and looks elsewhere than into mirrors.
const AWAKE: Recipe = Recipe {
    closures_s: &[0.3, 0.7, 1.4],
    mirrors: 1,
    turns: 0,
    yawns: 0,
    nods: 0,
    droop: 0.0,
    ..USUAL
};

impl Condition {
    /// What the driver does.
    pub fn recipe(self) -> Recipe {
        match self {
            Condition::Alert => Recipe {
                closures_s: &[0.22, 0.3, 0.45],
                mirrors: 5,
                laps: 2,
                nods: 0,
                talks: 2,
                droop: 0.0,
                ..USUAL
            },
            Condition::Mirrors => Recipe {
                closures_s: &[0.25, 0.6],
                mirrors: 8,
                laps: 2,
                turns: 4,
                nods: 0,
                droop: 0.0,
                ..USUAL
            },
            Condition::Drowsy => Recipe {
                closures_s: &[0.25, 0.4, 0.7, 1.2, 1.8, 3.3, 6.1],
                mirrors: 2,
                nods: 2,
                talks: 0,
                droop: 0.45,
                ..USUAL
            },
            Condition::Yawns => Recipe {
                closures_s: &[0.3, 0.9],
                mirrors: 2,
                turns: 0,
                yawns: 5,
                talks: 2,
                droop: 0.3,
                ..USUAL
            },
            Condition::HandOnEyes | Condition::HandOnMouth | Condition::Wheel => Recipe {
                closures_s: &[0.3, 0.7, 1.6],
                mirrors: 2,
                nods: 0,
                covers: 4,
                ..USUAL
            },
            Condition::Reading => Recipe {
                laps: 0,
                readings: 5,
                clusters: 4,
                ..AWAKE
            },
            Condition::Laughing => Recipe {
                readings: 1,
                clusters: 2,
                laughs: 7,
                ..AWAKE
            },
            Condition::Glances => Recipe {
                closures_s: &[0.3],
                mirrors: 2,
                looks: 9,
                ..AWAKE
            },
            Condition::Passenger => Recipe { ducks: 4, ..AWAKE },
            _ => USUAL,
        }
    }

    /// What covers a part of the face.
    fn cover(self) -> Option<Cover> {
        match self {
            Condition::DarkGlasses => Some(Cover::Sunglasses),
            Condition::HandOnEyes => Some(Cover::HandOnEyes),
            Condition::HandOnMouth => Some(Cover::HandOnMouth),
            Condition::Wheel => Some(Cover::Wheel),
            Condition::PushedUp => Some(Cover::PushedUp),
            Condition::Mask => Some(Cover::Mask),
            _ => None,
        }
    }
}

/// One clip.
#[derive(Clone, Debug, Serialize)]
pub struct Clip {
    #[serde(flatten)]
    pub sweep: Sweep,
    pub condition: Condition,
    /// Yaw and pitch of a driver who looks at the road, in the camera frame \[deg\].
    pub road_deg: [f32; 2],
}

/// Names, conditions, and how far the camera is off the road \[deg\]; seeds choose the side.
const CLIPS: [(&str, Condition, f32); 77] = [
    ("alert", Condition::Alert, 3.0),
    ("alert", Condition::Alert, 30.0),
    ("mirrors", Condition::Mirrors, 22.0),
    ("mirrors", Condition::Mirrors, 38.0),
    ("drowsy", Condition::Drowsy, 0.0),
    ("drowsy", Condition::Drowsy, 20.0),
    ("drowsy", Condition::Drowsy, 37.0),
    ("yawns", Condition::Yawns, 8.0),
    ("yawns", Condition::Yawns, 25.0),
    ("clear-glasses", Condition::ClearGlasses, 0.0),
    ("clear-glasses", Condition::ClearGlasses, 15.0),
    ("clear-glasses", Condition::ClearGlasses, 32.0),
    ("dark-glasses", Condition::DarkGlasses, 5.0),
    ("dark-glasses", Condition::DarkGlasses, 28.0),
    ("infrared", Condition::Infrared, 0.0),
    ("infrared", Condition::Infrared, 35.0),
    ("infrared", Condition::InfraredGlasses, 18.0),
    ("hand", Condition::HandOnEyes, 10.0),
    ("hand", Condition::HandOnEyes, 27.0),
    ("hand", Condition::HandOnMouth, 0.0),
    ("wheel", Condition::Wheel, 0.0),
    ("wheel", Condition::Wheel, 14.0),
    ("reading", Condition::Reading, 0.0),
    ("reading", Condition::Reading, 8.0),
    ("reading", Condition::Reading, 15.0),
    ("reading", Condition::Reading, 20.0),
    ("reading", Condition::Reading, 25.0),
    ("reading", Condition::Reading, 30.0),
    ("reading", Condition::Reading, 35.0),
    ("laughing", Condition::Laughing, 0.0),
    ("laughing", Condition::Laughing, 8.0),
    ("laughing", Condition::Laughing, 15.0),
    ("laughing", Condition::Laughing, 22.0),
    ("laughing", Condition::Laughing, 30.0),
    ("glances", Condition::Glances, 0.0),
    ("glances", Condition::Glances, 5.0),
    ("glances", Condition::Glances, 10.0),
    ("glances", Condition::Glances, 15.0),
    ("glances", Condition::Glances, 20.0),
    ("glances", Condition::Glances, 25.0),
    ("glances", Condition::Glances, 30.0),
    ("glances", Condition::Glances, 35.0),
    ("glances", Condition::Glances, 3.0),
    ("glances", Condition::Glances, 12.0),
    ("glances", Condition::Glances, 18.0),
    ("glances", Condition::Glances, 22.0),
    ("passenger", Condition::Passenger, 0.0),
    ("passenger", Condition::Passenger, 4.0),
    ("passenger", Condition::Passenger, 8.0),
    ("passenger", Condition::Passenger, 12.0),
    ("passenger", Condition::Passenger, 16.0),
    ("passenger", Condition::Passenger, 20.0),
    ("passenger", Condition::Passenger, 24.0),
    ("passenger", Condition::Passenger, 28.0),
    ("passenger", Condition::Passenger, 6.0),
    ("passenger", Condition::Passenger, 14.0),
    ("bright-pupils", Condition::BrightPupils, 0.0),
    ("bright-pupils", Condition::BrightPupils, 12.0),
    ("bright-pupils", Condition::BrightPupils, 24.0),
    ("sun-bars", Condition::SunBars, 0.0),
    ("sun-bars", Condition::SunBars, 12.0),
    ("sun-bars", Condition::SunBars, 24.0),
    ("headlights", Condition::Headlights, 0.0),
    ("headlights", Condition::Headlights, 12.0),
    ("headlights", Condition::Headlights, 24.0),
    ("turned-camera", Condition::TurnedCamera, 0.0),
    ("turned-camera", Condition::TurnedCamera, 12.0),
    ("turned-camera", Condition::TurnedCamera, 24.0),
    ("pushed-up", Condition::PushedUp, 0.0),
    ("pushed-up", Condition::PushedUp, 12.0),
    ("pushed-up", Condition::PushedUp, 24.0),
    ("mask", Condition::Mask, 0.0),
    ("mask", Condition::Mask, 12.0),
    ("mask", Condition::Mask, 24.0),
    ("cap", Condition::Cap, 0.0),
    ("cap", Condition::Cap, 12.0),
    ("cap", Condition::Cap, 24.0),
];

/// All clips.
pub fn clips(args: &Args) -> Vec<Clip> {
    let mut count = std::collections::BTreeMap::new();
    let clip = |(stream, (group, condition, off_deg)): (usize, (&'static str, Condition, f32))| {
        let n = count.entry(group).and_modify(|n| *n += 1).or_insert(1);
        let seed = (SEED ^ args.material.seed, FIRST_STREAM + stream as u64);
        let mut rng = ChaCha8Rng::seed_from_u64(seed.0);
        // What the plan draws is apart from what the scene draws.
        rng.set_stream(2 * FIRST_STREAM + stream as u64);
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let off = side * (off_deg + rng.random_range(-3.0..3.0f32)).clamp(0.0, MOST_DEG);
        let hairs = [Hair::Short, Hair::Bald, Hair::Big, Hair::Short];
        Clip {
            sweep: Sweep {
                name: format!("{group}-{n:02}"),
                kind: Kind::Driver(condition.cover()),
                hair: match (hairs[rng.random_range(0..hairs.len())], condition) {
                    (_, Condition::Cap) => Hair::Cap,
                    (hair, _) => hair,
                },
                view_deg: match condition {
                    // Both seats are in the picture.
                    Condition::Passenger => rng.random_range(60.0..72.0),
                    _ => rng.random_range(34.0..50.0),
                },
                seed,
                person: None,
                size: [args.width, args.width * 3 / 4],
                frames: args.seconds * args.fps,
                fps: args.fps,
            },
            condition,
            road_deg: [off, rng.random_range(-4.0..12.0)],
        }
    };
    CLIPS.into_iter().enumerate().map(clip).collect()
}
