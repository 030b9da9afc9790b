//! What is known of the tracked face, and the confidence below which it is lost.

use super::anchor::Anchor;
use super::appearance::Appearance;
use super::motion::{Motion, damped};
use crate::align::Shape;
use crate::detect::Detection;
#[cfg(feature = "mesh")]
use crate::shape::Intrinsics;
use crate::shape::{
    FRAME_WEIGHT, FaceState, Guess, IdentityEstimator, LANDMARKS, Likeness, MAX_IDENTITIES,
};
use crate::track::align::Origin;
use crate::track::eyes::PersonsEyes;
use crate::track::fit::{Fitted, Prior};
use crate::track::geometry::{detection_of, face_width};
use crate::track::policy::{
    ACCEPT_CONFIDENCE, ANCHOR_MIN_FACING, COVERED_US, CUT_SURROUNDINGS, FAST_MOTION,
    IDENTITY_FRAMES, LOW_CONFIDENCE_US, OTHER_EVIDENCE, RECOGNISED_KEEP_CONFIDENCE,
    RECOGNISED_LANDMARKS, SAME_EVIDENCE, SURROUNDINGS, TRUST_CONFIDENCE, TRUSTED_KEEP_CONFIDENCE,
    TURNED_COSINE, TURNED_LOW_CONFIDENCE_US, UNTRUSTED_KEEP_CONFIDENCE, identity_period,
};
use crate::track::step::Step;
use crate::track::weights::PersonsRest;

/// The tracked face. Edited in place, because it would take much of a small stack.
#[derive(Clone)]
pub struct Target {
    /// Landmarks of the last fit, from which the next frame's are predicted.
    shape: Shape,
    /// The same as the detector would report them.
    pub place: Detection,
    /// Initial shape of the last alignment: where the crop was.
    initial_shape: Shape,
    motion: Motion,
    /// Pose, animation and identity of the last fit.
    pub face: FaceState,
    /// The camera of that fit.
    #[cfg(feature = "mesh")]
    pub camera: Intrinsics,
    identity: IdentityEstimator,
    /// Whom every new face is guessed to be.
    guess: Option<Guess>,
    pub(super) appearance: Appearance,
    /// Of the last trusted frame.
    pub(super) anchor: Anchor,
    /// Of the last frame.
    pub(super) last: Anchor,
    /// When it was last fitted \[µs\].
    pub fitted_us: i64,
    /// Whether a frame was trusted since this identity began. Only then may the confidence fall as
    /// low as that of a covered face, and only then does the tracker coast.
    is_trusted: bool,
    /// Trusted frames since this identity began.
    trusted_frames: u32,
    /// When it last had high confidence or was recognised \[µs\].
    confirmed_us: i64,
    /// What is learnt of this person's eyes.
    pub eyes: PersonsEyes,
    /// The weights of this person's face at rest.
    pub rest: PersonsRest,
}

impl Target {
    pub const EMPTY: Target = Target {
        shape: [[0.0; 2]; LANDMARKS],
        place: Detection::NONE,
        initial_shape: [[0.0; 2]; LANDMARKS],
        motion: Motion::STILL,
        face: FaceState::EMPTY,
        #[cfg(feature = "mesh")]
        camera: Intrinsics::new(0.0, 0.0, 0.0, 0.0),
        // Replaced with every new identity; zero until then, as all of `Tracker::EMPTY`.
        identity: IdentityEstimator::with_memory(0.0),
        guess: None,
        appearance: Appearance::EMPTY,
        anchor: Anchor::EMPTY,
        last: Anchor::EMPTY,
        fitted_us: 0,
        is_trusted: false,
        trusted_frames: 0,
        confirmed_us: 0,
        eyes: PersonsEyes::UNKNOWN,
        rest: PersonsRest::UNKNOWN,
    };

    pub fn is_trusted(&self) -> bool {
        self.is_trusted
    }

    /// Where the face was last trusted, if it may be covered there.
    pub fn anchor(&self) -> Option<&Shape> {
        self.anchor.shape().filter(|_| self.is_trusted)
    }

    /// How far the face moves while a frame is exposed, at most \[px\].
    pub fn blur_px(&self) -> f32 {
        self.motion.blur_px()
    }

    /// Whether it moves too fast for what a network has changed on an earlier frame.
    pub fn is_fast(&self) -> bool {
        self.blur_px() > FAST_MOTION * face_width(&self.shape)
    }

    /// Initial shape of the next alignment.
    pub fn predict(&self, now_us: i64) -> Shape {
        let elapsed_us = now_us.saturating_sub(self.fitted_us);
        let predicted = self.motion.predict(&self.shape, elapsed_us);
        damped(&self.initial_shape, &predicted)
    }

    /// Confidence below which the target is lost, when `recognised` landmarks are.
    pub fn min_confidence(&self, recognised: u32, now_us: i64) -> f32 {
        let is_turned = self.is_trusted && self.face.pose.facing_cosine() < TURNED_COSINE;
        let long_us = match is_turned {
            true => TURNED_LOW_CONFIDENCE_US,
            false => LOW_CONFIDENCE_US,
        };
        let is_late = now_us.saturating_sub(self.confirmed_us) > long_us;
        match self.is_trusted {
            true if recognised >= RECOGNISED_LANDMARKS => RECOGNISED_KEEP_CONFIDENCE,
            true if !is_late => TRUSTED_KEEP_CONFIDENCE,
            false if is_late => ACCEPT_CONFIDENCE,
            _ => UNTRUSTED_KEEP_CONFIDENCE,
        }
    }

    /// Whether low confidence may yet be that of a covered face.
    pub fn may_be_covered(&self, now_us: i64) -> bool {
        self.is_trusted && now_us.saturating_sub(self.confirmed_us) <= COVERED_US
    }

    /// A new identity from here on.
    pub fn begin_identity(&mut self) {
        self.identity = IdentityEstimator::new();
        if let Some(guess) = &self.guess {
            self.identity.guess(guess);
        }
        self.appearance = Appearance::EMPTY;
        self.eyes = PersonsEyes::UNKNOWN;
        self.rest = PersonsRest::UNKNOWN;
        self.anchor.clear();
        self.trusted_frames = 0;
        self.is_trusted = false;
    }

    /// Forgets identity and appearance; the face goes on being tracked.
    pub fn forget_identity(&mut self) {
        self.identity = IdentityEstimator::new();
        self.guess = None;
        self.appearance = Appearance::EMPTY;
        self.eyes = PersonsEyes::UNKNOWN;
        self.rest = PersonsRest::UNKNOWN;
        self.face.identity = [0.0; MAX_IDENTITIES];
    }

    /// Guesses that this face, and every new one, is that of a record.
    pub fn guess(&mut self, guess: &Guess) {
        self.guess = Some(*guess);
        self.identity.guess(guess);
        self.face.identity = self.identity.estimate();
    }

    /// Forgets the guess; what of it counts for this face stays.
    pub fn forget_guess(&mut self) {
        self.guess = None;
    }

    /// What was learnt of the head; nothing before the first trusted frame.
    pub fn learnt(&self) -> Option<Guess> {
        let is_known = self.face.is_fitted() && self.identity.frames() > 0;
        is_known.then(|| self.identity.learnt())
    }

    /// How much what was seen speaks for the person of a record.
    pub fn evidence(&self, guess: &Guess) -> f32 {
        self.identity.evidence(guess)
    }

    /// Whether the head has the shape of that of a record, by what was seen of it alone.
    pub fn likeness(&self, guess: &Guess) -> Likeness {
        let evidence = self.evidence(guess);
        match self.identity.frames() {
            0..IDENTITY_FRAMES => Likeness::Unknown,
            _ if !self.face.is_fitted() => Likeness::Unknown,
            _ if evidence >= SAME_EVIDENCE => Likeness::Same,
            _ if evidence <= OTHER_EVIDENCE => Likeness::Other,
            _ => Likeness::Unknown,
        }
    }

    /// What is known of the face before it is fitted.
    pub fn prior(&self, origin: Origin) -> Prior<'_> {
        Prior {
            start: (origin == Origin::Tracked).then_some(&self.face),
            start_us: self.fitted_us,
            identity: match origin {
                Origin::NewFace => self.guess.map_or([0.0; MAX_IDENTITIES], |guess| guess.mean),
                Origin::Reacquired | Origin::Tracked => self.face.identity,
            },
        }
    }

    /// Moves to a face that is fitted on this frame.
    #[inline(never)]
    pub fn accept(&mut self, step: &Step<'_>, fitted: &Fitted<'_>, origin: Origin) {
        if origin == Origin::NewFace {
            self.begin_identity();
        }
        self.set_anchors(step, fitted);
        self.move_to(step, fitted, origin);
        self.confirm(step, fitted);
        self.update_identity(fitted);
    }

    /// Takes what surrounds the face.
    fn set_anchors(&mut self, step: &Step<'_>, fitted: &Fitted<'_>) {
        let (shape, confidence) = (fitted.shape(), fitted.confidence().face);
        self.last.set(shape, step.frame, CUT_SURROUNDINGS);
        let faces_camera = fitted.fit.state.pose.facing_cosine() >= ANCHOR_MIN_FACING;
        if faces_camera && confidence >= TRUST_CONFIDENCE {
            self.anchor.set(shape, step.frame, SURROUNDINGS);
        } else if !faces_camera && confidence >= UNTRUSTED_KEEP_CONFIDENCE {
            self.anchor.clear();
        }
    }

    /// Takes place, motion and pose. The refiners of a covered face move its eyes anywhere, so the
    /// next frame is not predicted from them.
    fn move_to(&mut self, step: &Step<'_>, fitted: &Fitted<'_>, origin: Origin) {
        let aligned = fitted.aligned;
        let shape = match fitted.confidence().face >= UNTRUSTED_KEEP_CONFIDENCE {
            true => &aligned.shape,
            false => &aligned.global_shape,
        };
        (self.motion, self.initial_shape) = match origin {
            Origin::Tracked => {
                let elapsed_us = step.now_us.saturating_sub(self.fitted_us);
                let motion = Motion::between(&self.shape, shape, elapsed_us);
                (motion, aligned.start)
            }
            Origin::NewFace | Origin::Reacquired => (Motion::STILL, *shape),
        };
        self.shape = *shape;
        self.place = detection_of(step.model, shape);
        self.fitted_us = step.now_us;
        self.face = fitted.fit.state;
        #[cfg(feature = "mesh")]
        {
            self.camera = *fitted.camera;
        }
    }

    /// Takes how sure it is that this is a face, and the same one.
    fn confirm(&mut self, step: &Step<'_>, fitted: &Fitted<'_>) {
        let confidence = fitted.confidence().face;
        let is_trusted_frame = confidence >= TRUST_CONFIDENCE;
        self.is_trusted |= is_trusted_frame;
        self.trusted_frames = self
            .trusted_frames
            .wrapping_add(u32::from(is_trusted_frame));
        let high = match self.is_trusted {
            true => UNTRUSTED_KEEP_CONFIDENCE,
            false => ACCEPT_CONFIDENCE,
        };
        if confidence >= high || fitted.aligned.recognised >= RECOGNISED_LANDMARKS {
            self.confirmed_us = step.now_us;
        }
    }

    /// Adds the fit that it has moved to to the identity, if the frame is trusted and due.
    fn update_identity(&mut self, fitted: &Fitted<'_>) {
        let period = identity_period(self.identity.frames());
        let is_due = self.trusted_frames.is_multiple_of(period);
        if fitted.confidence().face >= TRUST_CONFIDENCE && is_due {
            let (face, camera, observed) = (fitted.face, fitted.camera, fitted.aligned.observed());
            (self.identity).add(face, camera, &observed, fitted.fit, FRAME_WEIGHT);
            self.face.identity = self.identity.estimate();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat3, Vec3};

    /// A trusted target, last confirmed after a second, whose head is turned by so much.
    fn turned(yaw_deg: f32) -> Target {
        let mut target = Target {
            confirmed_us: 1_000_000,
            is_trusted: true,
            ..Target::EMPTY
        };
        target.face.pose.rotation = Mat3::from_rotation_y(yaw_deg.to_radians());
        target.face.pose.translation_mm = 500.0 * Vec3::Z;
        target
    }

    #[test]
    fn low_confidence_is_kept_for_a_while_and_longer_where_the_target_is_recognised() {
        let trusted = turned(0.0);
        let untrusted = Target {
            is_trusted: false,
            ..trusted.clone()
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

    #[test]
    fn low_confidence_is_kept_longer_of_a_head_that_is_turned_away() {
        let late = 1_000_001 + LOW_CONFIDENCE_US;
        let kept = |yaw_deg, now_us| turned(yaw_deg).min_confidence(0, now_us);
        assert_eq!(kept(55.0, late), UNTRUSTED_KEEP_CONFIDENCE);
        for yaw_deg in [65.0, -85.0, 95.0] {
            assert_eq!(kept(yaw_deg, late), TRUSTED_KEEP_CONFIDENCE);
            let too_late = 1_000_001 + TURNED_LOW_CONFIDENCE_US;
            assert_eq!(kept(yaw_deg, too_late), UNTRUSTED_KEEP_CONFIDENCE);
        }
        let untrusted = Target {
            is_trusted: false,
            ..turned(65.0)
        };
        assert_eq!(untrusted.min_confidence(0, late), ACCEPT_CONFIDENCE);
    }
}
