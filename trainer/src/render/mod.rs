//! Rendered faces: a morphable head with procedural or photographed skin, lit and drawn at poses,
//! expressions and under conditions that photographs lack, with exact landmarks.
//!
//! ```text
//! head ─► mesh ─┬─► expression, identity ─► draw (raster, light, texture, props) ─► effects ─► Sample
//!               ├─► people (skin, photo)       over a background
//!               └─► contour: the 68 points in the photographs' convention
//! ```

pub mod background;
pub mod contour;
pub mod draw;
pub mod effects;
pub mod expression;
pub mod light;
pub mod mesh;
pub mod noise;
pub mod people;
pub mod props;
pub mod raster;
pub mod sample;
pub mod skin;
pub mod texture;

pub use people::{People, Persons};
pub use sample::{Renderer, Sample, SampleSpec};
