//! What lives across frames: the state machine Searching / Tracking / Holding.

mod model;
mod result;
mod tracker;

pub use model::Model;
pub use result::{Landmark, State, TrackResult};
pub use tracker::{Config, ConfigError, StepError, Tracker};
