//! A small quantised convolutional network: learned local features of a crop.
//!
//! In: a canonical [`crate::image::Crop`]. Out: feature maps of `u8`, laid out
//! `[height][width][channels]`. Weights are `i8` with one scale per output channel, sums are `i32`.
//! A sum is requantised to the next layer's `u8` by an integer multiplication and two shifts (after
//! Jacob et al., CVPR 2018, without their rounding), so every machine gives the same bytes. The
//! model defines the layers; [`Network::open`] checks them once, after which a run cannot fail or
//! access memory outside its [`Activations`].

mod activations;
mod convolution;
mod kernel;
mod layer;
mod plan;

/// Capacity: channels of a map whose values are the features of a landmark.
pub const MAX_FEATURES: usize = 48;

pub use activations::Activations;
pub(crate) use kernel::dots;
pub use kernel::set_dotprod;
#[cfg(feature = "unstable-internals")]
pub use kernel::{KernelName, chosen_kernel, select_kernel};
#[cfg(any(feature = "keyframes", feature = "unstable-internals"))]
pub use plan::ARENA;
#[cfg(feature = "unstable-internals")]
pub use plan::{
    MAX_CHANNELS, MAX_NODES, OP_ADD, OP_CONV, OP_DEPTHWISE, OP_INPUT, OP_LATERAL, OP_LINEAR,
};
pub use plan::{Map, Network};
