//! Trains the cascade (section `ALGN`).

pub mod evaluate;
mod graph;
mod mean;
mod network;
mod quantise;
mod samples;
mod starts;
mod train;

pub use evaluate::{Accuracy, evaluate};
pub use mean::mean_shape;
pub use network::{Network, Sizes};
pub use quantise::section;
pub use samples::{Augment, Start};
pub(crate) use starts::normal;
pub use starts::{Jitter, StartShapes, face_box, start_from_box};
pub use train::{Options, Trained, train};

use crate::faces::Face;
use crate::pack::SectionWriter;
use anyhow::Result;
use std::path::Path;

/// Crops that show how large the maps' values grow.
const EXAMPLES: usize = 512;

/// Trains section `ALGN` on these faces; goes on from the checkpoint if there is one.
pub fn cascade(faces: &[Face], options: &Options, checkpoint: &Path) -> Result<SectionWriter> {
    let mean = mean_shape(faces);
    let starts = StartShapes::fit(faces, &mean, &options.turns);
    let trained = train(faces, &mean, options, checkpoint)?;
    let examples = train::examples(faces, &mean, options, EXAMPLES)?;
    section(&trained, &mean, &starts, options.passes, &examples)
}
