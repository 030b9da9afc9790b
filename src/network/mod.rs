//! A small convolutional network in integers: learned local features of a crop.
//!
//! In: a canonical [`crate::image::Crop`]. Out: maps of `u8` features, laid out
//! `[height][width][channels]`. Weights are `i8` (one scale per output channel), sums `i32`, and a
//! sum becomes the next layer's `u8` by an integer multiplication and two shifts, so every machine
//! gives the same bytes. Layers and their sizes come from the model; [`Network::read`] checks them
//! once, after which a run can neither fail nor leave its [`Activations`].

mod kernel;
mod layer;
mod plan;

/// Most channels of a map whose values are read as the features of a place.
pub const MAX_FEATURES: usize = 48;

pub(crate) use kernel::dot;
pub use layer::Activations;
pub use plan::{
    ARENA, MAX_CHANNELS, MAX_COLUMNS, MAX_NODES, MAX_WEIGHTS, Map, Network, OP_ADD, OP_CONV,
    OP_DEPTHWISE, OP_INPUT, OP_LATERAL, OP_LINEAR,
};
