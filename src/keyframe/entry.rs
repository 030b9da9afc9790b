//! One keyframe: the pose, landmarks and keypoints of an earlier view of a face.

use super::Shape;
use super::descriptor::Descriptor;
use crate::shape::LANDMARKS;

/// Most keypoints of a keyframe.
pub const KEYFRAME_POINTS_MAX: usize = 32;

/// Units of an offset on a keyframe \[1/px\]: 4 bits after the point.
const Q4: f32 = 16.0;

/// A keypoint of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub descriptor: Descriptor,
    /// From the face's centre \[1/16 px of the reduced image\].
    pub offset_q4: [i16; 2],
    /// Whether it is darker than its surroundings.
    pub is_dark: bool,
}

impl Point {
    /// From the face's centre \[px of the reduced image\].
    pub fn offset(&self) -> [f32; 2] {
        self.offset_q4.map(|v| v as f32 / Q4)
    }
}

/// An earlier view of a face.
#[derive(Clone)]
pub(super) struct Keyframe {
    /// Bin of yaw and pitch, see `bin_of` of the table.
    pub bin: u8,
    pub identity: u32,
    /// When it was added or last matched, by the table's clock.
    pub used: u32,
    pub quality: f32,
    /// Clockwise in the image \[rad\].
    pub roll: f32,
    /// The landmarks, in the units of [`Point::offset_q4`].
    pub shape_q4: [[i16; 2]; LANDMARKS],
    /// None in a free entry.
    pub points: heapless::Vec<Point, KEYFRAME_POINTS_MAX, u8>,
}

impl Keyframe {
    pub const FREE: Keyframe = Keyframe {
        bin: 0,
        identity: 0,
        used: 0,
        quality: 0.0,
        roll: 0.0,
        shape_q4: [[0; 2]; LANDMARKS],
        points: heapless::Vec::new(),
    };

    pub fn is_free(&self) -> bool {
        self.points.is_empty()
    }

    /// The landmarks, from the face's centre \[px of the reduced image\].
    pub fn shape(&self) -> Shape {
        self.shape_q4.map(|p| p.map(|v| v as f32 / Q4))
    }
}

/// \[px\] in units of 1/16 px, rounded and clamped.
pub(super) fn q4(v: f32) -> i16 {
    libm::roundf((v * Q4).clamp(-32_000.0, 32_000.0)) as i16
}

/// A keyframe found in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyframeMatch {
    /// The keyframe's landmarks, moved to the frame \[frame px\].
    pub shape: Shape,
    /// Identity of the keyframe's face, as in [`Keyframes::identity`](super::Keyframes::identity).
    pub identity: u32,
    /// Keypoint matches that agree on the transform.
    pub inliers: usize,
    /// The keyframe's place in the table.
    pub entry: usize,
}
