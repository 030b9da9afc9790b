//! The last part of every attempt: the 3D face is fitted to the aligned landmarks. If a pose
//! explains them, they become the target's, and the result is written.

use super::Loss;
use super::Tracker;
use super::alignment::Alignment;
use super::output::{Fitted, write};
use super::policy::{
    ANCHOR_MIN_FACING, CUT_SURROUNDINGS, FIT_WEIGHT_HIDDEN, FIT_WEIGHT_MIN, SURROUNDINGS,
    TRUST_CONFIDENCE, UNTRUSTED_KEEP_CONFIDENCE,
};
use super::step::{Outcome, Step};
use super::target::Origin;
use crate::shape::{LANDMARKS, Observed};
use crate::verifier::Confidence;
#[cfg(not(feature = "verifier"))]
use crate::verifier::geometric_confidence;

impl Tracker {
    /// Fits the 3D face to the alignment, and on success updates target and result. Returns
    /// [`Outcome::Accept`] or a rejection.
    #[inline(never)]
    pub(super) fn accept(&mut self, step: &Step<'_>, origin: Origin) -> Outcome {
        let Alignment {
            shape,
            global_shape,
            rotation,
            confidence,
            ..
        } = &mut self.alignment;
        let face = &step.model.face;
        let camera = &step.camera(&self.config);
        let weights = fit_weights(confidence);
        let undistorted = camera.undistorted(shape);
        let observed = Observed {
            points: &undistorted,
            weights: &weights,
        };
        let fit = self.target.fit(face, camera, &observed, *rotation, origin);
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
            true => &*shape,
            false => &*global_shape,
        };
        self.target.last.set(shape, step.frame, CUT_SURROUNDINGS);
        let faces_camera = fit.state.pose.facing_cosine() >= ANCHOR_MIN_FACING;
        if faces_camera && confidence.face >= TRUST_CONFIDENCE {
            self.target.anchor.set(shape, step.frame, SURROUNDINGS);
        } else if !faces_camera && confidence.face >= UNTRUSTED_KEEP_CONFIDENCE {
            self.target.anchor.clear();
        }
        self.target
            .move_to(step.now_us, next, fit, confidence.face, origin);
        self.target
            .update_identity(face, camera, &observed, fit, confidence.face);
        let fitted = Fitted {
            face,
            camera,
            camera_assumed: self.config.intrinsics.is_none(),
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
