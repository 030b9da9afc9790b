//! The cascade: frame and a first guess in, 68 landmarks out.
//!
//! The global stage cuts a crop that is upright and of canonical size for the guess and describes it
//! by the maps of a small convolutional network ([`crate::network`]), the learned local features. A
//! first answer comes from the coarsest map as a whole; each correction then reads the fine map at
//! the 68 points where the answer before it put them, and all points' features together move all
//! points, so that landmarks that are well placed correct their neighbours (coarse-to-fine
//! correlative regression, thesis 5.1; shape-indexed features as in Cao et al. 2014). A model may have
//! a second network that sees the crop in a mirror, and the two answers are averaged. Fine stages of the
//! same kind then see eyes with brows, the mouth and the lids closer by. From pixels to the sums
//! that make an answer everything is integer arithmetic. In the end the whole shape corrects each of
//! its points.
//!
//! A guess matters only through the similarity transform that brings the mean shape onto it: a pass
//! that starts from its own answer does not drift.
//!
//! The *canonical frame* is that of the mean shape: origin at its centroid, upright, unit such that
//! the model's `zoom` turns it into crop pixels.

mod cascade;
mod ensemble;
mod placement;
mod refiners;
mod regressor;
mod shape_regression;
mod views;

pub use cascade::{AlignModel, MAX_VIEWS, Workspace};
pub use ensemble::EnsembleMember;
pub use placement::{Placement, mirror, place};
pub use refiners::{MAX_POINTS, MAX_REFINERS, Refiners, placed};
pub use regressor::{GLOBAL, MAX_HEADS, MAX_INPUTS, MAX_RANK, SHAPE_INDEXED};
pub use shape_regression::{ShapeRegression, deviation};
pub use views::{View, Views};

use crate::shape::LANDMARKS;

/// 68 points.
pub type Shape = [[f32; 2]; LANDMARKS];
