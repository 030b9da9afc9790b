//! One keyframe: the pose, landmarks and keypoints of an earlier view of a face.

use super::Shape;
use super::descriptor::{Descriptor, split};
use crate::shape::LANDMARKS;

/// Most keypoints of a keyframe.
pub const KEYFRAME_POINTS_MAX: usize = 32;

/// Units of an offset on a keyframe \[1/px\]: 4 bits after the point.
const Q4: f32 = 16.0;

/// A keypoint of a face; the keyframe has the first bits of its descriptor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// The others.
    pub tail: [u32; 6],
    /// From the face's centre \[1/16 px of the reduced image\].
    pub offset_q4: [i16; 2],
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
    /// The first 64 bits of each point's descriptor, side by side: they are compared in vectors.
    pub heads: [u64; KEYFRAME_POINTS_MAX],
    /// Which points are darker than their surroundings, a bit for each.
    dark: u32,
}

// Each point has a bit.
const _: () = assert!(KEYFRAME_POINTS_MAX == u32::BITS as usize);

impl Keyframe {
    pub const FREE: Keyframe = Keyframe {
        bin: 0,
        identity: 0,
        used: 0,
        quality: 0.0,
        roll: 0.0,
        shape_q4: [[0; 2]; LANDMARKS],
        points: heapless::Vec::new(),
        heads: [0; KEYFRAME_POINTS_MAX],
        dark: 0,
    };

    pub fn is_free(&self) -> bool {
        self.points.is_empty()
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.points.clear();
        self.dark = 0;
    }

    /// Adds a point, where there is space for it.
    pub fn push(&mut self, descriptor: &Descriptor, offset: [f32; 2], is_dark: bool) {
        let number = self.points.len();
        let (head, tail) = split(descriptor);
        let offset_q4 = offset.map(q4);
        if self.points.push(Point { tail, offset_q4 }).is_ok()
            && let Some(place) = self.heads.get_mut(number)
        {
            *place = head;
            self.dark |= u32::from(is_dark) << number;
        }
    }

    /// A bit for each point that is dark, or for each that is not.
    pub fn points_that_are(&self, dark: bool) -> u32 {
        let all = u32::MAX.checked_shr(u32::BITS - self.points.len() as u32);
        let chosen = if dark { self.dark } else { !self.dark };
        all.unwrap_or(0) & chosen
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
