//! One step: frame in, result out.

use super::{Model, TrackResult};
use crate::image::Frame;
use crate::shape::Intrinsics;
use core::mem::MaybeUninit;

/// A tracker's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// The camera; `None` for a 60° horizontal field of view.
    pub intrinsics: Option<Intrinsics>,
    /// Narrowest face searched for \[px\], 24 to 4096.
    pub min_face_px: u32,
    /// Windows tested per step while searching, 100 to 10 million.
    pub scan_budget: u32,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            intrinsics: None,
            min_face_px: 40,
            scan_budget: 6000,
        }
    }
}

impl Config {
    /// Whether every setting is in its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first that is not.
    pub fn check(&self) -> Result<(), ConfigError> {
        if let Some(Intrinsics { fx, fy, cx, cy }) = self.intrinsics {
            let finite = [fx, fy, cx, cy].iter().all(|v| v.is_finite());
            if !(finite && fx > 0.0 && fy > 0.0) {
                return Err(ConfigError::Intrinsics);
            }
        }
        if !(24..=4096).contains(&self.min_face_px) {
            return Err(ConfigError::MinFace);
        }
        if !(100..=10_000_000).contains(&self.scan_budget) {
            return Err(ConfigError::ScanBudget);
        }
        Ok(())
    }
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// A focal length is not positive and finite, or the principal point is not finite.
    Intrinsics,
    /// `min_face_px` is out of range.
    MinFace,
    /// `scan_budget` is out of range.
    ScanBudget,
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            ConfigError::Intrinsics => "focal lengths must be positive and intrinsics finite",
            ConfigError::MinFace => "min_face_px must lie in 24..=4096",
            ConfigError::ScanBudget => "scan_budget must lie in 100..=10000000",
        })
    }
}

impl core::error::Error for ConfigError {}

/// Why a frame was not taken; the tracker is then as before the call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepError {
    /// The timestamp is not after that of the frame before.
    Time,
}

impl core::fmt::Display for StepError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the timestamp is not after that of the frame before")
    }
}

impl core::error::Error for StepError {}

/// All state of one tracked face. Plain data: a copy of it goes on independently.
#[derive(Clone)]
pub struct Tracker {
    config: Config,
    result: TrackResult,
    last_timestamp_us: Option<i64>,
}

impl Tracker {
    /// Has seen nothing. All zero bytes, so that building one in place is a memset and needs no
    /// copy on the stack.
    const EMPTY: Tracker = Tracker {
        config: Config {
            intrinsics: None,
            min_face_px: 0,
            scan_budget: 0,
        },
        result: TrackResult::EMPTY,
        last_timestamp_us: None,
    };

    /// A tracker that has seen nothing.
    ///
    /// # Errors
    /// [`ConfigError`] names the setting that is out of range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Tracker {
            config: *config,
            ..Self::EMPTY
        })
    }

    /// As [`Tracker::new`], in place: for small stacks. On failure the slot is untouched.
    ///
    /// # Errors
    /// As [`Tracker::new`].
    pub fn init_in<'t>(
        slot: &'t mut MaybeUninit<Tracker>,
        config: &Config,
    ) -> Result<&'t mut Tracker, ConfigError> {
        config.check()?;
        let tracker = slot.write(Self::EMPTY);
        tracker.config = *config;
        Ok(tracker)
    }

    /// One frame in, one answer out; bounded work. Timestamps \[µs\] of any monotonic clock must
    /// increase from step to step.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    pub fn step(
        &mut self,
        _model: &Model<'_>,
        _frame: &Frame<'_>,
        timestamp_us: i64,
    ) -> Result<&TrackResult, StepError> {
        if self
            .last_timestamp_us
            .is_some_and(|last| timestamp_us <= last)
        {
            return Err(StepError::Time);
        }
        self.last_timestamp_us = Some(timestamp_us);
        self.result.timestamp_us = timestamp_us;
        Ok(&self.result)
    }

    /// The answer to the last step.
    pub fn result(&self) -> &TrackResult {
        &self.result
    }

    /// The settings.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Forgets the face and the clock; settings stay.
    pub fn reset(&mut self) {
        self.result = TrackResult::default();
        self.last_timestamp_us = None;
    }

    /// Changes the camera from the next step on.
    ///
    /// # Errors
    /// [`ConfigError::Intrinsics`].
    pub fn set_intrinsics(&mut self, intrinsics: Option<Intrinsics>) -> Result<(), ConfigError> {
        let config = Config {
            intrinsics,
            ..self.config
        };
        config.check()?;
        self.config = config;
        Ok(())
    }
}
