//! Truth or guess: is this a face, which landmarks sit where they should, and which are seen?
//!
//! In: the local features that the cascade's last pass ended with. Out: calibrated probabilities,
//! bettered by what the person's own landmarks look like ([`Person`], feature `adaptation`).
//! Builds without the feature `experts` have [`geometry`](by_fit) instead, which has neither.

#[cfg(not(feature = "experts"))]
mod geometry;
mod person;
mod verdict;
#[cfg(feature = "experts")]
mod verifier;

#[cfg(not(feature = "experts"))]
pub use geometry::{Verifier, by_fit};
pub use person::Person;
pub use verdict::Verdict;
#[cfg(feature = "experts")]
pub use verifier::{Verifier, first_answer};
