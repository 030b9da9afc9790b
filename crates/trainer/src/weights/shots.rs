//! Pictures of rendered people with mixtures of all weights, on disk.

use super::outputs::{NAMES, SEEN};
use crate::picture::Picture;
use crate::render::expression::Expression;
use crate::render::sample::Rendered;
use crate::render::{Persons, Renderer, SampleSpec};
use anyhow::{Context, Result};
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use posewise::shape::{FITTED, FITTED_NAMES, Intrinsics, LANDMARKS};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

/// Pictures of each person.
pub const PICTURES: u64 = 10;
/// Of this number of persons one has a head of MakeHuman's.
const MAKEHUMAN: u64 = 4;
/// What MakeHuman's heads have under a name that is only near to it.
const UNCERTAIN: [&str; 4] = [
    "mouthPressLeft",
    "mouthPressRight",
    "mouthShrugLower",
    "mouthShrugUpper",
];

/// Floats of a record.
const FLOATS: usize = 2 * LANDMARKS + 4 + SEEN + FITTED;

/// One picture of a person.
pub struct Shot {
    /// Who it is.
    pub person: u32,
    /// What is seen.
    pub picture: Picture,
    /// Landmarks \[px\].
    pub landmarks: [[f32; 2]; LANDMARKS],
    /// The camera.
    pub camera: Intrinsics,
    /// Weights of [`NAMES`], and the fitted ones.
    pub seen: [f32; SEEN],
    /// See `seen`.
    pub fitted: [f32; FITTED],
}

/// What the pictures show of a person.
pub fn spec(person: u64) -> SampleSpec {
    SampleSpec {
        face_px: (60.0, 180.0),
        margin: 0.25,
        yaw_deg: 50.0,
        inner_share: 0.75,
        pitch_deg: 22.0,
        roll_deg: 18.0,
        occluders: 0.04,
        glasses: 0.15,
        long_hair: 0.15,
        caps: 0.03,
        masks: 0.0,
        closing: 0.0,
        odd_eyes: 0.03,
        infrared: 0.1,
        defects: 0.6,
        persons: Persons::Procedural,
        makehuman: f64::from(u8::from(person.is_multiple_of(MAKEHUMAN))),
        panoramas: crate::render::PANORAMAS,
        ..SampleSpec::default()
    }
}

/// The expression of a picture of a person. The first is neutral more often than not.
pub fn expression(seed: u64, person: u64, index: u64) -> Expression {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x3e16_475e);
    rng.set_stream((person << 16) + index);
    if index == 0 && rng.random_bool(0.6) {
        return Expression::default();
    }
    let mut face = Expression::mixed(&mut rng);
    if person.is_multiple_of(MAKEHUMAN) {
        face.leave_out(&UNCERTAIN);
    }
    face
}

impl Shot {
    /// Of a rendered person.
    pub fn new(person: u32, rendered: Rendered) -> Shot {
        let sample = rendered.sample;
        Shot {
            person,
            picture: Picture {
                size: [sample.width as u32, sample.height as u32],
                luma: sample.luma,
            },
            landmarks: sample.landmarks.map(|p| p.to_array()),
            camera: sample.camera,
            seen: NAMES.map(|name| rendered.expression.weight(name)),
            fitted: FITTED_NAMES.map(|name| rendered.expression.weight(name)),
        }
    }

    /// The weight of a name; 0 where there is none of it.
    pub fn weight(&self, name: &str) -> f32 {
        let fitted = FITTED_NAMES.iter().zip(&self.fitted);
        let mut all = fitted.chain(NAMES.iter().zip(&self.seen));
        all.find(|(n, _)| **n == name).map_or(0.0, |(_, w)| *w)
    }

    fn encode(&self) -> Vec<u8> {
        let [width, height] = self.picture.size;
        let mut out = Vec::new();
        [self.person, width, height]
            .iter()
            .for_each(|v| out.extend(v.to_le_bytes()));
        let c = self.camera;
        let floats = self.landmarks.as_flattened().iter().copied();
        let floats = floats.chain([c.fx, c.fy, c.cx, c.cy]);
        let floats = floats.chain(self.seen).chain(self.fitted);
        floats.for_each(|v| out.extend(v.to_le_bytes()));
        out.extend(&self.picture.luma);
        out
    }

    /// The first of these records, and the rest.
    fn decode(bytes: &[u8]) -> Option<(Shot, &[u8])> {
        let (head, rest) = bytes.split_at_checked(12 + 4 * FLOATS)?;
        let words = head.as_chunks::<4>().0;
        let [person, width, height] = [0, 1, 2].map(|k| u32::from_le_bytes(words[k]));
        let f: Vec<f32> = words[3..].iter().map(|w| f32::from_le_bytes(*w)).collect();
        let (luma, rest) = rest.split_at_checked((width * height) as usize)?;
        let (points, f) = f.split_at(2 * LANDMARKS);
        let shot = Shot {
            person,
            picture: Picture {
                size: [width, height],
                luma: luma.to_vec(),
            },
            landmarks: *points.as_chunks::<2>().0.first_chunk()?,
            camera: Intrinsics::new(f[0], f[1], f[2], f[3]),
            seen: *f[4..].first_chunk()?,
            fitted: *f[4 + SEEN..].first_chunk()?,
        };
        Some((shot, rest))
    }
}

/// Renders a number of persons into a file.
pub fn write(path: &Path, renderer: &Renderer, seed: u64, persons: u64) -> Result<()> {
    let style = ProgressStyle::with_template("weights {bar:40} {pos}/{len} {per_sec} eta {eta}")?;
    let bar = ProgressBar::new(persons * PICTURES).with_style(style);
    let records: Vec<Vec<u8>> = (0..persons * PICTURES)
        .into_par_iter()
        .progress_with(bar)
        .map(|number| {
            let (person, index) = (number / PICTURES, number % PICTURES);
            let expression = expression(seed, person, index);
            let rendered = renderer.portray([seed, person, index], &spec(person), &expression);
            Shot::new(person as u32, rendered).encode()
        })
        .collect();
    std::fs::write(path, records.concat()).with_context(|| format!("writing {}", path.display()))
}

/// Reads them.
pub fn read(path: &Path) -> Result<Vec<Shot>> {
    let bytes = std::fs::read(path).with_context(|| format!("reading {}", path.display()))?;
    let (mut shots, mut rest) = (Vec::new(), &bytes[..]);
    while let Some((shot, after)) = Shot::decode(rest) {
        shots.push(shot);
        rest = after;
    }
    Ok(shots)
}
