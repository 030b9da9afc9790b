//! A tracker's settings and their bounds.

use super::Smoothing;
use crate::shape::Intrinsics;

/// A tracker's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Config {
    /// The camera; `None` for a 60° horizontal field of view.
    pub intrinsics: Option<Intrinsics>,
    /// Narrowest face searched for \[px\], 24 to 4096.
    pub min_face_px: u32,
    /// Work per step while searching, in units of the detector (a window is about two), 100 to 10
    /// million.
    pub scan_budget: u32,
    /// Of [`crate::track::Tracker::smoothed`]: a cutoff of 0.01 to 100 Hz, a beta of 0 to 1000.
    pub smoothing: Smoothing,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            intrinsics: None,
            min_face_px: 40,
            scan_budget: 3000,
            smoothing: Smoothing::default(),
        }
    }
}

impl Config {
    /// Whether every setting is in range.
    ///
    /// # Errors
    /// Names the first that is not.
    pub fn check(&self) -> Result<(), ConfigError> {
        if self.intrinsics.is_some_and(|camera| !camera.is_valid()) {
            return Err(ConfigError::Intrinsics);
        }
        if !(24..=4096).contains(&self.min_face_px) {
            return Err(ConfigError::MinFace);
        }
        if !(100..=10_000_000).contains(&self.scan_budget) {
            return Err(ConfigError::ScanBudget);
        }
        let Smoothing { cutoff_hz, beta } = self.smoothing;
        if !(0.01..=100.0).contains(&cutoff_hz) || !(0.0..=1000.0).contains(&beta) {
            return Err(ConfigError::Smoothing);
        }
        Ok(())
    }
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A focal length is not positive and finite, or the principal point is not finite.
    Intrinsics,
    /// `min_face_px` is out of range.
    MinFace,
    /// `scan_budget` is out of range.
    ScanBudget,
    /// `smoothing` is out of range.
    Smoothing,
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            ConfigError::Intrinsics => "focal lengths must be positive and intrinsics finite",
            ConfigError::MinFace => "min_face_px must lie in 24..=4096",
            ConfigError::Smoothing => "smoothing must lie in 0.01..=100 Hz, its beta in 0..=1000",
            ConfigError::ScanBudget => "scan_budget must lie in 100..=10000000",
        })
    }
}

impl core::error::Error for ConfigError {}
