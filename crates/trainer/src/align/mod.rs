//! Trains the cascade (sections `ALGN`, `ENSM`, `RFIN` and `SREG`).

pub mod correction;
pub mod cover;
pub mod evaluate;
mod graph;
mod mean;
mod narrow;
mod network;
pub mod parts;
mod quantise;
pub mod relabel;
mod samples;
mod starts;
mod train;

pub use evaluate::{Accuracy, Boxes, evaluate, evaluate_float};
pub use mean::{align as mean_aligned, mean_shape};
pub use narrow::MODES;
pub use network::{Network, Sizes};
pub use samples::{Augment, Start};
pub(crate) use starts::normal;
pub use starts::{Jitter, StartShapes, jittered_box, start_from_box};
pub use train::{Options, Trained, train};

use crate::faces::Face;
use crate::fit::AlignedBlob;
use crate::pack::{SectionWriter, blob};
use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember, Refiners, Shape};
use posewise::model::Blob;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use samples::Sample;
use std::path::Path;
use train::Source;

/// Samples that show how large the maps' values grow and where answers move points.
const EXAMPLES: usize = 2048;

/// Opens a cascade that is being made: the sections of its global stage, and fine ones where there are
/// some.
pub fn with_model<T>(
    sections: &[&SectionWriter],
    run: impl FnOnce(&AlignModel<'_>) -> Result<T>,
) -> Result<T> {
    let sections: Vec<SectionWriter> = sections.iter().copied().cloned().collect();
    let bytes = AlignedBlob::new(&blob(&sections));
    let opened = Blob::open(bytes.bytes())?;
    run(&AlignModel::open(
        &opened,
        EnsembleMember::open(&opened)?,
        Refiners::open(&opened)?,
    )?)
}

/// Trains section `ALGN` on these faces; goes on from the checkpoint if there is one, else starts
/// from what the network of another checkpoint has learnt.
pub fn cascade(
    faces: &[Face],
    options: &Options,
    checkpoint: &Path,
    taught_by: Option<&Path>,
) -> Result<SectionWriter> {
    let mean = mean_shape(faces);
    let starts = StartShapes::fit(faces, &mean, &options.turns);
    let initial = taught_by.and_then(|path| Trained::read(path, &options.sizes));
    let (trained, samples) = network(faces, &mean, options, checkpoint, initial)?;
    quantise::face_section(&trained, &mean, &starts, options.passes, &samples)
}

/// Trains section `ENSM`, a second network for a global stage with this mean shape; goes on from the
/// checkpoint if there is one.
pub fn second(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    checkpoint: &Path,
) -> Result<SectionWriter> {
    let (trained, samples) = network(faces, mean, options, checkpoint, None)?;
    quantise::second_section(&trained, &samples)
}

/// A network of the global stage, and samples as it meets them.
fn network(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    checkpoint: &Path,
    initial: Option<Trained>,
) -> Result<(Trained, Vec<Sample>)> {
    let source = train::Faces {
        faces,
        mean,
        options,
        draw: train::Draw::new(faces, options, |_| 1.0)?,
    };
    let trained = train(&source, options, checkpoint, initial.map(|t| t.parameters))?;
    let rng = &mut ChaCha8Rng::seed_from_u64(options.seed ^ 2);
    let samples = source.samples(EXAMPLES, rng);
    Ok((trained, samples))
}
