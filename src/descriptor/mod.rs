//! Local features of a crop around the landmarks.
//!
//! In: a canonical [`crate::image::Crop`] and points in it. Out: one short vector of integers per
//! point. [`Hog`] makes the hand-crafted part (oriented gradients in overlapping cells);
//! [`Projection`] is the learned part that turns it into a few `i8` features. Everything here is
//! integer arithmetic.

mod hog;
mod projection;

pub use hog::{BINS, CELLS, Hog, HogGrid, VALUES};
pub use projection::{MAX_FEATURES, Projection};
