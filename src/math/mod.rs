//! Layer 0: the little mathematics that every room shares.
//!
//! Fixed-point helpers, 2D similarity transforms, head rotations and a small dense solver. Floats
//! are `f32` with `libm` only, so results are the same bits on every machine.

mod fixed;
mod rotation;
mod similarity;
mod solve;

pub use fixed::{isqrt, sigmoid};
pub use rotation::{HeadAngles, head_angles, head_rotation, rotation_of};
pub use similarity::Similarity;
pub use solve::solve_spd;
