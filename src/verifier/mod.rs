//! The verifier: is it a face, which landmarks are right, and which are visible?
//!
//! In: the local features of the cascade's last iteration. Out: calibrated probabilities
//! ([`Confidence`]).

mod classifiers;
mod confidence;

pub use classifiers::Verifier;
#[cfg(feature = "unstable-internals")]
pub use classifiers::first_prediction;
pub use confidence::Confidence;
