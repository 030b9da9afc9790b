//! The 3D face: mean, identity and animation modes, perspective projection, POSIT and the bounded
//! pose fit.

mod camera;
mod face;
mod fit;
mod identity;
mod linear;
mod posit;

pub use camera::{Intrinsics, Pose};
pub use face::{Contour, FACE_TAG, FIXED_CONTOUR, FaceModel, JAW, MAX_EXTRA, MAX_POINTS, Shape};
pub use face::{VIEW_AZIMUTHS, VIEW_BYTES, VIEW_ELEVATIONS, VIEW_STEP_DEG};
pub use fit::{FaceFit, FaceState, FitOptions, fit};
pub use identity::{FRAME_WEIGHT, IdentityEstimator};
pub use linear::Observed;
pub use posit::posit;

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

/// Weights of [`ANIMATION_NAMES`], 0..1.
pub type Animation = [f32; ANIMATIONS];

/// Identity weights in standard deviations; those beyond the model's number of modes are unused.
pub type Identity = [f32; MAX_IDENTITIES];
