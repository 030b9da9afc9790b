//! Keyframes: earlier views of faces, by which a lost face is re-acquired (thesis 4.2).
//!
//! In: frames on which the face is known, of which keyframes are added; later a frame on which it
//! is lost, which is a query. Out: the landmarks of the best matching keyframe, moved to the frame.
//!
//! 1. The frame is reduced until the face is about 64 px wide ([`FACE_PX`]).
//! 2. Keypoints are spots, brighter or darker than their surroundings, found by the difference of
//!    two box filters.
//! 3. A keypoint is described by 256 pixel comparisons (BRIEF), rotated with the face.
//! 4. Keypoints of a keyframe and of the query are matched by Hamming distance with a ratio test.
//! 5. RANSAC finds the similarity transform on which most matches of a keyframe agree. It moves the
//!    keyframe's landmarks; from there the cascade aligns and finds the pose by itself.
//!
//! A table of fixed size holds one keyframe for each bin of yaw and pitch and each identity. A
//! mirrored face does not match: it is another identity. Memory, keypoints, comparisons and
//! iterations are bounded by constants. Pixels and descriptors are integers, so every machine finds
//! the same matches.

mod descriptor;
mod entry;
mod keypoints;
mod outline;
mod query;
mod ransac;
mod reduced_image;
mod table;

#[cfg(feature = "unstable-internals")]
pub use entry::{KEYFRAME_POINTS_MAX, KeyframeMatch};
pub use query::Query;
pub use reduced_image::SCRATCH_BYTES;
#[cfg(feature = "unstable-internals")]
pub use table::KEYFRAMES_MAX;
pub use table::{Keyframes, Observation};

use crate::shape::LANDMARKS;

#[cfg(test)]
mod testing;

/// The 68 landmarks.
type Shape = [[f32; 2]; LANDMARKS];

/// Width of a face in the reduced image \[px\].
pub const FACE_PX: f32 = 64.0;
