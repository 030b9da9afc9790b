//! What one step is given, why it may be refused, and how much work it may do.

use super::policy::STEP_UNITS;
use super::{Config, Model};
use crate::align::Networks;
use crate::detect::TILE_UNITS;
use crate::image::{Frame, Roi, noise_share};
use crate::shape::Intrinsics;
use core::fmt;

/// The input of one step.
#[derive(Clone, Copy)]
pub(super) struct Step<'s> {
    pub(super) model: &'s Model<'s>,
    /// Box-filtered where it is noisy.
    pub(super) frame: &'s Frame<'s>,
    /// The frame's timestamp \[µs\].
    pub(super) now_us: i64,
    /// The configured camera, or the default one for frames of this size.
    pub(super) camera: Intrinsics,
    /// Whether it is the default one.
    pub(super) camera_assumed: bool,
    /// The configured region of interest.
    pub(super) roi: Option<Roi>,
    /// Those that see the target.
    pub(super) networks: Networks,
}

impl<'s> Step<'s> {
    pub(super) fn new(
        model: &'s Model<'s>,
        frame: &'s Frame<'s>,
        now_us: i64,
        config: &Config,
    ) -> Step<'s> {
        let of_frame = || Intrinsics::of_frame(frame.width(), frame.height());
        Step {
            model,
            frame,
            now_us,
            camera: config.intrinsics.unwrap_or_else(of_frame),
            camera_assumed: config.intrinsics.is_none(),
            roi: config.roi,
            networks: Networks::All,
        }
    }

    /// With these networks for the target.
    pub(super) fn with(self, networks: Networks) -> Step<'s> {
        Step { networks, ..self }
    }

    /// The part of the frame that is scanned.
    pub(super) fn scanned(&self) -> Roi {
        self.roi.unwrap_or_else(|| Roi::whole(self.frame))
    }
}

/// A frame that several trackers may see, and what is known of it for all of them.
pub(super) struct SharedFrame<'f> {
    pub(super) frame: Frame<'f>,
    /// See [`noise_share`]; `None` until it is asked for.
    noise: Option<f32>,
}

impl<'f> SharedFrame<'f> {
    pub(super) fn new(frame: &Frame<'f>) -> Self {
        SharedFrame {
            frame: *frame,
            noise: None,
        }
    }

    /// The share of noise, measured once.
    pub(super) fn noise(&mut self) -> f32 {
        *self.noise.get_or_insert_with(|| noise_share(&self.frame))
    }

    /// The frame, box-filtered if it is noisy.
    pub(super) fn filtered(&self, is_noisy: bool) -> Frame<'f> {
        match is_noisy {
            true => self.frame.box_filtered(),
            false => self.frame,
        }
    }
}

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
    /// A group has more than [`MAX_GROUP`](crate::MAX_GROUP) trackers.
    Group,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            StepError::Time => "the timestamp is not after that of the frame before",
            StepError::Hint => "a number of the hint is out of range",
            StepError::Roi => "the region of interest does not lie in the frame",
            StepError::Group => "a group has at most 16 trackers",
        })
    }
}

impl core::error::Error for StepError {}

/// Work of one step, in units of which a tracking step has 2,600: a tile of the detector has
/// [`TILE_UNITS`], costs of everything else are in `policy.rs`.
pub(super) struct WorkBudget {
    limit: u32,
    spent: u32,
    /// What was spent before it, and since, whatever was given back.
    total: u32,
}

impl WorkBudget {
    /// A limit below the work of a tile counts as that: each step can evaluate one. `before` was
    /// spent by the step already, and does not count for the limit.
    pub(super) fn new(limit: u32, before: u32) -> WorkBudget {
        WorkBudget {
            limit: limit.max(TILE_UNITS),
            spent: 0,
            total: before,
        }
    }

    pub(super) fn spend(&mut self, units: u32) {
        self.spent = self.spent.saturating_add(units);
        self.total = self.total.saturating_add(units);
    }

    /// All work of the step so far.
    pub(super) fn total(&self) -> u32 {
        self.total
    }

    /// Whether so much more is within what a step may take: [`STEP_UNITS`], or the limit where the
    /// settings allow more.
    pub(super) fn has_room(&self, units: u32) -> bool {
        self.total.saturating_add(units) <= STEP_UNITS.max(self.limit)
    }

    pub(super) fn spent(&self) -> u32 {
        self.spent
    }

    /// What it began with.
    pub(super) fn limit(&self) -> u32 {
        self.limit
    }

    /// Units that remain; 0 when more than the limit was spent.
    pub(super) fn left(&self) -> u32 {
        self.limit.saturating_sub(self.spent)
    }

    /// Gives back what was spent beyond the limit less `units`: each step advances the scan,
    /// whatever else it did.
    pub(super) fn leave(&mut self, units: u32) {
        self.spent = self.spent.min(self.limit.saturating_sub(units));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_ends_at_its_limit_and_leaves_a_tile() {
        let mut budget = WorkBudget::new(1000, 0);
        budget.spend(400);
        assert_eq!((budget.left(), budget.spent()), (600, 400));
        budget.spend(u32::MAX);
        assert_eq!(budget.left(), 0);
        budget.leave(TILE_UNITS);
        assert_eq!(budget.left(), TILE_UNITS);
        assert_eq!(WorkBudget::new(1, 0).left(), TILE_UNITS);
    }

    #[test]
    fn a_step_has_room_for_so_much_and_no_more() {
        let mut budget = WorkBudget::new(1000, 500);
        budget.spend(800);
        budget.leave(TILE_UNITS);
        assert_eq!(budget.total(), 1300);
        assert!(budget.has_room(STEP_UNITS - 1300) && !budget.has_room(STEP_UNITS - 1299));
        assert!(WorkBudget::new(u32::MAX, 500).has_room(u32::MAX - 500));
    }
}
