//! One person that can be rendered.

use super::skin::Painted;

/// A textured person.
pub struct Person {
    /// Photographed people are counted up in the order of their names, so all pictures of one
    /// share it; procedural people count down from `u32::MAX`.
    pub id: u32,
    /// Skin and hair.
    pub painted: Painted,
    /// Identity weights; empty where any head fits.
    pub identity: Vec<f32>,
    /// Iris albedo.
    pub iris: f32,
    /// Skin albedo.
    pub skin: f32,
    /// Albedo of the hair; `None`: bald.
    pub hair: Option<f32>,
    /// Albedo of the clothes.
    pub cloth: f32,
}
