//! Hard negatives: windows without a face that pass the cascade trained so far.

use posewise::detect::{Detection, Window};
use posewise::image::Frame;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::cascade::{Cascade, Flat};
use super::faces::Face;
use super::options::rng_for;
use super::sample::{PATCH, cut, disturb, window};
use crate::picture::Picture;

/// Windows tried by one task, and tasks that run before the yield is checked.
const TRIES: usize = 20_000;
const TASKS: usize = 32;
/// Tries on a picture before the next is drawn: its pixels are then in the cache.
const TRIES_ON_PICTURE: usize = 200;
/// Share of tries around labelled faces (parts of faces, hair, shoulders), and their largest share
/// (one in so many) of the windows that pass: they pass far more often than backgrounds, and
/// merging hits corrects them anyway.
const AROUND_FACES: f64 = 0.04;
const AROUND_KEPT: usize = 5;

/// Pictures in which negatives are searched.
pub struct Ground<'a> {
    backgrounds: Vec<Picture>,
    faces: &'a [Face],
}

impl<'a> Ground<'a> {
    /// Backgrounds as they are, blurred, and at half size; and the surroundings of faces.
    pub fn new(backgrounds: &[Picture], faces: &'a [Face]) -> Self {
        let backgrounds = backgrounds
            .par_iter()
            .flat_map_iter(|b| [b.clone(), b.clone(), b.blurred(1), b.halved(), b.blurred(2)])
            .collect();
        Ground { backgrounds, faces }
    }
}

/// The result of mining.
pub struct Mined {
    /// Patches, one after the other.
    pub patches: Vec<u8>,
    pub tried: usize,
    pub passed: usize,
}

/// Up to `wanted` patches that pass, out of at most `tries` windows.
pub fn mine(
    ground: &Ground<'_>,
    cascade: &Cascade,
    wanted: usize,
    tries: usize,
    seed: u64,
    stage: u64,
) -> Mined {
    let mut mined = Mined {
        patches: Vec::new(),
        tried: 0,
        passed: 0,
    };
    let nodes = cascade.flat();
    let mut task = 0;
    while mined.tried < tries && mined.passed < wanted {
        let found: Vec<(usize, Vec<u8>)> = (task..task + TASKS)
            .into_par_iter()
            .map(|t| {
                let mut rng = rng_for(seed, 0x4D49_4E45 + stage, t as u64);
                let mut patches = Vec::new();
                let (mut tried, mut around, mut picture) = (0, 0, 0);
                for _ in 0..TRIES {
                    if tried % TRIES_ON_PICTURE == 0 {
                        picture = rng.random_range(0..ground.backgrounds.len());
                    }
                    tried += 1;
                    // One task must not fill the set alone.
                    if patches.len() >= PATCH * wanted.div_ceil(TASKS / 2).max(8) {
                        break;
                    }
                    let before = patches.len();
                    let beside = rng.random_bool(AROUND_FACES);
                    if beside && around > patches.len() / PATCH / AROUND_KEPT {
                        continue;
                    }
                    let place = if beside { None } else { Some(picture) };
                    attempt(ground, &nodes, place, &mut rng, &mut patches);
                    around += usize::from(beside && patches.len() > before);
                }
                (tried, patches)
            })
            .collect();
        for (tried, patches) in found {
            mined.tried += tried;
            mined.passed += patches.len() / PATCH;
            mined.patches.extend(patches);
        }
        task += TASKS;
    }
    mined.patches.truncate(wanted * PATCH);
    mined
}

fn attempt(
    ground: &Ground<'_>,
    nodes: &Flat,
    picture: Option<usize>,
    rng: &mut ChaCha8Rng,
    patches: &mut Vec<u8>,
) {
    let (frame, window) = if let Some(picture) = picture {
        let picture = &ground.backgrounds[picture];
        (picture.frame(), window(&anywhere(picture, rng)))
    } else {
        let face = &ground.faces[rng.random_range(0..ground.faces.len())];
        match beside(face, rng) {
            Some(at) => (face.picture.frame(), window(&at)),
            None => return,
        }
    };
    let window = if rng.random_bool(0.5) {
        window.mirrored()
    } else {
        window
    };
    if nodes.passes(&frame, &window) {
        take(&frame, &window, nodes, rng, patches);
    }
}

/// Adds the patch, sometimes disturbed as faces are, if it then still passes.
fn take(
    frame: &Frame<'_>,
    window: &Window,
    nodes: &Flat,
    rng: &mut ChaCha8Rng,
    patches: &mut Vec<u8>,
) {
    let start = patches.len();
    cut(frame, window, patches);
    if rng.random_bool(0.3) {
        let before = patches[start..].to_vec();
        disturb(&mut patches[start..], rng, false);
        if !nodes.passes_patch(&patches[start..]) {
            patches[start..].copy_from_slice(&before);
        }
    }
}

/// A window of any size at any place of a picture.
fn anywhere(picture: &Picture, rng: &mut ChaCha8Rng) -> Detection {
    let [width, height] = picture.size.map(|side| side as f32 - 1.0);
    let size = rng
        .random_range(24.0f32.ln()..(width.min(height) * 0.95).ln())
        .exp();
    let margin = 0.3 * size;
    let quarter = if rng.random_bool(0.2) {
        rng.random_range(1..4) as f32
    } else {
        0.0
    };
    Detection {
        x: rng.random_range(margin..width - margin),
        y: rng.random_range(margin..height - margin),
        size,
        roll: rng.random_range(-0.85f32..0.85) + quarter * std::f32::consts::FRAC_PI_2,
        ..Detection::default()
    }
}

/// A window that touches the labelled face but is wrong in place, size or roll. Nothing further
/// away is taken: other people's faces are not labelled.
fn beside(face: &Face, rng: &mut ChaCha8Rng) -> Option<Detection> {
    let truth = &face.truth;
    let scale = rng.random_range(0.3f32.ln()..2.2f32.ln()).exp();
    let (dx, dy) = (
        rng.random_range(-1.1f32..1.1),
        rng.random_range(-1.1f32..1.3),
    );
    let turn = rng.random_range(-1.0f32..1.0);
    let turn = if rng.random_bool(0.15) {
        3.0 * turn
    } else {
        0.5 * turn
    };
    let far = dx.hypot(dy) > 0.55 * scale.max(0.8);
    let wrong = far || !(0.58..1.75).contains(&scale) || turn.abs() > 1.0;
    let size = truth.size * scale;
    let [width, height] = face.picture.size;
    let fits = size > 22.0 && size < width.min(height) as f32;
    (wrong && fits).then_some(Detection {
        x: truth.x + truth.size * dx,
        y: truth.y + truth.size * dy,
        size,
        roll: truth.roll + turn,
        ..Detection::default()
    })
}
