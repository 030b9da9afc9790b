//! Head pose, 68 facial landmarks and ARKit animation weights from camera frames.
//!
//! The library uses no heap, no threads, no operating system and no clock. The caller owns all
//! memory, and the work of each step is bounded.
//!
//! A [`Tracker`] follows one face. Each [`Tracker::step`] takes a checked [`Model`], one camera
//! [`Frame`] and its timestamp, and returns a [`TrackResult`]:
//!
//! ```
//! use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};
//!
//! # fn main() -> Result<(), Box<dyn core::error::Error>> {
//! let model = Model::load(posewise::DEFAULT_MODEL)?;
//! let mut tracker = Box::new(Tracker::new(&Config::default())?);
//!
//! // One frame of 8-bit luma; this one shows no face.
//! let pixels = [128; 320 * 240];
//! let frame = Frame::new(&FrameLayout::grey(320, 240), &pixels)?;
//! let timestamp_us = 33_333;
//!
//! let result = tracker.step(&model, &frame, timestamp_us)?;
//! if result.state == State::Tracking {
//!     println!("yaw {:.1} deg, pitch {:.1} deg", result.yaw_deg, result.pitch_deg);
//!     println!("tip of the nose at {:?}", result.landmarks[30]);
//! }
//! # assert_eq!(result.state, State::Searching);
//! # Ok(())
//! # }
//! ```
//!
//! `examples/` has two whole programs: one reads a picture, the other a video.
//!
//! # Models
//!
//! `DEFAULT_MODEL` is embedded by the feature `default-model`. Another model is embedded with
//! [`Aligned`], or read from a file into an `AlignedBytes` (feature `alloc`): a model must start at
//! a multiple of 64 bytes. [`ModelInfo`] has its name and its terms, and [`ModelError`] what is
//! wrong with one.
//!
//! # Modules
//!
//! The items below are the stable interface, with the modules [`eyes`], [`monitor`] and `ffi`. The
//! other modules are public with the feature `unstable-internals`; what they contain may change in
//! any release, patch releases included. A module uses only modules of lower layers.
//!
//! | layer | module | content |
//! |---|---|---|
//! | 0 | `math` | fixed-point helpers, similarity transforms, rotations, small solvers |
//! | 0 | `record` | what was learnt as bytes, with version and checksum |
//! | 1 | `image` | frame views over the caller's bytes, luma, warps into a small crop |
//! | 2 | `network` | integer convolutional networks |
//! | 2 | `shape` | the 3D face, projection, POSIT, the bounded pose fit |
//! | 3 | `detect` | the multi-view face detector, whose scan is split over steps |
//! | 3 | `align` | the cascade: from a crop to 68 landmarks |
//! | 3 | `verifier` | calibrated probabilities of the face and of each landmark |
//! | 3 | `keyframe` | past views of the tracked face, by which it is re-acquired |
//! | 4 | `track` | the state machine Searching, Tracking, Coasting |
//! | 5 | `monitor` | driver monitoring from results and timestamps: closures, PERCLOS, glances |
//! | 6 | `ffi` | the C ABI |
//!
//! The model file is read by the crate `posewise-format`.
#![no_std]
#![deny(missing_docs)]
#![deny(unsafe_code)]
#![warn(clippy::too_many_lines)]

// Each module is declared twice: rustfmt does not find modules that a macro declares.
#[cfg(feature = "unstable-internals")]
pub mod align;
#[cfg(not(feature = "unstable-internals"))]
mod align;
#[cfg(feature = "unstable-internals")]
pub mod detect;
#[cfg(not(feature = "unstable-internals"))]
mod detect;
#[cfg(feature = "unstable-internals")]
pub mod image;
#[cfg(not(feature = "unstable-internals"))]
mod image;
#[cfg(all(feature = "keyframes", feature = "unstable-internals"))]
pub mod keyframe;
#[cfg(all(feature = "keyframes", not(feature = "unstable-internals")))]
mod keyframe;
#[cfg(feature = "unstable-internals")]
pub mod math;
#[cfg(not(feature = "unstable-internals"))]
mod math;
#[cfg(feature = "monitor")]
pub mod monitor;
#[cfg(feature = "unstable-internals")]
pub mod network;
#[cfg(not(feature = "unstable-internals"))]
mod network;
mod record;
#[cfg(feature = "unstable-internals")]
pub mod shape;
#[cfg(not(feature = "unstable-internals"))]
mod shape;
#[cfg(feature = "unstable-internals")]
pub mod track;
#[cfg(not(feature = "unstable-internals"))]
mod track;
#[cfg(feature = "unstable-internals")]
pub mod verifier;
#[cfg(not(feature = "unstable-internals"))]
mod verifier;

#[cfg(feature = "ffi")]
pub mod ffi;

pub use image::{Frame, FrameError, FrameLayout, MAX_SIDE, PixelFormat, Roi, Rotation};
pub use network::set_dotprod;
pub use posewise_format::{Aligned, ModelError, ModelInfo, ModelTerms};
pub use record::RecordError;
pub use shape::{
    ANIMATION_NAMES, ANIMATIONS, Distortion, IDENTITY_RECORD_BYTES, Intrinsics, LANDMARKS, Likeness,
};
pub use track::{
    Config, ConfigError, Detected, EVENTS, Event, EventKind, EventLog, EventRing, FaceHint,
    FoundFace, Group, Landmark, Loss, MAX_EXCLUDED, MAX_GROUP, Model, Smoothing, State, StepError,
    TrackResult, Tracker, is_same_face,
};

/// What a result says of the eyes: lids, glasses, gaze.
pub mod eyes {
    pub use crate::track::{EYE_LOOK_NAMES, EYE_LOOKS, Eye, EyeUnknown, Eyes, Gaze};
}

/// The dense mesh of the tracked face: [`Tracker::mesh`], [`Tracker::mesh_shape`],
/// [`Model::mesh_topology`].
#[cfg(feature = "mesh")]
pub mod mesh {
    pub use crate::shape::{MAX_VERTICES, MeshLine, MeshTopology, MeshVertex};
    pub use crate::track::{MeshError, MeshShape, MeshSpace};
}

#[cfg(feature = "alloc")]
pub use posewise_format::AlignedBytes;

/// The optional parts, by the names of their features, and whether this build has them.
pub const PARTS: [(&str, bool); 5] = [
    ("refiners", cfg!(feature = "refiners")),
    ("keyframes", cfg!(feature = "keyframes")),
    ("monitor", cfg!(feature = "monitor")),
    ("default-model", cfg!(feature = "default-model")),
    ("mesh", cfg!(feature = "mesh")),
];

#[cfg(feature = "default-model")]
static DEFAULT: &Aligned<[u8]> = &Aligned(*include_bytes!(concat!(
    env!("OUT_DIR"),
    "/posewise.posewise"
)));

/// The model that ships with the crate: models/posewise.posewise, without the sections that this
/// build does not read.
#[cfg(feature = "default-model")]
pub static DEFAULT_MODEL: &[u8] = &DEFAULT.0;
