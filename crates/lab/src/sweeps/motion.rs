//! How a head moves and what its face does.

use super::plan::{Kind, Sweep, Video};
use glam::Vec3;
use posewise::math::HeadAngles;
use posewise_train::render::expression::Expression;
use posewise_train::render::noise::smoothstep;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::TAU;

/// Most that a head turns to a side \[deg\].
const YAW_DEG: f32 = 95.0;
/// Most that a head nods \[deg\].
const PITCH_DEG: f32 = 40.0;
/// Most that a head of the stand-in for U3PT turns to a side and tilts \[deg\].
const SUBJECT_YAW_DEG: f32 = 90.0;
const SUBJECT_ROLL_DEG: f32 = 45.0;
/// How often each strong expression is shown in a clip, and most that its light turns \[rad\].
const ROUNDS: f32 = 2.0;
const LIGHT_TURN: f32 = 1.2;
/// When something begins to cover the face, how long that takes, and how long it stays \[s\].
const COVER_S: f32 = 1.1;
const COMES_S: f32 = 0.35;
const STAYS_S: f32 = 2.1;

/// What the head does at a moment.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Head pose.
    pub angles: HeadAngles,
    /// Movement of the whole body \[mm\].
    pub sway: Vec3,
    /// Weights of expressions.
    pub blink: f32,
    /// Opening of the jaw.
    pub jaw: f32,
    /// Smile of both corners.
    pub smile: f32,
    pub(super) brows: f32,
    pub(super) pucker: f32,
    /// How far cheeks and lower lids narrow the eyes.
    pub(super) squint: f32,
    /// Gaze to the image right and down \[rad\].
    pub gaze: (f32, f32),
    /// How far the cover has come: 0 away, 1 there.
    pub cover: f32,
    /// How far the key light has turned about the vertical axis \[rad\].
    pub light_turn: f32,
}

impl Moment {
    /// The expression as the renderer takes it.
    pub fn expression(&self) -> Expression {
        let mut face = Expression::default();
        face.gaze = self.gaze;
        let squint = self.squint * face.squint_share();
        for (name, weight) in [
            ("eyeBlinkLeft", self.blink),
            ("eyeBlinkRight", self.blink),
            ("jawOpen", self.jaw),
            ("mouthSmileLeft", self.smile),
            ("mouthSmileRight", self.smile),
            ("mouthPucker", self.pucker),
            ("browInnerUp", self.brows),
            ("browOuterUpLeft", self.brows),
            ("browOuterUpRight", self.brows),
            ("eyeSquintLeft", squint),
            ("eyeSquintRight", squint),
            ("cheekSquintLeft", 0.7 * squint),
            ("cheekSquintRight", 0.7 * squint),
        ] {
            face.add(name, weight);
        }
        face.follow_gaze(1.0 - self.blink);
        face
    }
}

/// A slow oscillation about a mean.
struct Wave {
    mean: f32,
    size: f32,
    periods: f32,
    phase: f32,
}

impl Wave {
    /// Amplitude from half of `size` on.
    fn random(rng: &mut ChaCha8Rng, mean: f32, size: f32) -> Wave {
        Wave {
            mean: mean * rng.random_range(-1.0..1.0f32),
            size: size * rng.random_range(0.5..1.0f32),
            periods: rng.random_range(0.7..1.6),
            phase: rng.random_range(0.0..TAU),
        }
    }

    /// `share` of the clip is over.
    fn at(&self, share: f32) -> f32 {
        self.mean + self.size * (TAU * self.periods * share + self.phase).sin()
    }
}

/// The script of a clip.
pub struct Motion {
    kind: Kind,
    length_s: f32,
    side: f32,
    yaw: Wave,
    pitch: Wave,
    roll: Wave,
    sway: [Wave; 3],
    gaze: [Wave; 2],
    talk: f32,
    smile: Wave,
    /// Begin and length of each blink \[s\].
    blinks: Vec<(f32, f32)>,
}

impl Motion {
    /// A random one.
    pub fn new(rng: &mut ChaCha8Rng, sweep: &Sweep) -> Motion {
        let length_s = sweep.frames as f32 / sweep.fps as f32;
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let (yaw, pitch, roll) = match sweep.kind {
            Kind::Yaw | Kind::Candide => ((0.0, 0.0), (12.0, 10.0), (7.0, 9.0)),
            Kind::Pitch => ((35.0, 10.0), (0.0, 0.0), (5.0, 8.0)),
            Kind::Covered(_) => ((6.0, 34.0), (6.0, 9.0), (5.0, 7.0)),
            Kind::Crossing | Kind::Driver(_) => ((4.0, 16.0), (4.0, 6.0), (3.0, 5.0)),
            Kind::Subject(Video::Expression(_)) => ((10.0, 12.0), (5.0, 6.0), (4.0, 5.0)),
            Kind::Subject(Video::Free) => ((15.0, 50.0), (8.0, 15.0), (6.0, 15.0)),
            Kind::Subject(_) => ((8.0, 6.0), (5.0, 5.0), (4.0, 5.0)),
        };
        let mut wave = |(mean, size): (f32, f32)| Wave::random(rng, mean, size);
        let (yaw, pitch, roll) = (wave(yaw), wave(pitch), wave(roll));
        let sway = [14.0, 8.0, 16.0].map(|size| wave((0.0, size)));
        let gaze = [0.25, 0.12].map(|size| wave((0.0, size)));
        let smile = wave((0.4, 0.4));
        let mut blinks = Vec::new();
        let mut at = rng.random_range(0.3..0.9f32);
        while at < length_s - 0.5 {
            // One of four is a long closure.
            let long = if rng.random_bool(0.25) { 0.5 } else { 0.22 };
            blinks.push((at, long));
            at += long + rng.random_range(0.8..2.4f32);
        }
        Motion {
            kind: sweep.kind,
            length_s,
            side,
            yaw,
            pitch,
            roll,
            sway,
            gaze,
            talk: if rng.random_bool(0.6) { 1.0 } else { 0.0 },
            smile,
            blinks,
        }
    }

    /// The moment `t` seconds after the start.
    pub fn at(&self, t: f32) -> Moment {
        let share = t / self.length_s;
        let full = self.side * there_and_back(share);
        let [yaw, pitch, roll] = [&self.yaw, &self.pitch, &self.roll].map(|wave| wave.at(share));
        let [yaw_deg, pitch_deg, roll_deg] = match self.kind {
            Kind::Yaw | Kind::Candide => [YAW_DEG * full, pitch, roll],
            Kind::Subject(Video::Yaw) => [SUBJECT_YAW_DEG * full, pitch, roll],
            Kind::Pitch | Kind::Subject(Video::Pitch) => [yaw, PITCH_DEG * full, roll],
            Kind::Subject(Video::Roll) => [yaw, pitch, SUBJECT_ROLL_DEG * full],
            _ => [yaw, pitch, roll],
        };
        let talk = self.talk * (0.55 + 0.45 * (0.9 * t).sin());
        let closed = |(from, long): &(f32, f32)| {
            let shut = 0.1;
            smoothstep(*from, from + shut, t)
                * (1.0 - smoothstep(from + long - shut, from + long, t))
        };
        let mut moment = Moment {
            angles: HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            },
            sway: Vec3::from_array(std::array::from_fn(|k| self.sway[k].at(share))),
            blink: self.blinks.iter().map(closed).fold(0.05, f32::max),
            jaw: talk * (0.18 + 0.16 * (10.5 * t).sin() + 0.08 * (6.1 * t).sin()).max(0.0),
            smile: self.smile.at(share).clamp(0.0, 0.9),
            brows: 0.4 * (1.0 + (2.3 * t).sin()) * talk,
            pucker: 0.2 * talk * (1.0 + (4.3 * t).sin()),
            squint: 0.0,
            gaze: (self.gaze[0].at(share), self.gaze[1].at(share)),
            cover: cover(self.kind, t),
            light_turn: match self.kind {
                Kind::Subject(Video::Free) => LIGHT_TURN * (TAU * share).sin(),
                _ => 0.0,
            },
        };
        if let Kind::Subject(Video::Expression(_)) = self.kind {
            moment.show_strongly(share);
        }
        moment
    }
}

impl Moment {
    /// Strong expressions one after the other.
    fn show_strongly(&mut self, share: f32) {
        let all = [
            &mut self.jaw,
            &mut self.smile,
            &mut self.brows,
            &mut self.pucker,
        ];
        let turn = (ROUNDS * share).fract() * all.len() as f32;
        for (k, weight) in all.into_iter().enumerate() {
            let since = turn - k as f32;
            let shown = smoothstep(0.0, 0.3, since) * (1.0 - smoothstep(0.7, 1.0, since));
            *weight = 0.3 * *weight + 0.7 * shown;
        }
    }
}

/// To one side, to the other and back as `share` goes from 0 to 1, nearly at an even speed.
fn there_and_back(share: f32) -> f32 {
    /// How sharp the turning points are; 1 is an even speed.
    const SHARP: f32 = 0.95;
    (SHARP * (TAU * share).sin()).asin() / SHARP.asin()
}

fn cover(kind: Kind, t: f32) -> f32 {
    match kind.cover() {
        Some(cover) if cover.is_worn_throughout() => 1.0,
        Some(_) => {
            let gone = COVER_S + COMES_S + STAYS_S;
            smoothstep(COVER_S, COVER_S + COMES_S, t) * (1.0 - smoothstep(gone, gone + COMES_S, t))
        }
        None => 0.0,
    }
}
