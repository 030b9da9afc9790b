//! What the fit estimates of a face in one frame.

use super::{Animation, FITTED, Identity, MAX_IDENTITIES, Pose};
use glam::{Mat3, Vec3};

/// Pose, animation and identity of a face in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceState {
    /// Pose of the head.
    pub pose: Pose,
    /// The fitted weights of [`super::ANIMATION_NAMES`], 0..1.
    pub animation: Animation,
    /// Identity weights \[standard deviations\].
    pub identity: Identity,
}

impl FaceState {
    /// All zero; not a valid pose.
    pub const EMPTY: FaceState = FaceState {
        pose: Pose {
            rotation: Mat3::ZERO,
            translation_mm: Vec3::ZERO,
        },
        animation: [0.0; FITTED],
        identity: [0.0; MAX_IDENTITIES],
    };

    /// Whether it is of a face, not [`FaceState::EMPTY`].
    pub fn is_fitted(&self) -> bool {
        self.pose.rotation != Mat3::ZERO
    }
}
