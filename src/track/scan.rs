//! A step's scan for a new face: which detections are attempted within the budget.

use super::Tracker;
use super::alignment::Needed;
use super::policy::{
    DISCARD_CONFIDENCE, FIRST_ATTEMPT_CONFIDENCE, ITERATION_UNITS, KEYFRAME_UNITS, REFINE_UNITS,
    RETRY_CONFIDENCE,
};
use super::scanner::ScanPlan;
use super::step::{Outcome, Step, WorkBudget, tile_memory};
use super::target::Origin;
use crate::detect::TILE_UNITS;

impl Tracker {
    /// Scans for a new face within what is left of the step's work.
    pub(super) fn scan(
        &mut self,
        step: &Step<'_>,
        plan: ScanPlan,
        budget: &mut WorkBudget,
    ) -> Outcome {
        let outcome = self.attempt_detections(step, plan, budget);
        if outcome.is_accept() {
            self.end_search();
        }
        outcome
    }

    /// Attempts the pending retry and then each detection, until a face is accepted.
    fn attempt_detections(
        &mut self,
        step: &Step<'_>,
        mut plan: ScanPlan,
        budget: &mut WorkBudget,
    ) -> Outcome {
        // If a keyframe match was rejected, the step has had its retry.
        let is_first_retry = budget.spent() <= KEYFRAME_UNITS;
        if self.retry.is_some() && is_first_retry {
            if self.retry(step).is_accept() {
                return Outcome::Accept;
            }
            budget.spend(self.alignment.units);
        }
        budget.leave(TILE_UNITS);
        let roi = step.roi(&self.config);
        loop {
            let memory = &mut tile_memory(&mut self.work);
            let Some(face) = self.scanner.next(step, roi, &mut plan, budget, memory) else {
                break;
            };
            let needed = Needed {
                to_iterate: match budget.left() >= whole_attempt(step) {
                    true => DISCARD_CONFIDENCE,
                    false => RETRY_CONFIDENCE,
                },
                to_refine: FIRST_ATTEMPT_CONFIDENCE,
            };
            let outcome = self.attempt_detection(step, &face, Origin::NewFace, needed);
            if outcome.is_accept() {
                return outcome;
            }
            budget.spend(self.alignment.units);
        }
        // On the same frame where work is left: a still picture is not shown again.
        while self.retry.is_some() && budget.left() >= ITERATION_UNITS + REFINE_UNITS {
            let outcome = self.retry(step);
            if outcome.is_accept() {
                return outcome;
            }
            budget.spend(self.alignment.units);
        }
        Outcome::NotFound
    }

    /// A face was found: ends scan and retry.
    pub(super) fn end_search(&mut self) {
        self.scanner.restart();
        self.retry.clear();
    }
}

/// Most work of a first attempt \[units\].
fn whole_attempt(step: &Step<'_>) -> u32 {
    step.model.align.iterations() as u32 * ITERATION_UNITS + REFINE_UNITS
}
