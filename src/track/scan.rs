//! A step's scan for a new face: which detections are attempted within the budget.

use super::Tracker;
use super::policy::{FIRST_ATTEMPT_CONFIDENCE, ITERATION_UNITS, KEYFRAME_UNITS, REFINE_UNITS};
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
            let least = FIRST_ATTEMPT_CONFIDENCE;
            let outcome = self.attempt_detection(step, &face, Origin::NewFace, least);
            if outcome.is_accept() {
                return outcome;
            }
            budget.spend(self.alignment.units);
        }
        // On the same frame where work is left: a still picture is not shown again.
        if self.retry.is_some() && budget.left() >= ITERATION_UNITS + REFINE_UNITS {
            return self.retry(step);
        }
        Outcome::NotFound
    }

    /// A face was found: ends scan and retry.
    pub(super) fn end_search(&mut self) {
        self.scanner.restart();
        self.retry.clear();
    }
}
