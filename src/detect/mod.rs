//! The multi-view face detector: a time-sliced scan straight over the frame's luma.

/// A face candidate: a square that is turned with the head.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detection {
    /// Centre of the (upright) box around the 68 landmarks \[px\].
    pub x: f32,
    /// Centre \[px\].
    pub y: f32,
    /// Side of the square: the larger of the width and the height of that box \[px\].
    pub size: f32,
    /// In-plane rotation of the head, clockwise in the image \[rad\].
    pub roll: f32,
    /// Sign and rough amount of yaw, −1 (turned to the image left) to 1 (right).
    pub turn: f32,
    /// Confidence; higher is better, 0 is the working threshold.
    pub score: f32,
}
