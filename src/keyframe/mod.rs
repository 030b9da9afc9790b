//! Keyframes: faces as they were once, by which a lost one is found again (thesis 4.2).
//!
//! In: a frame on which the face is known, to be remembered; later a frame on which it is lost. Out:
//! where its landmarks should be now, if it looks as it did on one of the remembered frames. The
//! frame is reduced until the face is about 64 px wide ([`FACE_PX`]); keypoints are small spots,
//! brighter or darker than what is around them; each is described by 256 comparisons of pixels
//! (BRIEF), turned with the face. Keypoints of a keyframe are matched with those of now by the number
//! of differing bits, best against second best, and RANSAC finds the similarity transform on which
//! they agree. It moves the keyframe's landmarks to where the cascade then starts: the cascade needs
//! no more than that, and finds the pose by itself.
//!
//! There is one keyframe for each bin of yaw and pitch and each person; a table of fixed size holds
//! them. A face in a mirror is another person's. Memory, keypoints, comparisons
//! and rounds are bounded by constants; pixels and bits are integers, so every machine finds the same.

mod descriptor;
mod find;
mod picture;
mod points;
mod table;

pub use find::{KeyframeMatch, Query};
pub use picture::SCRATCH_BYTES;
pub use points::KEYPOINTS_MAX;
pub use table::{KEYFRAME_POINTS_MAX, KEYFRAMES_MAX, Keyframes, Observation};

use crate::shape::LANDMARKS;

#[cfg(test)]
mod testing;

/// 68 points.
type Shape = [[f32; 2]; LANDMARKS];

/// How wide a face is in the reduced picture \[px\].
pub const FACE_PX: f32 = 64.0;
