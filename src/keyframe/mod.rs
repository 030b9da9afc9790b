//! Keyframes: faces as they were once, by which a lost one is found again (thesis 4.2).

mod descriptor;
mod find;
mod picture;
mod points;
mod table;

pub use find::{Found, Wanted};
pub use picture::BYTES;
pub use points::KEYPOINTS;
pub use table::{KEYFRAMES, Keyframes, POINTS, Seen};

use crate::shape::LANDMARKS;

/// 68 points.
type Shape = [[f32; 2]; LANDMARKS];

/// How wide a face is in the reduced picture \[px\].
pub const FACE_PX: f32 = 64.0;
