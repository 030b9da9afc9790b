//! The cascade of quantised regressors: frame and a first guess in, 68 landmarks out.
//!
//! Supervised descent (Xiong and De la Torre 2013) as in the thesis, 5.1: each stage cuts a crop
//! that is upright and of canonical size for the current shape, describes it around the 68
//! current points, and moves the shape by a linear function of those features:
//! `x ← x + Q (R φ(x) + b)`, where Q spans similarity and shape modes in the canonical frame. R is
//! `i8`, one scale per output; everything from pixels to R's sums is integer arithmetic.
//!
//! A stage has one R per *view*, an amount of turn; left-turned faces are seen in a mirror, so that
//! both directions share one R.
//!
//! The *canonical frame* is that of the mean shape: origin at its centroid, upright, unit such that
//! the stage's `zoom` turns it into crop pixels.

mod cascade;
mod placement;
mod views;

pub use cascade::{AlignModel, MAX_MODES, MAX_STAGES, MAX_VIEWS, Regressor, Stage, Workspace};
pub use placement::{Placement, mirror, place};
pub use views::{View, Views};

use crate::shape::LANDMARKS;

/// 68 points.
pub type Shape = [[f32; 2]; LANDMARKS];
