//! Trains the networks of the global stage (sections `ALGN` and `ENSM`).

use super::finished;
use super::mean::mean_shape;
use super::options::Options;
use super::quantize;
use super::samples::{EXAMPLES, Sample};
use super::source::{Draw, Faces, Source};
use super::starts::StartShapes;
use super::train::{Trained, train};
use crate::faces::Face;
use anyhow::Result;
use posewise::align::Shape;
use posewise::shape::LANDMARKS;
use posewise_format::{Section, SectionWriter};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;

/// Trains section `ALGN` on these faces; goes on from the checkpoint if there is one, else from the
/// section `before`, whose mean and start shapes stay.
pub fn cascade(
    faces: &[Face],
    options: &Options,
    checkpoint: &Path,
    mut before: Option<Section<'_>>,
) -> Result<SectionWriter> {
    let (mean, starts) = match &mut before {
        Some(section) => shapes(section)?,
        None => {
            let mean = mean_shape(faces);
            let starts = StartShapes::fit(faces, &mean, &options.turns);
            (mean, starts)
        }
    };
    let (trained, samples) = network(faces, &mean, options, checkpoint, before)?;
    quantize::face_section(&trained, &mean, &starts, options.iterations, &samples)
}

/// Mean and start shapes of a section `ALGN`, whose network comes next.
pub fn shapes(s: &mut Section<'_>) -> Result<(Shape, StartShapes)> {
    let [turns, _iterations] = [s.u32()?, s.u32()?];
    let turns = turns as usize;
    let shape = |values: &[f32]| std::array::from_fn(|i| [values[2 * i], values[2 * i + 1]]);
    let mean = shape(s.f32s(2 * LANDMARKS)?);
    let shapes = s.f32s(2 * LANDMARKS * turns)?;
    let starts = StartShapes {
        shapes: shapes.chunks_exact(2 * LANDMARKS).map(shape).collect(),
        turns: s.f32s(turns)?.to_vec(),
    };
    Ok((mean, starts))
}

/// Trains section `ENSM`, the ensemble member of the global stage of section `ALGN` with this mean
/// shape; goes on from the checkpoint if there is one, else from the section `before`.
pub fn ensemble_member(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    checkpoint: &Path,
    before: Option<Section<'_>>,
) -> Result<SectionWriter> {
    let (trained, samples) = network(faces, mean, options, checkpoint, before)?;
    quantize::ensemble_section(&trained, &samples)
}

/// A network of the global stage, and samples as it meets them.
fn network(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    checkpoint: &Path,
    before: Option<Section<'_>>,
) -> Result<(Trained, Vec<Sample>)> {
    let source = Faces {
        faces,
        mean,
        options,
        draw: Draw::new(faces, options, |_| 1.0)?,
    };
    let before = before.map(|mut s| finished::parameters(&mut s, &options.sizes, options.seed));
    let trained = train(&source, options, checkpoint, before.transpose()?)?;
    let rng = &mut ChaCha8Rng::seed_from_u64(options.seed ^ 2);
    let samples = source.samples(EXAMPLES, rng);
    Ok((trained, samples))
}
