//! Truth or guess: is this a face, which landmarks sit where they should, and which are seen?
//!
//! In: the local features that the cascade's last pass ended with. Out: calibrated probabilities.

mod verifier;

pub use verifier::{Verdict, Verifier, first_answer};
