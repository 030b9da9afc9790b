//! Aligning a candidate or the target, at its predicted place and at its anchor.

use super::alignment::Needed;
use super::geometry::centre;
use super::policy::{
    CUT_SHARE, IN_PLACE_SHARES, ITERATION_UNITS, REFINE_UNITS, ROTATION_PRIOR_WEIGHT,
    TRUST_CONFIDENCE, UNTRUSTED_KEEP_CONFIDENCE,
};
use super::step::Step;
use super::{Model, Tracker};
use crate::align::{Shape, Workspace};
use crate::shape::RotationPrior;
use crate::verifier::Confidence;

impl Tracker {
    /// Runs the global stage and verifies each iteration. A candidate ends where it has less
    /// confidence than is needed to go on. Any other is refined. What comes of it is in
    /// `self.alignment`. False when a landmark is not finite.
    #[inline(never)]
    pub(super) fn align(
        &mut self,
        step: &Step<'_>,
        initial_shape: &Shape,
        iterations: usize,
        needed: Needed,
    ) -> bool {
        let (align, work) = (&step.model.align, &mut self.work);
        let alignment = &mut self.alignment;
        alignment.recognised = 0;
        alignment.units = 0;
        alignment.initial_shape = *initial_shape;
        alignment.shape = *initial_shape;
        for left in (0..iterations).rev() {
            alignment.units += ITERATION_UNITS;
            if !align.iterate(step.frame, &mut alignment.shape, work) {
                return false;
            }
            alignment.global_shape = alignment.shape;
            alignment.confidence = verify(step.model, work);
            alignment.iterations_left = left;
            let least = match left {
                0 => needed.to_refine,
                _ => needed.to_iterate,
            };
            if alignment.confidence.face < least {
                return true;
            }
        }
        alignment.units += REFINE_UNITS;
        if !align.refine(step.frame, &mut alignment.shape, work) {
            return false;
        }
        self.alignment.rotation = self.rotation_prior(step);
        true
    }

    /// Aligns the target at its predicted place. Where its confidence is low there, the place where
    /// it was last trusted is tried too, because whatever covers a face draws the landmarks along.
    pub(super) fn align_target(&mut self, step: &Step<'_>) -> bool {
        if !self.align_predicted(step) {
            return false;
        }
        let confidence = self.alignment.confidence.face;
        if self.target.is_trusted() && confidence < UNTRUSTED_KEEP_CONFIDENCE {
            self.align_at_anchor(step);
        }
        true
    }

    #[inline(never)]
    fn align_predicted(&mut self, step: &Step<'_>) -> bool {
        let predicted = self.target.predict(step.now_us);
        self.align_target_at(step, &predicted)
    }

    /// Replaces the alignment by one from where the target was last trusted, if that is the better
    /// one.
    #[inline(never)]
    fn align_at_anchor(&mut self, step: &Step<'_>) {
        let Some(anchor) = self.target.anchor.shape().copied() else {
            return;
        };
        let first = self.alignment.clone();
        let is_aligned = self.align_target_at(step, &anchor);
        let is_free = !self.excluded.contains(centre(&self.alignment.shape));
        let is_better = self.alignment.confidence.face > first.confidence.face;
        if !(is_aligned && is_free && is_better) {
            self.alignment = first;
        }
    }

    /// Aligns the target from a shape and compares it with its appearance.
    fn align_target_at(&mut self, step: &Step<'_>, initial_shape: &Shape) -> bool {
        if !self.align(step, initial_shape, 1, Needed::to_refine(0.0)) {
            return false;
        }
        let alignment = &mut self.alignment;
        // The appearance must not follow another tracker's face.
        if !self.excluded.contains(centre(&alignment.shape)) {
            let is_trusted = alignment.confidence.face >= TRUST_CONFIDENCE;
            let confidence = &mut alignment.confidence;
            let appearance = &mut self.target.appearance;
            alignment.recognised = appearance.update(self.work.features(), is_trusted, confidence);
        }
        true
    }

    /// The rotation by what the last alignment has seen. Landmarks that are hidden are estimates
    /// whose errors are alike: the more there are, the more the prior counts.
    fn rotation_prior(&self, step: &Step<'_>) -> Option<RotationPrior> {
        let (work, mean) = (&self.work, step.model.align.mean());
        let (regression, shape) = (&step.model.rotation, &self.alignment.shape);
        let camera = &step.camera(&self.config);
        let prior = regression.predict(work.features(), work.view(), mean, shape, camera)?;
        let visible = self.alignment.confidence.visible_share();
        Some(RotationPrior {
            weight: ROTATION_PRIOR_WEIGHT * (1.0 - visible),
            ..prior
        })
    }

    /// Whether the last alignment of the target is good enough to go on with.
    pub(super) fn is_kept(&self, step: &Step<'_>) -> bool {
        let alignment = &self.alignment;
        let confidence = &alignment.confidence;
        let kept = confidence.face
            >= self
                .target
                .min_confidence(alignment.recognised, step.now_us);
        if !self.target.is_trusted() || confidence.face >= UNTRUSTED_KEEP_CONFIDENCE {
            return kept;
        }
        let centre = centre(&alignment.shape);
        let (anchor, last) = (&self.target.anchor, &self.target.last);
        if last.unchanged(step.frame, centre).most() < CUT_SHARE {
            return false;
        }
        let may_be_covered = anchor.is_set() && self.target.may_be_covered(step.now_us);
        kept || may_be_covered && {
            let share = anchor.unchanged(step.frame, centre).in_place;
            confidence.visible_share() + share >= IN_PLACE_SHARES
        }
    }
}

/// Confidence of the last iteration.
fn verify(model: &Model<'_>, work: &Workspace) -> Confidence {
    model.verifier.evaluate(work.features(), work.view())
}
