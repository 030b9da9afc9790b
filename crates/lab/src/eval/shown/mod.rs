//! Clips that are made in memory and shown to a tracker.
//!
//! ```text
//! footage (clips, backgrounds) ─► show (the tracker) ─► counts of frames ─► report
//! ```

pub mod drift;
pub mod faceless;
pub mod latency;
pub mod mesh;
mod mesh_picture;
pub mod recovery;
mod show;
pub mod turns;
pub mod weights;
