//! Layer 0: mathematics that all modules share.
//!
//! Scalar functions, 2D similarity transforms, head rotations and a small dense solver. Floats are
//! `f32`, and functions of them are `libm`'s, so results have the same bits on every machine.

mod fixed;
mod rotation;
mod similarity;
mod solve;
mod vector;

pub use fixed::{isqrt, sigmoid};
pub use rotation::{HeadAngles, head_angles, head_rotation, rotation_from_quaternion, towards};
pub use similarity::Similarity;
pub use solve::solve_spd;
pub use vector::{dot, sum};
