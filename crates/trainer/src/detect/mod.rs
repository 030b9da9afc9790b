//! Trains section `DTCT`: soft cascades of pixel comparisons and the forest that refines a hit.
//!
//! In: faces with boxes, and backgrounds. Out: a [`SectionWriter`]. The order
//! is that of the files: [`faces`] and [`backgrounds`] are read into memory, [`sample`] cuts
//! augmented patches, [`boost`] grows trees on them, [`training`] alternates with [`mine`] for hard
//! negatives, [`refine`] fits the regression forest, [`calibrate`] sets the thresholds, [`pack`]
//! writes, and [`section`] does all of it.

pub mod backgrounds;
pub mod boost;
pub mod calibrate;
pub mod cascade;
pub mod faces;
pub mod mine;
mod options;
pub mod pack;
pub mod refine;
pub mod sample;
pub mod section;
pub mod training;

pub use options::{Options, SIDE_Q8};
pub use section::train;
