//! Why a frame is rejected.

use core::fmt;

/// Why a frame is rejected. The tracker is then as before the call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StepError {
    /// The timestamp is not after that of the frame before.
    Time,
    /// A number of the hint is out of range.
    Hint,
    /// The region of interest does not lie in the frame.
    Roi,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            StepError::Time => "the timestamp is not after that of the frame before",
            StepError::Hint => "a number of the hint is out of range",
            StepError::Roi => "the region of interest does not lie in the frame",
        })
    }
}

impl core::error::Error for StepError {}
