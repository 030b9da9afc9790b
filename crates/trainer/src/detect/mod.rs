//! Trains section `DTCT`: a convolutional network that finds faces in tiles.
//!
//! In: pictures of faces with boxes, and pictures without people ([`pictures`], from [`faces`] and
//! [`backgrounds`]). Out: a [`SectionWriter`](posewise_format::SectionWriter).
//!
//! [`maker`] composes random tiles and the answers that the network is to give ([`tile`]), with
//! [`paste`] and [`disturb`]. [`network`] is the network in `f32`, a chain of [`layer`]s, forwards
//! and backwards, on the inner loops of [`loops`]; [`normalise`] puts batch normalisation into its
//! training. [`training`] descends the gradient of [`loss`], with a [`state`] that is kept.
//! [`equalise`] and [`quantize`] write the section, and [`section`] does all of it.

pub mod backgrounds;
pub mod disturb;
pub mod equalise;
pub mod faces;
pub mod finished;
pub mod layer;
pub mod loops;
pub mod loss;
pub mod maker;
pub mod network;
pub mod normalise;
mod options;
pub mod paste;
pub mod pictures;
pub mod quantize;
pub mod section;
pub mod state;
pub mod tile;
pub mod training;

pub use options::Options;
pub use section::train;
