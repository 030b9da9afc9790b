//! What is known of the tracked face, and the confidence below which it is lost.

use super::anchor::Anchor;
use super::appearance::Appearance;
use super::glasses::Glasses;
use super::motion::{Motion, damped};
use super::natural_gaze::NaturalGaze;
use super::policy::{
    ACCEPT_CONFIDENCE, COVERED_US, IDENTITY_FRAMES, IDENTITY_PERIOD, LOW_CONFIDENCE_US,
    RECOGNISED_KEEP_CONFIDENCE, RECOGNISED_LANDMARKS, TRUST_CONFIDENCE, TRUSTED_KEEP_CONFIDENCE,
    UNTRUSTED_KEEP_CONFIDENCE,
};
use crate::align::Shape;
use crate::shape::{
    FRAME_WEIGHT, FaceFit, FaceModel, FaceState, FitOptions, IdentityEstimator, Intrinsics,
    LANDMARKS, MAX_IDENTITIES, Observed, RotationPrior, fit,
};

/// Where a face on this frame comes from: what is known of it when the 3D face is fitted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// A new identity: nothing is known.
    NewFace,
    /// The target, lost for a while: its identity is known, its pose is not.
    Reacquired,
    /// The target, tracked from the frame before: identity and pose are known.
    Tracked,
}

/// The tracked face. Edited in place, because it would take much of a small stack.
#[derive(Clone)]
pub(super) struct Target {
    /// Landmarks of the last fit, from which the next frame's are predicted.
    pub(super) shape: Shape,
    /// Initial shape of the last alignment: where the crop was.
    initial_shape: Shape,
    pub(super) motion: Motion,
    /// Pose, animation and identity of the last fit.
    face: FaceState,
    identity: IdentityEstimator,
    pub(super) appearance: Appearance,
    /// Of the last trusted frame.
    pub(super) anchor: Anchor,
    /// Of the last frame.
    pub(super) last: Anchor,
    /// When it was last fitted \[µs\].
    pub(super) fitted_us: i64,
    /// Whether a frame was trusted since this identity began. Only then may the confidence fall as
    /// low as that of a covered face, and only then does the tracker coast.
    is_trusted: bool,
    /// Trusted frames since this identity began.
    trusted_frames: u32,
    /// When it last had high confidence or was recognised \[µs\].
    confirmed_us: i64,
    pub(super) natural_gaze: NaturalGaze,
    pub(super) glasses: Glasses,
}

impl Target {
    pub(super) const EMPTY: Target = Target {
        shape: [[0.0; 2]; LANDMARKS],
        initial_shape: [[0.0; 2]; LANDMARKS],
        motion: Motion::STILL,
        face: FaceState::EMPTY,
        // Replaced with every new identity; zero until then, as all of `Tracker::EMPTY`.
        identity: IdentityEstimator::with_memory(0.0),
        appearance: Appearance::EMPTY,
        anchor: Anchor::EMPTY,
        last: Anchor::EMPTY,
        fitted_us: 0,
        is_trusted: false,
        trusted_frames: 0,
        confirmed_us: 0,
        natural_gaze: NaturalGaze::UNKNOWN,
        glasses: Glasses::NONE,
    };

    pub(super) fn is_trusted(&self) -> bool {
        self.is_trusted
    }

    /// Initial shape of the next alignment.
    pub(super) fn predict(&self, now_us: i64) -> Shape {
        let elapsed_us = now_us.saturating_sub(self.fitted_us);
        let predicted = self.motion.predict(&self.shape, elapsed_us);
        damped(&self.initial_shape, &predicted)
    }

    /// Confidence below which the target is lost, when so many landmarks are recognised.
    pub(super) fn min_confidence(&self, recognised: u32, now_us: i64) -> f32 {
        let is_late = now_us.saturating_sub(self.confirmed_us) > LOW_CONFIDENCE_US;
        // Without `verifier` confidences are no probabilities and nothing is recognised, so that a
        // covered face would be lost too.
        let verifier = cfg!(feature = "verifier");
        match self.is_trusted {
            true if recognised >= RECOGNISED_LANDMARKS => RECOGNISED_KEEP_CONFIDENCE,
            true if !(is_late && verifier) => TRUSTED_KEEP_CONFIDENCE,
            false if is_late && verifier => ACCEPT_CONFIDENCE,
            _ => UNTRUSTED_KEEP_CONFIDENCE,
        }
    }

    /// Whether low confidence may yet be that of a covered face.
    pub(super) fn may_be_covered(&self, now_us: i64) -> bool {
        self.is_trusted && now_us.saturating_sub(self.confirmed_us) <= COVERED_US
    }

    /// Confidence by geometry alone from which a fit is accepted.
    #[cfg(not(feature = "verifier"))]
    pub(super) fn min_fit_confidence(&self, origin: Origin, now_us: i64) -> f32 {
        match origin {
            Origin::Tracked => self.min_confidence(0, now_us),
            Origin::NewFace | Origin::Reacquired => ACCEPT_CONFIDENCE,
        }
    }

    /// The target was tracked on this frame from this initial shape, with so many landmarks
    /// recognised.
    pub(super) fn tracked(&mut self, initial_shape: &Shape, recognised: u32, now_us: i64) {
        self.initial_shape = *initial_shape;
        if recognised >= RECOGNISED_LANDMARKS {
            self.confirmed_us = now_us;
        }
    }

    /// A new identity from here on.
    pub(super) fn begin_identity(&mut self) {
        self.identity = IdentityEstimator::new();
        self.appearance = Appearance::EMPTY;
        self.natural_gaze = NaturalGaze::UNKNOWN;
        self.glasses = Glasses::NONE;
        self.anchor.clear();
        self.trusted_frames = 0;
        self.is_trusted = false;
    }

    /// Forgets identity and appearance; the face goes on being tracked.
    pub(super) fn forget_identity(&mut self) {
        self.identity = IdentityEstimator::new();
        self.appearance = Appearance::EMPTY;
        self.natural_gaze = NaturalGaze::UNKNOWN;
        self.glasses = Glasses::NONE;
        self.face.identity = [0.0; MAX_IDENTITIES];
    }

    /// Fits the 3D face. `None` when no pose explains the landmarks.
    pub(super) fn fit(
        &self,
        face: &FaceModel<'_>,
        camera: &Intrinsics,
        observed: &Observed<'_>,
        rotation: Option<RotationPrior>,
        origin: Origin,
    ) -> Option<FaceFit> {
        let start = (origin == Origin::Tracked).then_some(&self.face);
        let identity = match origin {
            Origin::NewFace => [0.0; MAX_IDENTITIES],
            Origin::Reacquired | Origin::Tracked => self.face.identity,
        };
        let options = FitOptions {
            rotation,
            ..FitOptions::default()
        };
        fit(face, camera, observed, start, &identity, &options)
    }

    /// Moves to a fit of this confidence. The next frame's shape is predicted from `shape`.
    pub(super) fn move_to(
        &mut self,
        now_us: i64,
        shape: &Shape,
        fit: &FaceFit,
        confidence: f32,
        origin: Origin,
    ) {
        self.motion = match origin {
            Origin::Tracked => {
                let elapsed_us = now_us.saturating_sub(self.fitted_us);
                Motion::between(&self.shape, shape, elapsed_us)
            }
            Origin::NewFace | Origin::Reacquired => {
                self.initial_shape = *shape;
                Motion::STILL
            }
        };
        self.shape = *shape;
        self.fitted_us = now_us;
        self.face = fit.state;
        let is_trusted_frame = confidence >= TRUST_CONFIDENCE;
        self.is_trusted |= is_trusted_frame;
        self.trusted_frames = self
            .trusted_frames
            .wrapping_add(u32::from(is_trusted_frame));
        let high = match self.is_trusted {
            true => UNTRUSTED_KEEP_CONFIDENCE,
            false => ACCEPT_CONFIDENCE,
        };
        if confidence >= high {
            self.confirmed_us = now_us;
        }
    }

    /// Adds the fit that it has moved to, of this confidence, to the identity, if the frame is
    /// trusted and due.
    pub(super) fn update_identity(
        &mut self,
        face: &FaceModel<'_>,
        camera: &Intrinsics,
        observed: &Observed<'_>,
        fit: &FaceFit,
        confidence: f32,
    ) {
        let is_due = self.identity.frames() < IDENTITY_FRAMES
            || self.trusted_frames.is_multiple_of(IDENTITY_PERIOD);
        if confidence >= TRUST_CONFIDENCE && is_due {
            self.identity.add(face, camera, observed, fit, FRAME_WEIGHT);
            self.face.identity = self.identity.estimate();
        }
    }
}

#[cfg(all(test, feature = "verifier"))]
mod tests {
    use super::*;

    #[test]
    fn low_confidence_is_kept_for_a_while_and_longer_where_the_target_is_recognised() {
        let untrusted = Target {
            confirmed_us: 1_000_000,
            ..Target::EMPTY
        };
        let trusted = Target {
            is_trusted: true,
            ..untrusted.clone()
        };
        let soon = 1_000_000 + LOW_CONFIDENCE_US;
        let late = soon + 1;
        let most = RECOGNISED_LANDMARKS;
        assert_eq!(untrusted.min_confidence(0, soon), UNTRUSTED_KEEP_CONFIDENCE);
        assert_eq!(untrusted.min_confidence(most, late), ACCEPT_CONFIDENCE);
        assert_eq!(trusted.min_confidence(0, soon), TRUSTED_KEEP_CONFIDENCE);
        for recognised in [0, most - 1] {
            let kept = trusted.min_confidence(recognised, late);
            assert_eq!(kept, UNTRUSTED_KEEP_CONFIDENCE);
        }
        let kept = trusted.min_confidence(most, late);
        assert_eq!(kept, RECOGNISED_KEEP_CONFIDENCE);
    }
}
