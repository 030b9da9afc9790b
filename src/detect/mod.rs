//! The multi-view face detector: a scan of the frame's luma in calls of bounded work.
//!
//! In: a [`Frame`](crate::image::Frame) and the model's section `DTCT`. Out: one [`Detection`] at a
//! time, the largest face first.
//!
//! A window is evaluated by soft cascades of boosted trees whose nodes compare two pixels (Markuš
//! et al., "Object detection with pixel intensity comparisons organized in decision trees", 2013).
//! The [`GRID`] of pixels to compare is scaled and rotated with the window, so there is no pyramid,
//! no integral image and no copy of the frame. Overlapping hits are merged (`cluster`); a small
//! regression forest on the same comparisons then moves the merged window onto the face
//! ([`refine`]).
//!
//! Arithmetic is integer up to the merged window. [`Scan`] holds all state in fixed memory, so a
//! scan of the frame can be spread over as many calls as the caller likes.

mod cluster;
mod evaluate;
mod forest;
mod grid;
mod local_search;
mod model;
mod refine;
mod scan;
mod window;

pub use grid::{GRID, Pixel};
pub use local_search::local_search;
pub use model::{
    BoxRefiner, DetectorModel, ENSEMBLES_MAX, Ensemble, REFINE_OUTPUTS, ROLLS_MAX, TAG,
};
pub use refine::refine;
pub use scan::{Scan, ScanOutcome, Sizes};
pub use window::Window;

/// A face candidate: a square in the upright frame, rotated with the head.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detection {
    /// Centre of the bounding box of the 68 landmarks, taken along the rotated axes \[frame px\].
    pub x: f32,
    /// Centre \[frame px\].
    pub y: f32,
    /// Side of the square: the larger of the width and the height of that box \[frame px\].
    pub size: f32,
    /// In-plane rotation of the head, clockwise in the image \[rad\].
    pub roll: f32,
    /// Rough yaw in units of 90°: −1 (turned to the image's left) to 1 (right).
    pub yaw: f32,
    /// Detector score, not a probability: higher is better, 0 is the working threshold.
    pub score: f32,
}
