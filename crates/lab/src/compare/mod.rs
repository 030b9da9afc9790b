//! The trackers of the thesis as comparators, beside posewise.
//!
//! ```text
//! face_model, person, render ─► synthesis ─► gaussian | view_based | sparse ─► scorer
//! scorer ─► bayes, keyframes ────────────────────────────────────────────────────────────┐
//! fit ─► head_cascade ─► own_errors ─► cascade_training ─► training                      │
//! training ─► svm | cascade ─► follower ◄────────────────────────────────────────────────┘
//! follower ─► follow ─► trackers ─► track
//! trackers, systems, measures ─► comparison ─► table
//! ```
//!
//! All start alike: posewise finds the landmarks of the first face, and the 3D face is fitted to
//! them. Then each follows the clip alone. Scorers put the first frame on the mesh and draw it from
//! other poses; `svm`, `cascade` and `hybrid` have learned from other faces beforehand. None has a
//! detector: the state of the frame before is where they search. `view-based`, `svm` and `hybrid`
//! also match keyframes.

mod bayes;
mod cascade;
mod cascade_training;
mod comparison;
mod descriptor;
mod face_model;
mod fit;
mod follow;
mod follower;
mod gaussian;
mod head_cascade;
mod keyframes;
mod measures;
mod own_errors;
mod person;
mod picture;
mod render;
mod scorer;
mod settings;
mod sparse;
mod state;
mod svm;
mod synthesis;
mod systems;
mod table;
mod track;
mod trackers;
mod training;
mod view_based;

#[cfg(test)]
mod tests;

pub use comparison::{Clip, Comparison, Selection};
pub use measures::{Row, Sums, counts, nme, signed, size};
pub use settings::{Method, Settings};
pub use table::{Args as TableArgs, run as run_table};
pub use track::{Args as TrackArgs, run as run_track};
pub use trackers::Trackers;
