//! The multi-view face detector: a scan of the frame's luma in calls of bounded work.
//!
//! In: a [`Frame`](crate::image::Frame) and the model's section `DTCT`. Out: one [`Detection`] at a
//! time, the largest faces first.
//!
//! A tile is a square of the frame that is reduced to 128×128 px. A small convolutional network
//! gives a score, a displacement, a size, a roll and a yaw for each cell of 8×8 px (one stage, as
//! Redmon et al., "You Only Look Once", CVPR 2016). Tiles overlap; coarser ones show larger faces,
//! in steps of two. Cells that report the same face are merged (`candidates`). There is no copy of
//! the frame: a tile is read row by row ([`reduce`](crate::image::reduce)).
//!
//! Arithmetic is integer up to the network's outputs. [`Scan`] holds all state in fixed memory, so
//! a scan of the frame can be spread over as many calls as the caller likes; a tile is the unit of
//! work.

mod candidates;
mod hints;
mod local_search;
mod model;
mod scan;
mod tile;

pub use local_search::{is_upright, local_search};
pub use model::{DetectorModel, TAG};
#[cfg(feature = "unstable-internals")]
pub use model::{OUTPUTS, TILE};
pub use scan::{Scan, ScanBudget, ScanOutcome, Sizes, TILE_UNITS};
pub use tile::TileMemory;

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
    /// Logit of the network above its threshold: higher is better, 0 is the threshold.
    pub score: f32,
}

impl Detection {
    /// All zero: no face.
    pub const NONE: Detection = Detection {
        x: 0.0,
        y: 0.0,
        size: 0.0,
        roll: 0.0,
        yaw: 0.0,
        score: 0.0,
    };
}
