//! Which clips are rendered.

use super::covers::Cover;
use serde::Serialize;

/// What a clip shows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Kind {
    /// The head turns from one side to the other, to 95°.
    Yaw,
    /// The head nods from 40° up to 40° down, turned to the side in some clips.
    Pitch,
    /// Candide-3 turns from one side to the other.
    Candide,
    /// Two people pass each other; each turns the head within ±20°.
    Crossing,
    /// The head turns slowly within ±40° and something covers a part of the face.
    Covered(Cover),
    /// One of a subject's videos in the stand-in for U3PT.
    Subject(Video),
    /// A driver, whose script is not that of [`super::motion`]; something covers the face.
    Driver(Option<Cover>),
}

/// The videos of a subject in the stand-in for U3PT.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Video {
    /// The head turns from one side to the other, to 90°.
    Yaw,
    /// It nods, to 40°.
    Pitch,
    /// It tilts, to 45°.
    Roll,
    /// Strong expressions; something covers a part of the face for a while.
    Expression(Cover),
    /// It moves about all axes, under a light that moves too.
    Free,
}

impl Kind {
    /// What covers the face.
    pub fn cover(self) -> Option<Cover> {
        match self {
            Kind::Covered(cover) | Kind::Subject(Video::Expression(cover)) => Some(cover),
            Kind::Driver(cover) => cover,
            _ => None,
        }
    }
}

/// What is on top of the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Hair {
    /// Close to the skull.
    Short,
    /// Past the ears.
    Long,
    /// None.
    Bald,
    /// Under a cap.
    Cap,
    /// Stands off further than that of any head in training.
    Big,
}

/// One clip.
#[derive(Clone, Debug, Serialize)]
pub struct Sweep {
    /// Name of its files.
    pub name: String,
    /// What it shows.
    pub kind: Kind,
    /// What is on top of the head.
    pub hair: Hair,
    /// Horizontal field of view \[deg\].
    pub view_deg: f32,
    /// Seed and stream of everything random.
    pub seed: (u64, u64),
    /// Those of the person, where several clips show the same one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub person: Option<(u64, u64)>,
    /// Width and height of the frames \[px\].
    #[serde(skip)]
    pub size: [usize; 2],
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub fps: usize,
}

/// Size of the frames \[px\].
pub const SIZE: [usize; 2] = [640, 480];
const HAIRS: [Hair; 5] = [Hair::Short, Hair::Long, Hair::Bald, Hair::Cap, Hair::Big];
/// From a phone at arm's length to a lens that looks across a room \[deg\].
pub const VIEWS_DEG: [f32; 7] = [86.0, 34.0, 62.0, 24.0, 74.0, 48.0, 66.0];
const COVERS: [Cover; 12] = [
    Cover::HandOnEyes,
    Cover::PhoneOnEyes,
    Cover::Sunglasses,
    Cover::Scarf,
    Cover::HairRight,
    Cover::HairLeft,
    Cover::Mask,
    Cover::PhoneOnMouth,
    Cover::HandOnEyes,
    Cover::Sunglasses,
    Cover::HandOnMouth,
    Cover::Scarf,
];
/// Streams of one seed; training draws people by other seeds.
pub const SEED: u64 = 0x7377_6565_7073;

/// All clips of a seed.
pub fn sweeps(seed: u64, candide: bool) -> Vec<Sweep> {
    let yaw = (0..16).map(|_| ("yaw", Kind::Yaw));
    let pitch = (0..4).map(|_| ("pitch", Kind::Pitch));
    let second = (0..if candide { 3 } else { 0 }).map(|_| ("candide", Kind::Candide));
    let covered = COVERS.iter().map(|c| (c.name(), Kind::Covered(*c)));
    let all = yaw.chain(pitch).chain(covered).chain(second);
    let mut count = std::collections::BTreeMap::new();
    all.enumerate()
        .map(|(stream, (group, kind))| {
            let n = count.entry(group).and_modify(|n| *n += 1).or_insert(1);
            let (frames, fps) = match kind {
                Kind::Yaw | Kind::Candide => (120, 20),
                Kind::Pitch => (100, 25),
                Kind::Covered(_) | Kind::Crossing | Kind::Subject(_) | Kind::Driver(_) => (110, 25),
            };
            Sweep {
                name: format!("{group}-{n:02}"),
                kind,
                hair: hair(kind, stream),
                view_deg: VIEWS_DEG[stream % VIEWS_DEG.len()],
                seed: (SEED ^ seed, stream as u64),
                person: None,
                size: SIZE,
                frames,
                fps,
            }
        })
        .collect()
}

fn hair(kind: Kind, stream: usize) -> Hair {
    let hair = HAIRS[stream % HAIRS.len()];
    match (kind, hair) {
        // Candide's skull has painted hair only, and what is drawn over a face needs its room.
        (Kind::Candide, _) => Hair::Short,
        (Kind::Covered(_), Hair::Cap | Hair::Long) => Hair::Short,
        _ => hair,
    }
}
