//! Trains section `WGHT`: animation weights that the 3D face has no modes for, from what the
//! refiners' networks see.
//!
//! Rendered people show mixtures of all weights (`shots`). What the last heads of the refiners read
//! is reduced to a few numbers by ridge regression (`views`); then a tracker with these numbers is
//! shown each person's pictures, one after the other, and a small network learns the weights from
//! what it is given (`network`). What is the same on all pictures of a person counts little: the
//! tracker takes the face at rest off.

mod network;
mod outputs;
mod section;
mod shots;
mod tracked;
mod views;

pub use outputs::{Figures, Options};
pub use section::train;
pub use shots::{PICTURES, Shot, expression, read, spec, write};
pub use tracked::{go_on, show};
