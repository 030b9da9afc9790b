//! What `posewise track --csv` wrote against per-frame truth. Nothing is tracked here.
//!
//! ```text
//! pairs ─► truth, tables ─► *_metrics, spans, registration (the formulas) ─► figures
//! ```

pub mod deviations;
pub mod eyes;
mod gaze_metrics;
mod glance_metrics;
pub mod identities;
pub mod jitter;
pub mod monitor;
mod monitor_metrics;
mod pairs;
mod passenger_metrics;
pub mod pose;
pub mod pose_metrics;
mod registration;
mod spans;

pub use pairs::ClipsArgs;
