//! The verifier: is it a face, which landmarks are right, and which are visible?
//!
//! In: the local features of the cascade's last iteration. Out: calibrated probabilities
//! ([`Confidence`]). Builds without the feature `verifier` derive a confidence from the fit of the
//! 3D face instead (`geometry.rs`).

#[cfg(feature = "verifier")]
mod classifiers;
mod confidence;
#[cfg(not(feature = "verifier"))]
mod geometry;

#[cfg(feature = "verifier")]
pub use classifiers::Verifier;
#[cfg(all(feature = "verifier", feature = "unstable-internals"))]
pub use classifiers::first_prediction;
pub use confidence::Confidence;
#[cfg(not(feature = "verifier"))]
pub use geometry::{Verifier, geometric_confidence};
