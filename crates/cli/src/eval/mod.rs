//! `posewise eval`: accuracy against labelled data. `*_metrics` are the formulas, without files;
//! `recovery`, `latency`, `faceless` and `drift` make their clips in memory and show them to a
//! tracker.

mod angle_metrics;
pub mod angles;
pub mod backgrounds;
pub mod camera;
mod ced;
mod clips;
mod cut;
pub mod deviations;
pub mod drift;
pub mod eyes;
pub mod faceless;
mod gaze_metrics;
pub mod jitter;
pub mod landmark_metrics;
pub mod landmarks;
pub mod latency;
pub mod monitor;
pub mod monitor_metrics;
pub mod pose;
pub mod pose_metrics;
mod profile_metrics;
pub mod profiles;
pub mod recovery;
pub mod registration;
pub mod show;
mod spans;
mod still;
pub mod table;
pub mod turned;
