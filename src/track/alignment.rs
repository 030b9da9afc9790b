//! One alignment of a face and what the classifiers say of it.

use super::geometry::centre;
use super::policy::{
    IN_PLACE_SHARES, ROTATION_PRIOR_WEIGHT, TRUST_CONFIDENCE, UNTRUSTED_KEEP_CONFIDENCE,
    WRONG_CONFIDENCE,
};
use super::step::Step;
use super::{Model, Tracker};
use crate::align::Shape;
use crate::shape::{LANDMARKS, RotationPrior};
use crate::verifier::Confidence;

/// Landmarks aligned on a frame, verified, and not yet fitted.
pub(super) struct Alignment {
    /// Where it started.
    pub(super) initial_shape: Shape,
    /// Its landmarks.
    pub(super) shape: Shape,
    /// The landmarks after the global stage, before the refiners.
    pub(super) global_shape: Shape,
    /// The rotation by what it has seen.
    pub(super) rotation: Option<RotationPrior>,
    pub(super) confidence: Confidence,
    /// Landmarks that are visible and match the target's appearance.
    pub(super) recognised: u32,
}

impl Tracker {
    /// Aligns and verifies. `None` when a landmark is not finite.
    #[inline(never)]
    pub(super) fn align(
        &mut self,
        step: &Step<'_>,
        initial_shape: &Shape,
        iterations: usize,
    ) -> Option<Alignment> {
        let Step { model, frame, .. } = *step;
        let mut shape = *initial_shape;
        let align = &model.align;
        if !align.run(frame, iterations, &mut shape, &mut self.work) {
            return None;
        }
        let confidence = self.verify(model);
        Some(Alignment {
            initial_shape: *initial_shape,
            shape,
            global_shape: *self.work.global_shape(),
            rotation: self.rotation_prior(step, &shape, &confidence),
            confidence,
            recognised: 0,
        })
    }

    /// Aligns the target at its predicted place. Where its confidence is low there, the place where
    /// it was last trusted is tried too, because whatever covers a face draws the landmarks along.
    pub(super) fn align_target(&mut self, step: &Step<'_>) -> Option<Alignment> {
        let predicted = self.target.predict(step.now_us);
        let mut alignment = self.align_target_at(step, &predicted)?;
        let confidence = alignment.confidence.face;
        if self.target.is_trusted() && confidence < UNTRUSTED_KEEP_CONFIDENCE {
            self.align_at_anchor(step, &mut alignment);
        }
        Some(alignment)
    }

    /// Replaces `alignment` by one from where the target was last trusted, if that is the better
    /// one, or if neither place shows a face.
    #[inline(never)]
    fn align_at_anchor(&mut self, step: &Step<'_>, alignment: &mut Alignment) {
        let Some(anchor) = self.target.anchor.shape().copied() else {
            return;
        };
        let Some(other) = self.align_target_at(step, &anchor) else {
            return;
        };
        if self.excluded.contains(centre(&other.shape)) {
            return;
        }
        let (first, second) = (alignment.confidence.face, other.confidence.face);
        if second > first || first < WRONG_CONFIDENCE {
            *alignment = other;
        }
    }

    /// Aligns the target from a shape and compares it with its appearance.
    #[inline(never)]
    fn align_target_at(&mut self, step: &Step<'_>, initial_shape: &Shape) -> Option<Alignment> {
        let mut alignment = self.align(step, initial_shape, 1)?;
        if self.excluded.contains(centre(&alignment.shape)) {
            // It is another tracker's face, which the appearance must not follow.
            return Some(alignment);
        }
        let confidence = &mut alignment.confidence;
        let is_trusted = confidence.face >= TRUST_CONFIDENCE;
        let appearance = &mut self.target.appearance;
        alignment.recognised = appearance.update(self.work.features(), is_trusted, confidence);
        Some(alignment)
    }

    /// Confidence of the last alignment.
    fn verify(&self, model: &Model<'_>) -> Confidence {
        model
            .verifier
            .evaluate(self.work.features(), self.work.view())
    }

    /// The rotation by what the last alignment has seen. Landmarks that are hidden are estimates
    /// whose errors are alike: the more there are, the more the prior counts.
    fn rotation_prior(
        &self,
        step: &Step<'_>,
        shape: &Shape,
        confidence: &Confidence,
    ) -> Option<RotationPrior> {
        let (work, mean) = (&self.work, step.model.align.mean());
        let camera = &step.camera(&self.config);
        let regression = &step.model.rotation;
        let prior = regression.predict(work.features(), work.view(), mean, shape, camera)?;
        let visible = visible_share(confidence);
        Some(RotationPrior {
            weight: ROTATION_PRIOR_WEIGHT * (1.0 - visible),
            ..prior
        })
    }

    /// Whether enough of the target is as it was when it was last trusted, though its face is not
    /// confirmed: the visible landmarks, and what surrounds the face.
    pub(super) fn is_in_place(&self, step: &Step<'_>, alignment: &Alignment) -> bool {
        let visible = visible_share(&alignment.confidence);
        visible + self.target.anchor.unchanged_share(step.frame) >= IN_PLACE_SHARES
    }
}

fn visible_share(confidence: &Confidence) -> f32 {
    confidence.visibility.iter().sum::<f32>() / LANDMARKS as f32
}
