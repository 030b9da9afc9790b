//! Why settings or a frame are rejected.

use super::config::{BETA, CUTOFF_HZ, MIN_FACE_PX, SCAN_BUDGET};
use crate::shape::{FOCAL_PX, PIXEL_ASPECT, PRINCIPAL_PX};
use core::fmt;

/// Why settings are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A focal length, their ratio or the principal point is out of range.
    Intrinsics,
    /// `min_face_px` is out of range.
    MinFace,
    /// `scan_budget` is out of range.
    ScanBudget,
    /// `smoothing` is out of range.
    Smoothing,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ConfigError::Intrinsics => {
                let (least, most) = (FOCAL_PX.start(), FOCAL_PX.end());
                let (narrow, wide) = (PIXEL_ASPECT.start(), PIXEL_ASPECT.end());
                write!(
                    f,
                    "focal lengths must be {least} to {most} px and their ratio {narrow} to \
                     {wide}, the principal point within {PRINCIPAL_PX} px of 0"
                )
            }
            ConfigError::MinFace => write!(f, "min_face_px must lie in {MIN_FACE_PX:?}"),
            ConfigError::ScanBudget => write!(f, "scan_budget must lie in {SCAN_BUDGET:?}"),
            ConfigError::Smoothing => write!(
                f,
                "smoothing must lie in {CUTOFF_HZ:?} Hz, its beta in {BETA:?}"
            ),
        }
    }
}

impl core::error::Error for ConfigError {}

/// Why a frame is rejected. The tracker is then as before the call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StepError {
    /// The timestamp is not after that of the frame before.
    Time,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            StepError::Time => "the timestamp is not after that of the frame before",
        })
    }
}

impl core::error::Error for StepError {}
