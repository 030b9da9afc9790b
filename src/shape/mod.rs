//! The 3D face model, perspective projection, POSIT, and the fit of pose, animation and identity.

mod camera;
mod deviation;
mod distortion;
mod face;
mod facing;
mod fit;
mod identity;
mod identity_record;
mod lids;
mod linear;
#[cfg(feature = "mesh")]
mod mesh;
mod modes;
mod posit;
mod rotation_prior;
mod state;
mod step;

pub(crate) use camera::{FARTHEST_MM, FOCAL_PX, NEAREST_MM, PIXEL_ASPECT, PRINCIPAL_PX};
pub use camera::{Intrinsics, Pose, Project};
pub(crate) use deviation::{Seen, Variances};
pub use distortion::Distortion;
pub use face::{Contour, FACE_TAG, FaceModel, Shape};
#[cfg(feature = "unstable-internals")]
pub use face::{FIXED_CONTOUR, JAW, MAX_EXTRA, MAX_POINTS};
#[cfg(feature = "unstable-internals")]
pub use face::{VIEW_AZIMUTHS, VIEW_BYTES, VIEW_ELEVATIONS, VIEW_STEP_DEG};
pub use fit::{FaceFit, FitOptions, fit};
pub use identity::{FRAME_WEIGHT, IdentityEstimator};
pub(crate) use identity_record::Guess;
pub use identity_record::{IDENTITY_RECORD_BYTES, Likeness};
#[cfg(feature = "monitor")]
pub(crate) use lids::SHUT;
pub use lids::eye_open;
pub use linear::Observed;
#[cfg(feature = "mesh")]
pub use mesh::{MAX_VERTICES, Mesh, MeshLine, MeshModel, MeshTopology, MeshVertex};
#[cfg(all(feature = "mesh", feature = "unstable-internals"))]
pub use mesh::{MESH_BLOCK, MESH_PULLS, MESH_RING, MESH_TAG, WHOLE_PULL};
#[cfg(feature = "unstable-internals")]
pub use posit::posit;
pub use rotation_prior::RotationPrior;
#[cfg(feature = "unstable-internals")]
pub use rotation_prior::rotation_vector;
pub use state::FaceState;

/// Number of landmarks: the iBUG 68 scheme. "Left" and "right" are the person's own.
pub const LANDMARKS: usize = 68;

/// For each landmark its mirror image on the other side of the face.
pub const MIRROR: [usize; LANDMARKS] = [
    16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 26, 25, 24, 23, 22, 21, 20, 19, 18,
    17, 27, 28, 29, 30, 35, 34, 33, 32, 31, 45, 44, 43, 42, 47, 46, 39, 38, 37, 36, 41, 40, 54, 53,
    52, 51, 50, 49, 48, 59, 58, 57, 56, 55, 64, 63, 62, 61, 60, 67, 66, 65,
];

/// Names of the animation weights, in the order of every weight array: ARKit's blendshape names.
/// The first 24 are those of the fit, the others those that are seen.
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
    "cheekPuff",
    "mouthClose",
    "mouthLeft",
    "mouthRight",
    "mouthRollLower",
];

/// Number of animation weights.
pub const ANIMATIONS: usize = 29;

/// Number of animation weights that the fit estimates with the pose: the modes of the 3D face.
pub const FITTED: usize = 24;

/// Names of the fitted weights.
#[cfg(feature = "unstable-internals")]
pub const FITTED_NAMES: [&str; FITTED] = match ANIMATION_NAMES.first_chunk() {
    Some(names) => *names,
    None => [""; FITTED],
};

/// For each fitted weight that of the other side of the face.
pub(crate) const FITTED_MIRROR: [usize; FITTED] = [
    1, 0, 2, 4, 3, 6, 5, 8, 7, 9, 11, 10, 12, 13, 15, 14, 17, 16, 19, 18, 21, 20, 23, 22,
];

/// Capacity: identity modes of a model.
pub const MAX_IDENTITIES: usize = 32;

/// The fitted weights of [`ANIMATION_NAMES`], 0..1.
pub type Animation = [f32; FITTED];

/// Identity weights \[standard deviations\]; those beyond the model's number of modes are unused.
pub type Identity = [f32; MAX_IDENTITIES];
