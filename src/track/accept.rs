//! The last part of every attempt: the 3D face is fitted to the aligned landmarks. If a pose
//! explains them, they become the target's, and the result is written.

use super::output::{Fitted, write};
use super::policy::{
    FIT_WEIGHT_HIDDEN, FIT_WEIGHT_MIN, ROTATION_PRIOR_WEIGHT, UNTRUSTED_KEEP_CONFIDENCE,
};
use super::step::{Outcome, Step};
use super::target::Origin;
use super::{Loss, Model, Tracker};
use crate::align::Shape;
use crate::shape::{Intrinsics, LANDMARKS, Observed, RotationPrior};
use crate::verifier::Confidence;
#[cfg(not(feature = "verifier"))]
use crate::verifier::geometric_confidence;

impl Tracker {
    /// Confidence of the last alignment.
    pub(super) fn verify(&self, model: &Model<'_>) -> Confidence {
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
        camera: &Intrinsics,
        confidence: &Confidence,
    ) -> Option<RotationPrior> {
        let (work, mean) = (&self.work, step.model.align.mean());
        let regression = &step.model.rotation;
        let prior = regression.predict(work.features(), work.view(), mean, shape, camera)?;
        let visible = confidence.visibility.iter().sum::<f32>() / LANDMARKS as f32;
        Some(RotationPrior {
            weight: ROTATION_PRIOR_WEIGHT * (1.0 - visible),
            ..prior
        })
    }

    /// Fits the 3D face, and on success updates target and result. Returns
    /// [`Outcome::Accept`] or a rejection.
    #[inline(never)]
    pub(super) fn accept(
        &mut self,
        step: &Step<'_>,
        shape: &Shape,
        origin: Origin,
        confidence: &mut Confidence,
    ) -> Outcome {
        let face = &step.model.face;
        let camera = &step.camera(&self.config);
        let weights = fit_weights(confidence);
        let undistorted = camera.undistorted(shape);
        let observed = Observed {
            points: &undistorted,
            weights: &weights,
        };
        let rotation = self.rotation_prior(step, shape, camera, confidence);
        let fit = self.target.fit(face, camera, &observed, rotation, origin);
        let Some(fit) = &fit else {
            return Outcome::Reject(Loss::NoPose);
        };
        // Without classifiers every alignment was accepted until here.
        #[cfg(not(feature = "verifier"))]
        {
            geometric_confidence(confidence, fit, camera);
            if confidence.face < self.target.min_fit_confidence(origin, step.now_us) {
                return Outcome::Reject(Loss::NoPose);
            }
        }
        if origin == Origin::NewFace {
            self.target.begin_identity();
            self.reacquirer.begin_identity();
        }
        let next = match confidence.face >= UNTRUSTED_KEEP_CONFIDENCE {
            true => shape,
            false => self.work.global_shape(),
        };
        self.target
            .move_to(step.now_us, next, fit, confidence.face, origin);
        self.target
            .update_identity(face, camera, &observed, fit, confidence.face);
        let fitted = Fitted {
            face,
            camera,
            shape,
            undistorted: &undistorted,
            confidence,
            fit,
            blur_px: self.target.motion.blur_px(),
        };
        write(&mut self.result, step.now_us, &fitted);
        Outcome::Accept
    }
}

/// Weights of the landmarks in the 3D fit.
fn fit_weights(confidence: &Confidence) -> [f32; LANDMARKS] {
    let mut weights = confidence.landmarks;
    for (weight, visibility) in weights.iter_mut().zip(&confidence.visibility) {
        let shown = FIT_WEIGHT_HIDDEN + (1.0 - FIT_WEIGHT_HIDDEN) * visibility;
        *weight = FIT_WEIGHT_MIN + *weight * shown;
    }
    weights
}
