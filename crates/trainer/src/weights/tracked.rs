//! Persons' pictures shown to a tracker, one after the other.

use super::outputs::{Row, targets};
use super::shots::Shot;
use anyhow::{Context, Result};
use posewise::detect::Detection;
use posewise::image::{Frame, FrameLayout};
use posewise::shape::LANDMARKS;
use posewise::track::{Config, Model, State, Tracker};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Frames of each picture in training.
const FRAMES: usize = 3;
/// Largest mean error of the inner landmarks, of the box's side.
const MOST_OFF: f32 = 0.04;

/// The box of the landmarks as a detector would report it.
fn box_of(landmarks: &[[f32; 2]; LANDMARKS], rng: &mut ChaCha8Rng) -> Detection {
    let fold = |of: fn(f32, f32) -> f32, first: f32| {
        let mut out = [first; 2];
        for p in landmarks {
            out = [of(out[0], p[0]), of(out[1], p[1])];
        }
        out
    };
    let (low, high) = (fold(f32::min, f32::MAX), fold(f32::max, f32::MIN));
    let size = (high[0] - low[0]).max(high[1] - low[1]);
    let mut off = || rng.random_range(-0.04..0.04f32) * size;
    let [x, y] = [0, 1].map(|k| (low[k] + high[k]) / 2.0 + off());
    let size = size + off();
    let (from, to) = (landmarks[36], landmarks[45]);
    Detection {
        x,
        y,
        size,
        roll: (to[1] - from[1]).atan2(to[0] - from[0]),
        ..Detection::NONE
    }
}

/// Shows a picture for some frames; false where the face is not tracked where it is. The first
/// frame of the first picture is at time 0.
pub fn show(
    tracker: &mut Tracker,
    model: &Model<'_>,
    shot: &Shot,
    first_frame: usize,
    frames: usize,
    rng: &mut ChaCha8Rng,
) -> Result<bool> {
    let [width, height] = shot.picture.size;
    let layout = FrameLayout::grey(width, height);
    let frame = Frame::new(&layout, &shot.picture.luma)?;
    tracker
        .set_intrinsics(Some(shot.camera))
        .context("a camera")?;
    let at = box_of(&shot.landmarks, rng);
    for k in 0..frames {
        let time = 33_333 * (first_frame + k) as i64;
        match (k, first_frame) {
            (0, 0) => tracker.fit_at(model, &frame, time, &at)?,
            (0, _) => tracker.fit_again_at(model, &frame, time, &at)?,
            _ => tracker.step(model, &frame, time)?,
        };
    }
    let result = tracker.result();
    let off = (result.landmarks.iter().zip(&shot.landmarks).skip(17))
        .map(|(l, p)| (l.x - p[0]).hypot(l.y - p[1]));
    let mean = off.sum::<f32>() / (LANDMARKS - 17) as f32;
    Ok(result.state == State::Tracking && mean < MOST_OFF * at.size)
}

/// Shows the next frame of the picture that was shown last.
pub fn go_on(
    tracker: &mut Tracker,
    model: &Model<'_>,
    shot: &Shot,
    frame_number: usize,
) -> Result<()> {
    let [width, height] = shot.picture.size;
    let layout = FrameLayout::grey(width, height);
    let frame = Frame::new(&layout, &shot.picture.luma)?;
    tracker.step(model, &frame, 33_333 * frame_number as i64)?;
    Ok(())
}

/// What a tracker gives the network on each picture on which it tracks the face.
pub fn rows(model: &Model<'_>, shots: &[Shot]) -> Result<Vec<Row>> {
    let persons: Vec<&[Shot]> = shots.chunk_by(|a, b| a.person == b.person).collect();
    let rows: Vec<Vec<Row>> = persons
        .into_par_iter()
        .map(|shots| {
            let mut tracker = Box::new(Tracker::new(&Config::default())?);
            let mut rng = ChaCha8Rng::seed_from_u64(0x7a6c);
            rng.set_stream(shots[0].person.into());
            let mut rows = Vec::new();
            for (k, shot) in shots.iter().enumerate() {
                if show(&mut tracker, model, shot, k * FRAMES, FRAMES, &mut rng)? {
                    let plain = *tracker.weight_inputs();
                    rows.push(Row {
                        person: shot.person,
                        inputs: [plain, model.align().weights().mirrored(&plain)],
                        targets: [false, true].map(|left| targets(&shot.seen, left)),
                    });
                }
            }
            Ok(rows)
        })
        .collect::<Result<_>>()?;
    Ok(rows.into_iter().flatten().collect())
}
