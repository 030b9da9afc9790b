//! Labels that training can trust more than the annotator's: what a trained cascade predicts,
//! averaged over several attempts at the same face and its mirror image.
//!
//! A photograph's own label and the cascade's prediction err independently enough that their mean
//! is closer to the truth than either; faces without labels get the cascade's prediction, if its
//! attempts agree.

use super::evaluate::start_of;
use super::starts::{jittered_box, start_from_box};
use crate::faces::{Face, Picture};
use anyhow::Result;
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::shape::{LANDMARKS, MIRROR};
use posewise_metrics::BoxJitter;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// Attempts at a face, half of them in the mirror.
const ATTEMPTS: usize = 8;
/// Where attempts start from, around the answer before them.
const AROUND: BoxJitter = BoxJitter {
    shift: 0.03,
    log_size: 0.05,
    roll: 0.08,
};
/// Passes after which a face in a picture without labels is where it belongs.
const SETTLED: usize = 4;
/// Share of the cascade's prediction in a photograph's new label.
const SHARE: f32 = 0.5;
/// Largest mean distance of the attempts from their mean \[% of the scale\] at which a face without
/// a label is kept.
const AGREEMENT: f32 = 3.0;

/// Mean of the attempts, and their mean distance from it \[px\].
fn attempts(
    model: &AlignModel<'_>,
    face: &Face,
    mirror: &Face,
    seed: u64,
    work: &mut Workspace,
) -> Option<(Shape, f32)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let last = face.picture.size[0] as f32 - 1.0;
    let mut shapes: Vec<Shape> = vec![];
    for k in 0..ATTEMPTS {
        let face = if k % 2 == 0 { face } else { mirror };
        let views = model.views();
        let (at, size, roll) = jittered_box(&views, &face.landmarks, &AROUND, &mut rng);
        let mut shape = start_from_box(&start_of(model, face.turn()), at, size, roll);
        if !model.run(&face.picture.frame(), 2, &mut shape, work) {
            return None;
        }
        if k % 2 == 1 {
            shape = MIRROR.map(|from| [last - shape[from][0], shape[from][1]]);
        }
        shapes.push(shape);
    }
    let n = shapes.len() as f32;
    let mean: Shape =
        std::array::from_fn(|i| [0, 1].map(|k| shapes.iter().map(|s| s[i][k]).sum::<f32>() / n));
    let apart = |s: &Shape| -> f32 {
        let pairs = s.iter().zip(&mean);
        pairs
            .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
            .sum::<f32>()
            / LANDMARKS as f32
    };
    let spread = shapes.iter().map(apart).sum::<f32>() / n;
    Some((mean, spread))
}

/// Photographs with labels half way between the annotator's and the cascade's.
pub fn blended(model: &AlignModel<'_>, faces: &[Face]) -> Vec<Face> {
    faces
        .par_iter()
        .enumerate()
        .map_init(
            || Box::new(Workspace::new()),
            |work, (index, face)| {
                let mut face = face.clone();
                if let Some((mean, _)) =
                    attempts(model, &face, &face.mirrored(), index as u64, work)
                {
                    for (label, own) in face.landmarks.iter_mut().zip(mean) {
                        for k in 0..2 {
                            label[k] += SHARE * (own[k] - label[k]);
                        }
                    }
                }
                face
            },
        )
        .collect()
}

/// Faces in pictures without labels: one in the middle of each, as wide as two fifths of the
/// picture. Those on which the attempts do not agree are left out; also returns how many.
pub fn found(model: &AlignModel<'_>, folder: &Path) -> Result<(Vec<Face>, usize)> {
    let paths = Picture::list(folder)?;
    let faces = paths
        .par_iter()
        .enumerate()
        .map_init(
            || Box::new(Workspace::new()),
            |work, (index, path)| {
                let picture = Arc::new(Picture::read(path)?);
                let [w, h] = picture.size.map(|s| s as f32);
                let (centre, size) = ([0.5 * w, 0.53 * h], 0.4 * w);
                let mut shape = start_from_box(&start_of(model, 0.0), centre, size, 0.0);
                if !model.run(&picture.frame(), SETTLED, &mut shape, work) {
                    return Ok(None);
                }
                let mut face = Face {
                    picture,
                    landmarks: shape,
                    person: u32::MAX,
                    yaw_deg: None,
                    weight: 1.0,
                    visible: [true; LANDMARKS],
                };
                let mirror = face.mirrored();
                let Some((mean, spread)) = attempts(model, &face, &mirror, index as u64, work)
                else {
                    return Ok(None);
                };
                face.landmarks = mean;
                let agreed = 100.0 * spread < AGREEMENT * face.scale();
                Ok(agreed.then_some(face))
            },
        )
        .collect::<Result<Vec<_>>>()?;
    let all = faces.len();
    let kept: Vec<Face> = faces.into_iter().flatten().collect();
    let dropped = all - kept.len();
    Ok((kept, dropped))
}
