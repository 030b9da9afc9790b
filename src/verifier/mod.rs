//! Truth or guess: is this a face, which landmarks sit where they should, and which are seen?
//!
//! In: the local features that the cascade's last pass ended with. Out: calibrated probabilities,
//! bettered by what the person's own landmarks look like ([`Appearance`], feature `adaptation`).
//! Builds without the feature `experts` have [`geometry`](by_fit) instead, which has neither.

mod appearance;
#[cfg(feature = "verifier")]
mod classifiers;
mod confidence;
#[cfg(not(feature = "verifier"))]
mod geometry;

pub use appearance::Appearance;
#[cfg(feature = "verifier")]
pub use classifiers::{Verifier, first_prediction};
pub use confidence::Confidence;
#[cfg(not(feature = "verifier"))]
pub use geometry::{Verifier, by_fit};
