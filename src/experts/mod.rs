//! Truth or guess: is this a face, and which landmarks sit where they should?
//!
//! In: the local features that the cascade's last pass ended with. Out: calibrated probabilities.

mod verifier;

pub use verifier::{Verdict, Verifier};
