//! The multi-view face detector: a time-sliced scan straight over the frame's luma.
//!
//! In: a [`Frame`](crate::image::Frame) and the section `DTCT` of the model. Out: at most one
//! [`Detection`], that of the largest face. A window is evaluated by soft cascades of boosted trees
//! whose nodes compare two pixels (Markuš et al., "Object detection with pixel intensity
//! comparisons organized in decision trees", 2013): no pyramid, no integral image, no copy of the
//! frame; the [`GRID`] of pixels to compare is scaled and turned with the window. Overlapping hits are
//! merged ([`cluster`]), and a small regression forest of the same comparisons then moves the
//! merged window onto the face ([`refine`]).
//!
//! Integers up to the merged window. [`Scan`] holds all state in fixed memory, so a sweep over
//! the frame can be spread over as many steps as the caller likes.

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

/// A face candidate: a square that is turned with the head.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detection {
    /// Centre of the (upright) box around the 68 landmarks \[px\].
    pub x: f32,
    /// Centre \[px\].
    pub y: f32,
    /// Side of the square: the larger of the width and the height of that box \[px\].
    pub size: f32,
    /// In-plane rotation of the head, clockwise in the image \[rad\].
    pub roll: f32,
    /// Sign and rough amount of yaw, −1 (turned to the image left) to 1 (right).
    pub yaw: f32,
    /// Confidence; higher is better, 0 is the working threshold.
    pub score: f32,
}
