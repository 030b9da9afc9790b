//! Trains the cascade (section `ALGN`).

pub mod correction;
pub mod cover;
pub mod evaluate;
mod graph;
mod mean;
mod network;
pub mod parts;
mod quantise;
pub mod relabel;
mod samples;
mod starts;
mod train;

pub use evaluate::{Accuracy, Boxes, evaluate, evaluate_float};
pub use mean::{align as mean_aligned, mean_shape};
pub use network::{Network, Sizes};
pub use samples::{Augment, Start};
pub(crate) use starts::normal;
pub use starts::{Jitter, StartShapes, jittered_box, start_from_box};
pub use train::{Options, Trained, train};

use crate::faces::Face;
use crate::fit::AlignedBlob;
use crate::pack::{SectionWriter, blob};
use anyhow::Result;
use posewise::align::{AlignModel, Parts};
use posewise::model::Blob;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;
use train::Source;

/// Crops that show how large the maps' values grow.
const EXAMPLES: usize = 512;

/// Opens a cascade that is being made: its global stage, and fine ones where there are some.
pub fn with_model<T>(
    global: &SectionWriter,
    parts: Option<&SectionWriter>,
    run: impl FnOnce(&AlignModel<'_>) -> Result<T>,
) -> Result<T> {
    let both = [Some(global), parts];
    let sections: Vec<SectionWriter> = both.into_iter().flatten().cloned().collect();
    let bytes = AlignedBlob::new(&blob(&sections));
    let opened = Blob::open(bytes.bytes())?;
    run(&AlignModel::open(&opened, Parts::open(&opened)?)?)
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
    let source = train::Faces {
        faces,
        mean: &mean,
        options,
        draw: train::Draw::new(faces, options, |_| 1.0)?,
    };
    let trained = train(&source, options, checkpoint, initial.map(|t| t.parameters))?;
    let examples = source.crops(EXAMPLES, &mut ChaCha8Rng::seed_from_u64(options.seed ^ 2));
    quantise::face_section(&trained, &mean, &starts, options.passes, &examples)
}
