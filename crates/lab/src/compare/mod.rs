//! The trackers of the thesis as comparators, beside posewise.
//!
//! ```text
//! person, render ─► synthesis ─► gaussian | view_based | sparse ─► scorer ─► bayes ─► follow
//! follow ─► trackers ─► track
//! trackers, systems, measures ─► comparison ─► table
//! ```
//!
//! All start alike: posewise finds the landmarks of the first face, the 3D face is fitted to them,
//! and the frame is put on its mesh and drawn from other poses. Then each follows the clip alone.
//! They have no detector and no way back: the state of the frame before is where they search.

mod bayes;
mod comparison;
mod descriptor;
mod follow;
mod gaussian;
mod measures;
mod person;
mod picture;
mod render;
mod scorer;
mod settings;
mod sparse;
mod state;
mod synthesis;
mod systems;
mod table;
mod track;
mod trackers;
mod view_based;

pub use comparison::{Clip, Comparison, Selection};
pub use measures::{Row, Sums, counts, nme, signed, size};
pub use table::{Args as TableArgs, MergeArgs, run as run_table, run_merge};
pub use track::{Args as TrackArgs, run as run_track};
