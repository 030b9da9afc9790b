//! Whether lids that seem shut may follow a gaze that was lowered a moment ago.
//!
//! Eyes that look down by 30° and more are hardly told from shut ones, and what is seen of them
//! changes from frame to frame. What is known is where they looked before.

use super::reading::Reading;

/// A gaze that is lowered by this much in the head may take the lids with it \[deg\]. Chosen: where
/// they count as lowered, as `openness` has it.
const LOWERED_DEG: f32 = 14.0;
/// How much less it must be lowered to be on its way elsewhere \[deg\].
const MARGIN_DEG: f32 = 5.0;
/// A look down lasts for so long at least \[µs\]: lids that begin to fall make a gaze seem lowered
/// too. Chosen: with twice that, three microsleeps of drivers who read are false.
const LEAST_US: u32 = 80_000;
/// For how long it is remembered \[µs\]. Chosen; half and twice that are the same.
const MEMORY_US: u32 = 1_000_000;

/// The last lowered gaze.
#[derive(Clone)]
pub(super) struct Lowered {
    /// For how long the gaze has been lowered \[µs\].
    time_us: u32,
    /// When it last was \[µs\].
    ago_us: u32,
}

impl Lowered {
    pub(super) const NEVER: Lowered = Lowered {
        time_us: 0,
        ago_us: 0,
    };

    /// Lets time pass with what was read at its beginning.
    pub(super) fn pass(&mut self, time_us: u32, held: &Reading) {
        match held.lowered_deg() {
            Some(deg) if deg >= LOWERED_DEG => {
                *self = Lowered {
                    time_us: self.time_us.saturating_add(time_us),
                    ago_us: 0,
                }
            }
            Some(deg) if deg < LOWERED_DEG - MARGIN_DEG => *self = Lowered::NEVER,
            _ => self.ago_us = self.ago_us.saturating_add(time_us),
        }
        if self.ago_us > MEMORY_US {
            *self = Lowered::NEVER;
        }
    }

    /// Whether the eyes may still look there.
    pub(super) fn is_recent(&self) -> bool {
        self.time_us >= LEAST_US
    }
}
