//! Clips in memory, and pictures without people.

pub mod backgrounds;
pub mod clip;
