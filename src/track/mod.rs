//! What lives across frames: the state machine Searching / Tracking / Coasting.

mod answer;
mod config;
mod model;
mod motion;
mod place;
mod result;
mod search;
mod smooth;
mod subject;
mod tracker;

pub use config::{Config, ConfigError};
pub use model::Model;
pub use result::{Landmark, Loss, State, TrackResult};
pub use smooth::Smoothing;
pub use tracker::{StepError, Tracker};
