//! What one step is given, how much work it may do, and how an attempt to find a face ends.

use super::{Config, Loss, Model};
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

/// Work of one step, in units of the detector: a window costs one unit, and one more for every 16
/// trees that it needs. Costs of everything else are in `policy.rs`.
pub(super) struct WorkBudget {
    limit: u32,
    spent: u32,
}

impl WorkBudget {
    pub(super) fn new(limit: u32) -> WorkBudget {
        WorkBudget { limit, spent: 0 }
    }

    pub(super) fn spend(&mut self, units: u32) {
        self.spent = self.spent.saturating_add(units);
    }

    pub(super) fn spent(&self) -> u32 {
        self.spent
    }

    /// Units that are left; 0 when more than the limit was spent.
    pub(super) fn left(&self) -> u32 {
        self.limit.saturating_sub(self.spent)
    }

    /// Leaves one unit at least: each step advances the scan, whatever else it did.
    pub(super) fn leave_one(&mut self) {
        self.spent = self.spent.min(self.limit.saturating_sub(1));
    }

    /// The same work under another limit, with one unit left at least.
    pub(super) fn limited_to(&self, limit: u32) -> WorkBudget {
        let mut budget = WorkBudget {
            limit,
            spent: self.spent,
        };
        budget.leave_one();
        budget
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_ends_at_its_limit_and_leaves_one_unit() {
        let mut budget = WorkBudget::new(100);
        budget.spend(40);
        assert_eq!((budget.left(), budget.spent()), (60, 40));
        assert_eq!(budget.limited_to(30).left(), 1);
        budget.spend(u32::MAX);
        assert_eq!(budget.left(), 0);
        budget.leave_one();
        assert_eq!((budget.left(), budget.spent()), (1, 99));
    }
}
