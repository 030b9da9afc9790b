//! A tracker's settings, their defaults and ranges.

use crate::image::{MAX_SIDE, Roi};
use crate::shape::{FOCAL_PX, Intrinsics, PIXEL_ASPECT, PRINCIPAL_PX};
use core::fmt;
use core::ops::RangeInclusive;

/// Most boxes that a tracker excludes; chosen.
pub const MAX_EXCLUDED: usize = 16;

/// Range of [`Config::min_face_px`] \[px\]; as all ranges here it is chosen.
const MIN_FACE_PX: RangeInclusive<u32> = 24..=4096;
/// Range of [`Config::scan_budget`] \[units\].
const SCAN_BUDGET: RangeInclusive<u32> = 100..=10_000_000;
/// Range of [`Smoothing::cutoff_hz`] \[Hz\].
const CUTOFF_HZ: RangeInclusive<f32> = 0.01..=100.0;
/// Range of [`Smoothing::beta`].
const BETA: RangeInclusive<f32> = 0.0..=1000.0;

/// Range of [`Config::network_period`] \[frames\].
const NETWORK_PERIOD: RangeInclusive<u32> = 1..=8;

/// A tracker's settings. Start from the defaults:
///
/// ```
/// use posewise::Config;
/// let config = Config::default().with_min_face_px(80).with_scan_budget(1200);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct Config {
    /// The camera; `None` for a 60° horizontal field of view. Default: `None`.
    pub intrinsics: Option<Intrinsics>,
    /// Narrowest face that is searched for \[px\], 24 to 4096. Default: 40.
    pub min_face_px: u32,
    /// Work per step while searching, 100 to 10 million: 2600 is a tracking step, 700 a tile of
    /// the detector, which each step evaluates at least. Default: 3600, which is five tiles.
    pub scan_budget: u32,
    /// The filter of [`crate::Tracker::smoothed`].
    pub smoothing: Smoothing,
    /// Region of interest: only faces that are centred in it are found, and only it is scanned.
    /// A face that is tracked may leave it. It must lie in every frame. `None` for the whole
    /// frame. Default: `None`.
    pub roi: Option<Roi>,
    /// Looks at the eyes of the tracked face: [`crate::TrackResult::eyes`]. It takes a network of
    /// its own for each eye. Default: false; the eyes are then unknown, and a step is as if there
    /// were no such network.
    pub gaze: bool,
    /// With [`Config::gaze`]: takes part of the mean of this person's gaze in the head frame off
    /// the gaze, at most 8°. For people who look straight ahead most of the time, as drivers do:
    /// most of what is wrong with a gaze stays the same for a person. It is forgotten with the
    /// identity. Default: false.
    pub natural_gaze: bool,
    /// Number of frames of which one is seen with all networks, 1 to 8. On the others, what the
    /// second network of the global stage and the mouth's mirrored run changed when they last ran
    /// is taken. With 4 a step takes a fifth less on average, and landmarks jitter a tenth more
    /// (`posewise-lab eval turns`). Default: 1.
    pub network_period: u32,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            intrinsics: None,
            min_face_px: 40,
            scan_budget: 3600,
            smoothing: Smoothing::default(),
            roi: None,
            gaze: false,
            natural_gaze: false,
            network_period: 1,
        }
    }
}

impl Config {
    /// With another [`Config::intrinsics`].
    pub fn with_intrinsics(self, intrinsics: impl Into<Option<Intrinsics>>) -> Self {
        Config {
            intrinsics: intrinsics.into(),
            ..self
        }
    }

    /// With another [`Config::min_face_px`].
    pub fn with_min_face_px(self, min_face_px: u32) -> Self {
        Config {
            min_face_px,
            ..self
        }
    }

    /// With another [`Config::scan_budget`].
    pub fn with_scan_budget(self, scan_budget: u32) -> Self {
        Config {
            scan_budget,
            ..self
        }
    }

    /// With another [`Config::smoothing`].
    pub fn with_smoothing(self, smoothing: Smoothing) -> Self {
        Config { smoothing, ..self }
    }

    /// With another [`Config::roi`].
    pub fn with_roi(self, roi: impl Into<Option<Roi>>) -> Self {
        Config {
            roi: roi.into(),
            ..self
        }
    }

    /// With another [`Config::gaze`].
    pub fn with_gaze(self, gaze: bool) -> Self {
        Config { gaze, ..self }
    }

    /// With another [`Config::natural_gaze`].
    pub fn with_natural_gaze(self, natural_gaze: bool) -> Self {
        Config {
            natural_gaze,
            ..self
        }
    }

    /// With another [`Config::network_period`].
    pub fn with_network_period(self, network_period: u32) -> Self {
        Config {
            network_period,
            ..self
        }
    }

    /// Whether every setting is in range.
    ///
    /// # Errors
    /// Names the first that is not.
    pub fn check(&self) -> Result<(), ConfigError> {
        if self.intrinsics.is_some_and(|camera| !camera.is_valid()) {
            return Err(ConfigError::Intrinsics);
        }
        if (self.intrinsics).is_some_and(|camera| !camera.distortion.is_valid()) {
            return Err(ConfigError::Distortion);
        }
        if !MIN_FACE_PX.contains(&self.min_face_px) {
            return Err(ConfigError::MinFace);
        }
        if !SCAN_BUDGET.contains(&self.scan_budget) {
            return Err(ConfigError::ScanBudget);
        }
        if !NETWORK_PERIOD.contains(&self.network_period) {
            return Err(ConfigError::NetworkPeriod);
        }
        let Smoothing { cutoff_hz, beta } = self.smoothing;
        if !CUTOFF_HZ.contains(&cutoff_hz) || !BETA.contains(&beta) {
            return Err(ConfigError::Smoothing);
        }
        if self.roi.is_some_and(|roi| !roi.is_valid()) {
            return Err(ConfigError::Roi);
        }
        Ok(())
    }
}

/// How strongly results are smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct Smoothing {
    /// Cutoff for a face that does not move \[Hz\], 0.01 to 100: lower gives less jitter. Default:
    /// 1.
    pub cutoff_hz: f32,
    /// How much the cutoff rises with speed \[Hz per unit of speed\], 0 to 1000: higher gives less
    /// delay. Default: 12.
    pub beta: f32,
}

impl Smoothing {
    /// A filter with this cutoff \[Hz\] and beta.
    pub const fn new(cutoff_hz: f32, beta: f32) -> Self {
        Smoothing { cutoff_hz, beta }
    }
}

impl Default for Smoothing {
    fn default() -> Self {
        Smoothing::new(1.0, 12.0)
    }
}

/// Why settings are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A focal length, their ratio or the principal point is out of range.
    Intrinsics,
    /// A coefficient of the lens is out of range, or its picture turns back within 1° of the axis.
    Distortion,
    /// `min_face_px` is out of range.
    MinFace,
    /// `scan_budget` is out of range.
    ScanBudget,
    /// `smoothing` is out of range.
    Smoothing,
    /// `roi` is empty or reaches beyond the largest frame.
    Roi,
    /// There are too many excluded boxes, or a number is out of range.
    Excluded,
    /// `network_period` is out of range.
    NetworkPeriod,
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
            ConfigError::Distortion => write!(
                f,
                "distortion: radial coefficients must be within 10000 of 0 (fisheye: 10), \
                 tangential ones within 0.1, and the picture must not turn back within 1° of the \
                 axis"
            ),
            ConfigError::MinFace => {
                let (least, most) = (MIN_FACE_PX.start(), MIN_FACE_PX.end());
                write!(f, "min_face_px must be {least} to {most} px")
            }
            ConfigError::ScanBudget => {
                let (least, most) = (SCAN_BUDGET.start(), SCAN_BUDGET.end());
                write!(f, "scan_budget must be {least} to {most}")
            }
            ConfigError::Smoothing => {
                let (slow, fast) = (CUTOFF_HZ.start(), CUTOFF_HZ.end());
                let (least, most) = (BETA.start(), BETA.end());
                write!(
                    f,
                    "smoothing: cutoff_hz must be {slow} to {fast} Hz, beta {least} to {most}"
                )
            }
            ConfigError::NetworkPeriod => {
                let (least, most) = (NETWORK_PERIOD.start(), NETWORK_PERIOD.end());
                write!(f, "network_period must be {least} to {most} frames")
            }
            ConfigError::Excluded => write!(
                f,
                "excluded boxes: at most {MAX_EXCLUDED}, with sides of 1 to 32768 px"
            ),
            ConfigError::Roi => write!(
                f,
                "roi must be at least 1 px wide and high, and end within {MAX_SIDE} px"
            ),
        }
    }
}

impl core::error::Error for ConfigError {}
