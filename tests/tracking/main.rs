//! How the library tracks, detects and monitors, by its Rust interface.

#[path = "../common/mod.rs"]
mod common;
mod detect;
mod events;
mod gaze;
mod group;
mod identity;
mod keyframe;
mod lens;
mod mesh;
mod models;
mod monitor;
mod serde;
mod several;
mod tracker;
mod weights;
mod work;
