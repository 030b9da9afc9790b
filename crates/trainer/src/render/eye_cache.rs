//! Rendered eyes on disk: a file of pictures with the truth of both eyes, appended to, so that an
//! interrupted run goes on where it stopped.
//!
//! A record is its length, width, height, floats and luma, little-endian. An incomplete record at
//! the end is drawn again.

use super::cache::{append, complete, floats, next_record, record};
use super::eye_truth::EyeTruth;
use super::sample::{Renderer, Sample};
use super::spec::SampleSpec;
use crate::picture::Picture;
use anyhow::{Context, Result, ensure};
use glam::{Mat3, Vec2, Vec3};
use posewise::math::head_rotation;
use posewise::shape::{ANIMATION_NAMES, Intrinsics};
use std::fs::{File, OpenOptions};
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

/// First landmark of the image left's and of the image right's eye.
pub const FIRST: [usize; 2] = [36, 42];
/// Floats of an eye, and of a record.
const EYE: usize = 12 + 3 + 3 + 2 + 5;
const FLOATS: usize = 2 * EYE + 9 + 3 + 4;

/// An eye of a picture.
#[derive(Clone)]
pub struct Eye {
    /// The picture that shows it.
    pub picture: Arc<Picture>,
    /// 0 at the image left, the person's right eye; 1 at the image right.
    pub side: usize,
    /// Its six landmarks \[px\].
    pub landmarks: [Vec2; 6],
    /// Where it looks.
    pub truth: EyeTruth,
    /// Weight with which its lids are shut.
    pub blink: f32,
    /// Head to camera.
    pub rotation: Mat3,
    /// The head's origin, camera axes \[mm\].
    pub position: Vec3,
    /// The camera.
    pub camera: Intrinsics,
}

fn numbers(sample: &Sample, truth: &[EyeTruth; 2]) -> Vec<f32> {
    let weight = |name: &str| {
        let at = ANIMATION_NAMES.iter().position(|n| *n == name);
        at.map_or(0.0, |at| sample.animation[at])
    };
    let blinks = [weight("eyeBlinkRight"), weight("eyeBlinkLeft")];
    let mut out = Vec::with_capacity(FLOATS);
    for ((first, eye), blink) in FIRST.iter().zip(truth).zip(blinks) {
        let points = &sample.landmarks[*first..first + 6];
        out.extend(points.iter().flat_map(|p| p.to_array()));
        out.extend(eye.centre.to_array());
        out.extend(eye.gaze.to_array());
        out.extend(eye.iris.to_array());
        out.extend([eye.seen, eye.lens, eye.glare, eye.hidden, blink]);
    }
    out.extend(head_rotation(sample.angles).to_cols_array());
    out.extend(sample.position.to_array());
    let c = sample.camera;
    out.extend([c.fx, c.fy, c.cx, c.cy]);
    out
}

fn encode(sample: &Sample, truth: &[EyeTruth; 2]) -> Vec<u8> {
    let mut body = Vec::new();
    body.extend((sample.width as u16).to_le_bytes());
    body.extend((sample.height as u16).to_le_bytes());
    let numbers = numbers(sample, truth);
    numbers.iter().for_each(|f| body.extend(f.to_le_bytes()));
    body.extend(&sample.luma);
    record(&body)
}

fn decode(body: &[u8]) -> Result<[Eye; 2]> {
    let (head, rest) = body
        .split_at_checked(4 + 4 * FLOATS)
        .context("a record is too short")?;
    let side = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]) as u32;
    let size = [side(0), side(2)];
    ensure!(
        rest.len() == (size[0] * size[1]) as usize,
        "a record's luma"
    );
    let picture = Arc::new(Picture {
        size,
        luma: rest.to_vec(),
    });
    let f = floats(&head[4..]);
    let common = &f[2 * EYE..];
    Ok([0, 1].map(|side| {
        let own = &f[side * EYE..][..EYE];
        Eye {
            picture: picture.clone(),
            side,
            landmarks: std::array::from_fn(|i| Vec2::from_slice(&own[2 * i..])),
            truth: EyeTruth {
                centre: Vec3::from_slice(&own[12..]),
                gaze: Vec3::from_slice(&own[15..]),
                iris: Vec2::from_slice(&own[18..]),
                seen: own[20],
                lens: own[21],
                glare: own[22],
                hidden: own[23],
            },
            blink: own[24],
            rotation: Mat3::from_cols_slice(common),
            position: Vec3::from_slice(&common[9..]),
            camera: Intrinsics::new(common[12], common[13], common[14], common[15]),
        }
    }))
}

/// The eyes of a sample.
pub fn eyes_of(sample: &Sample, truth: &[EyeTruth; 2]) -> [Eye; 2] {
    let record = encode(sample, truth);
    decode(&record[4..]).expect("a record is what was encoded")
}

/// Fills a file up to `count` samples.
pub fn write(
    path: &Path,
    renderer: &Renderer,
    seed: u64,
    count: u64,
    spec: &SampleSpec,
) -> Result<()> {
    let mut options = OpenOptions::new();
    let file = options.create(true).read(true).append(true).open(path);
    let file = file.with_context(|| format!("cannot write {}", path.display()))?;
    let (present, end) = complete(&mut BufReader::new(&file))?;
    file.set_len(end)?;
    append(file, "eyes", present..count, |index| {
        let rendered = renderer.render(seed, index, spec);
        encode(&rendered.sample, &rendered.eyes)
    })
}

/// All eyes of a file, of at most `limit` pictures.
pub fn read(path: &Path, limit: usize) -> Result<Vec<Eye>> {
    let file = File::open(path).with_context(|| format!("reading {}", path.display()))?;
    let mut file = BufReader::new(file);
    let records = std::iter::from_fn(|| next_record(&mut file).transpose());
    let pairs = records.take(limit).map(|body| decode(&body?));
    Ok(pairs.collect::<Result<Vec<_>>>()?.into_flattened())
}
