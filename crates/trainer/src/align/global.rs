//! Trains the networks of the global stage (sections `ALGN` and `ENSM`).

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
use posewise_format::SectionWriter;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;

/// Trains section `ALGN` on these faces; goes on from the checkpoint if there is one.
pub fn cascade(faces: &[Face], options: &Options, checkpoint: &Path) -> Result<SectionWriter> {
    let mean = mean_shape(faces);
    let starts = StartShapes::fit(faces, &mean, &options.turns);
    let (trained, samples) = network(faces, &mean, options, checkpoint)?;
    quantize::face_section(&trained, &mean, &starts, options.iterations, &samples)
}

/// Trains section `ENSM`, the ensemble member of a global stage of the same faces; goes on from the
/// checkpoint if there is one.
pub fn ensemble_member(
    faces: &[Face],
    options: &Options,
    checkpoint: &Path,
) -> Result<SectionWriter> {
    let (trained, samples) = network(faces, &mean_shape(faces), options, checkpoint)?;
    quantize::ensemble_section(&trained, &samples)
}

/// A network of the global stage, and samples as it meets them.
fn network(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    checkpoint: &Path,
) -> Result<(Trained, Vec<Sample>)> {
    let source = Faces {
        faces,
        mean,
        options,
        draw: Draw::new(faces, options, |_| 1.0)?,
    };
    let trained = train(&source, options, checkpoint, None)?;
    let rng = &mut ChaCha8Rng::seed_from_u64(options.seed ^ 2);
    let samples = source.samples(EXAMPLES, rng);
    Ok((trained, samples))
}
