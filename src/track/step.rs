//! What one step is given, how much work it may do, and how an attempt to find a face ends.

use super::{Config, Loss, Model};
use crate::align::Workspace;
use crate::detect::{TILE_UNITS, TileMemory};
use crate::image::{Frame, Roi};
use crate::shape::Intrinsics;

/// The input of one step.
#[derive(Clone, Copy)]
pub(super) struct Step<'s> {
    pub(super) model: &'s Model<'s>,
    /// Box-filtered where it is noisy.
    pub(super) frame: &'s Frame<'s>,
    /// The frame's timestamp \[µs\].
    pub(super) now_us: i64,
}

impl Step<'_> {
    /// The configured camera, or the default one for frames of this size.
    pub(super) fn camera(&self, config: &Config) -> Intrinsics {
        match config.intrinsics {
            Some(camera) => camera,
            None => Intrinsics::of_frame(self.frame.width(), self.frame.height()),
        }
    }

    /// The configured region of interest, or the whole frame.
    pub(super) fn roi(&self, config: &Config) -> Roi {
        config.roi.unwrap_or_else(|| Roi::whole(self.frame))
    }
}

/// How a step, or one attempt of a step to find a face, ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    /// A face is fitted on this frame; target and result describe it.
    Accept,
    /// Rejected, but this confidence is worth a retry with one more iteration.
    Retry { confidence: f32 },
    /// No face, or no longer the target: why. Target and result are unchanged.
    Reject(Loss),
    /// There was no candidate. Target and result are unchanged.
    NotFound,
}

impl Outcome {
    pub(super) fn is_accept(self) -> bool {
        self == Outcome::Accept
    }
}

/// The detector's memory: that of the alignment, between two of its runs.
pub(super) fn tile_memory(work: &mut Workspace) -> TileMemory<'_> {
    let (crop, maps) = work.network_memory();
    TileMemory { crop, maps }
}

/// Work of one step, in units of which a tracking step has 3,000: a tile of the detector has
/// [`TILE_UNITS`], costs of everything else are in `policy.rs`.
pub(super) struct WorkBudget {
    limit: u32,
    spent: u32,
}

impl WorkBudget {
    /// A limit below the work of a tile counts as that: each step can evaluate one.
    pub(super) fn new(limit: u32) -> WorkBudget {
        WorkBudget {
            limit: limit.max(TILE_UNITS),
            spent: 0,
        }
    }

    pub(super) fn spend(&mut self, units: u32) {
        self.spent = self.spent.saturating_add(units);
    }

    pub(super) fn spent(&self) -> u32 {
        self.spent
    }

    /// What it began with.
    pub(super) fn limit(&self) -> u32 {
        self.limit
    }

    /// Units that are left; 0 when more than the limit was spent.
    pub(super) fn left(&self) -> u32 {
        self.limit.saturating_sub(self.spent)
    }

    /// Leaves so many units at least: each step advances the scan, whatever else it did.
    pub(super) fn leave(&mut self, units: u32) {
        self.spent = self.spent.min(self.limit.saturating_sub(units));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_ends_at_its_limit_and_leaves_a_tile() {
        let mut budget = WorkBudget::new(1000);
        budget.spend(400);
        assert_eq!((budget.left(), budget.spent()), (600, 400));
        budget.spend(u32::MAX);
        assert_eq!(budget.left(), 0);
        budget.leave(TILE_UNITS);
        assert_eq!(budget.left(), TILE_UNITS);
        assert_eq!(WorkBudget::new(1).left(), TILE_UNITS);
    }
}
