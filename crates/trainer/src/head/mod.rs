//! The morphable head that everything 3D is derived from.
//!
//! Millimetres in the head frame: origin midway between the eyeball centres, x right as the camera
//! sees it (the subject's left), y down, z away from the camera, nose along −z.

mod contour;
mod convention;
pub mod makehuman;
mod marks;
mod morphable;
pub mod npz;
mod wfm;

pub use contour::{BELOW_MM, at_place, even_places, outward};
pub use convention::{CONVENTION_VERSION, conventional_mm};
pub use makehuman::MakeHuman;
pub use marks::{Labels, MARKS_VERSION, MESH_MARKS_VERSION, marks_mm, marks_px};
pub use morphable::{Expression, Head};
pub use wfm::{Unit, Wfm};
