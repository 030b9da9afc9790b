//! What is kept from frame to frame: the state machine Searching / Tracking / Coasting.
//!
//! A frame goes through these files:
//!
//! - `tracker` holds the API and the state machine; `step` its input, outcome and work budget.
//! - `hint` is a place that the caller proposes; `scan`, `reacquire` and `motion` propose others,
//!   by the detector, by keyframes, by the last frames.
//! - `scanner`, `reacquirer` and `rejected` hold what the search keeps between frames.
//! - `candidate` aligns and verifies a proposal; `accept` fits the 3D face; `target` and
//!   `appearance` hold what is known of the tracked face; `output` writes the result; `one_euro`
//!   smooths it; `event` and `record` log what happens to the face.
//! - `eyes` looks at the eyes of a tracked face when asked, `eye` holds what it sees.
//! - `detect` lists the faces of a frame; `excluded` holds those that other trackers follow.
//! - `policy` holds every threshold, timeout and work cost.

mod accept;
mod align;
mod alignment;
mod anchor;
mod appearance;
mod candidate;
mod config;
mod detect;
mod error;
mod event;
mod excluded;
mod eye;
mod eyes;
mod geometry;
mod glasses;
mod hint;
mod model;
mod motion;
mod natural_gaze;
mod one_euro;
mod output;
mod policy;
mod reacquire;
mod reacquirer;
mod record;
mod rejected;
mod result;
mod scan;
mod scanner;
mod step;
mod target;
mod tracker;

pub use config::{Config, ConfigError, MAX_EXCLUDED, Smoothing};
pub use detect::{Detected, FoundFace};
pub use error::StepError;
pub use event::{EVENTS, Event, EventKind, EventLog};
pub use eye::{EYE_LOOK_NAMES, EYE_LOOKS, Eye, EyeUnknown, Eyes, Gaze};
pub use geometry::is_same_face;
pub use hint::FaceHint;
pub use model::Model;
pub use result::{Landmark, Loss, State, TrackResult};
pub use tracker::Tracker;
