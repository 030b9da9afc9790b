//! Labelled pictures, each of which is a still for a fresh tracker.
//!
//! ```text
//! labels ─► cut, turned, camera ─► still (the tracker) ─► *_metrics (the formulas) ─► figures
//! ```

pub mod angle_metrics;
pub mod angles;
mod cut;
pub mod labels;
pub mod landmark_metrics;
pub mod landmarks;
pub mod people;
pub mod profile_metrics;
pub mod profiles;
mod still;
mod turned;
