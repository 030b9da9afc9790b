//! What is kept from frame to frame: the state machine Searching / Tracking / Coasting.
//!
//! A frame goes through these rooms, from the first to the last:
//!
//! - `tracker`: the interface, the state machine and the walk of a frame.
//! - `step`: what one step is given, why it may be refused, how much work it may do.
//! - `follow`: the target on the next frame. `target` is what is known of it; `motion` predicts its
//!   place, `appearance` and `anchor` compare its face and what surrounds it with earlier frames.
//! - `search`: the places that a step attempts. `scan` is that of the detector, `keyframes` are
//!   earlier views, `rejected` holds candidates to retry and where none is accepted; `faces` are
//!   those that the caller expects, or has listed.
//! - `align`: from a start to a candidate, and what the classifiers say of it; then its landmarks,
//!   refined.
//! - `verify`: whether a candidate may be a face.
//! - `fit`: the 3D face that explains them, which all that follows takes.
//! - `eyes`: lids, glasses and gaze of a fitted face; `learnt` is what many frames say of them,
//!   `result` what one result says.
//! - `weights`: animation weights that are seen, less those of the face at rest.
//! - `mesh`: the dense mesh of a fitted face, when it is asked for.
//! - `output`: what the caller gets. `result` is written of a fitted face, `one_euro` smooths it,
//!   `event` logs what happens to the face.
//!
//! `group` steps several trackers on the same frames.
//!
//! All of them use `config`, the settings; `model`, the checked sections; `policy`, every
//! threshold, timeout and work cost; and `geometry`, boxes and angles.

mod align;
mod config;
mod eyes;
mod fit;
mod follow;
mod geometry;
mod group;
#[cfg(feature = "mesh")]
mod mesh;
mod model;
mod output;
mod policy;
mod search;
mod step;
mod tracker;
mod verify;
mod weights;

pub use config::{Config, ConfigError, MAX_EXCLUDED, Smoothing};
pub use eyes::{EYE_LOOK_NAMES, EYE_LOOKS, Eye, EyeUnknown, Eyes, Gaze};
pub use geometry::is_same_face;
#[cfg(feature = "ffi")]
pub(crate) use group::Members;
pub use group::{Group, MAX_GROUP};
#[cfg(feature = "mesh")]
pub use mesh::{MeshError, MeshShape, MeshSpace};
pub use model::Model;
pub use output::{
    EVENTS, Event, EventKind, EventLog, EventRing, Landmark, Loss, State, TrackResult,
};
pub use search::{Detected, FaceHint, FoundFace};
pub use step::StepError;
pub use tracker::Tracker;
