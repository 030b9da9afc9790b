//! The 3D face: mean, identity and animation modes, perspective projection, POSIT and the bounded
//! pose fit.

/// Landmarks of the iBUG 68 scheme; "left" and "right" are the subject's.
pub const LANDMARKS: usize = 68;

/// Animation modes in the order of every weight array; ARKit's blendshape names.
pub const ANIMATION_NAMES: [&str; ANIMATIONS] = [
    "browDownLeft",
    "browDownRight",
    "browInnerUp",
    "browOuterUpLeft",
    "browOuterUpRight",
    "eyeBlinkLeft",
    "eyeBlinkRight",
    "eyeWideLeft",
    "eyeWideRight",
    "jawOpen",
    "jawLeft",
    "jawRight",
    "mouthFunnel",
    "mouthPucker",
    "mouthSmileLeft",
    "mouthSmileRight",
    "mouthFrownLeft",
    "mouthFrownRight",
    "mouthStretchLeft",
    "mouthStretchRight",
    "mouthUpperUpLeft",
    "mouthUpperUpRight",
    "mouthLowerDownLeft",
    "mouthLowerDownRight",
];

/// Number of animation modes.
pub const ANIMATIONS: usize = 24;

/// Most identity modes a model may have.
pub const MAX_IDENTITIES: usize = 32;

/// A pinhole camera without distortion \[px\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length along x.
    pub fx: f32,
    /// Focal length along y.
    pub fy: f32,
    /// Principal point.
    pub cx: f32,
    /// Principal point.
    pub cy: f32,
}

impl Intrinsics {
    /// The default: a 60° horizontal field of view, principal point in the middle.
    pub fn of_frame(width: i32, height: i32) -> Self {
        // 1 / (2·tan 30°)
        let f = width as f32 * 0.866_025_4;
        Intrinsics {
            fx: f,
            fy: f,
            cx: (width - 1) as f32 / 2.0,
            cy: (height - 1) as f32 / 2.0,
        }
    }
}
