//! posewise: one camera frame in; 6-DoF head pose, 68 landmarks and facial animation out.
//!
//! No heap, no threads, no OS, no clock: the caller owns every byte, and each step's work is
//! bounded. The rooms, in the order in which a frame passes through them:
//!
//! | layer | room | what happens there |
//! |---|---|---|
//! | 0 | [`math`] | fixed-point helpers, similarity transforms, rotations, small solvers |
//! | 1 | [`image`] | frame views over the caller's bytes, luma, the warp into a canonical crop |
//! | 2 | [`network`] | learned local features of a crop |
//! | 2 | [`shape`] | the 3D face, projection, POSIT, the bounded pose fit |
//! | 3 | [`detect`] | the multi-view face scan, time-sliced |
//! | 3 | [`align`] | the cascade on learned features: crop → 68 landmarks |
//! | 3 | [`verifier`] | is it a face, which landmarks are right: calibrated probabilities |
//! | 3 | [`keyframe`] | faces as they were once, to find a lost one again by |
//! | 4 | [`track`] | Searching / Tracking / Coasting: what lives across frames |
//! | 5 | `ffi` | the C ABI |
//!
//! ```no_run
//! # fn frame() -> posewise::image::Frame<'static> { unimplemented!() }
//! use posewise::track::{Config, Model, Tracker};
//! let model = Model::load(posewise::DEFAULT_MODEL).expect("the embedded model is valid");
//! let mut tracker = Tracker::new(&Config::default()).expect("the defaults are valid");
//! let result = tracker.step(&model, &frame(), 33_333).expect("time goes forward");
//! println!("{:?} yaw {:.1}", result.state, result.yaw_deg);
//! ```
#![no_std]
#![deny(missing_docs)]
#![deny(unsafe_code)]

pub mod align;
pub mod detect;
pub mod image;
#[cfg(feature = "keyframes")]
pub mod keyframe;
pub mod math;
pub mod network;
pub mod shape;
pub mod track;
pub mod verifier;

pub use posewise_format as model;

#[cfg(any(feature = "ffi", test))]
pub mod ffi;

#[cfg(feature = "default-model")]
static DEFAULT: &model::Aligned<[u8]> = &model::Aligned(*include_bytes!(concat!(
    env!("OUT_DIR"),
    "/default.posewise"
)));

/// The model that ships with the crate (`models/default.posewise`, without the sections that this
/// build does not read), 64-byte aligned.
#[cfg(feature = "default-model")]
pub static DEFAULT_MODEL: &[u8] = &DEFAULT.0;
