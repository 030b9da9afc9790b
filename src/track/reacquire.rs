//! A step's reacquisition of a lost target by keyframes.
//!
//! A keyframe is added on trusted frames that bring something new, at most one per step. On the
//! step that loses the target, and on steps without a face after it, one window of the frame is
//! compared with the keyframes; a match is attempted like any candidate. Keyframes outlive a loss
//! and a new identity, because the person may come back. Those of a new identity replace the least
//! recently used.

use super::Tracker;
use super::candidate::Attempt;
use super::policy::KEYFRAME_UNITS;
use super::scanner::LastSeen;
use super::step::{Outcome, Step, WorkBudget};

impl Tracker {
    /// Looks for a lost target, or another face that was tracked before, in one window of the
    /// frame.
    #[inline(never)]
    pub(super) fn reacquire(
        &mut self,
        step: &Step<'_>,
        last_seen: &LastSeen,
        budget: &mut WorkBudget,
    ) -> Outcome {
        if !self.reacquirer.can_find(last_seen) {
            return Outcome::NotFound;
        }
        budget.spend(KEYFRAME_UNITS);
        let memory = self.work.scratch();
        let Some(found) = self.reacquirer.find(step.frame, last_seen, memory) else {
            return Outcome::NotFound;
        };
        let attempt = Attempt::near(found.origin);
        let outcome = self.attempt(step, &found.shape, &attempt);
        if outcome.is_accept() {
            self.reacquirer.confirm(&found);
            self.end_search();
        } else {
            budget.spend(self.alignment.units);
        }
        outcome
    }

    /// Adds the tracked face as a keyframe, if the frame is trusted and brings something new.
    #[inline(never)]
    pub(super) fn add_keyframe(&mut self, step: &Step<'_>) {
        let memory = self.work.scratch();
        self.reacquirer
            .add(step, &self.result, &self.target.shape, memory);
    }
}
