//! What is known of the tracked face, and how much doubt it may bear.

use super::motion::Motion;
use crate::align::Shape;
use crate::shape::{FaceFit, FaceState, IdentityEstimator, LANDMARKS, MAX_IDENTITIES};
use crate::verifier::Appearance;

/// Only frames at least this sure teach who it is.
pub(super) const TRUST: f32 = 0.9;
/// A candidate becomes the tracked face from this probability on.
pub(super) const ACCEPT: f32 = 0.8;
/// A face that was never sure is given up below this probability: without a step between the two,
/// one at the edge would come and go. Below it the fine stages' answer leads nowhere.
pub(super) const STAY: f32 = 0.5;
/// A face that was sure once is given up below this probability: a fit that was right a frame ago
/// deserves more trust than one out of the blue.
const KEEP: f32 = 0.02;
/// … and below this one while so many of its landmarks look like themselves: something covers the
/// others.
const KEEP_RECOGNISED: f32 = 0.003;
const RECOGNISED: u32 = 8;
/// How long a face may be in doubt without being recognised \[µs\], longer than a blink: what is left
/// where somebody was may resemble a face a little for as long as it is looked at. One that was never sure
/// is in doubt below what it was accepted from: a thing in the background may have passed for it once.
const DOUBTED_US: i64 = 250_000;
/// So many trusted frames teach the identity one by one.
const IDENTITY_FRAMES: u32 = 30;
/// Of the trusted frames after those, one in so many refines it.
const REFINED_EVERY: u32 = 4;

/// Whose face a shape is, and what to fit the 3D face from.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Whose {
    /// Nobody's that is known.
    Stranger,
    /// The subject's, lost for a while: the identity holds, the pose does not.
    Lost,
    /// The subject's, tracked from the frame before.
    Tracked,
}

/// What is known of the tracked face. Edited in place: it takes much of a small stack.
#[derive(Clone)]
pub(super) struct Subject {
    /// Where the next frame starts from.
    pub(super) shape: Shape,
    /// Where the last frame's crop was placed.
    pub(super) guess: Shape,
    pub(super) motion: Motion,
    /// The 3D face of the last fit.
    pub(super) face: FaceState,
    pub(super) identity: IdentityEstimator,
    /// How the person's landmarks look.
    pub(super) person: Appearance,
    /// When it was last fitted \[µs\].
    pub(super) fitted_us: i64,
    /// Whether it was sure at least once since it was found: only then may it become as doubtful as
    /// a covered face is.
    trusted: bool,
    /// Frames that were sure since it was found.
    trusted_frames: u32,
    /// When it was last not in doubt, or recognised \[µs\].
    known_us: i64,
}

impl Subject {
    pub(super) const EMPTY: Subject = Subject {
        shape: [[0.0; 2]; LANDMARKS],
        guess: [[0.0; 2]; LANDMARKS],
        motion: Motion::STILL,
        face: FaceState::EMPTY,
        // Renewed for every stranger; zero until then, as all of `Tracker::EMPTY`.
        identity: IdentityEstimator::with_memory(0.0),
        person: Appearance::EMPTY,
        fitted_us: 0,
        trusted: false,
        trusted_frames: 0,
        known_us: 0,
    };

    /// Probability below which the face counts as lost, when so many landmarks look like themselves.
    pub(super) fn keep(&self, recognised: u32, now: i64) -> f32 {
        let doubted = now.saturating_sub(self.known_us) > DOUBTED_US;
        // Without `adaptation` nobody is recognised, and a covered face would be given up too; without
        // `experts` these are no probabilities.
        let (experts, adaptation) = (cfg!(feature = "verifier"), cfg!(feature = "adaptation"));
        match self.trusted {
            true if recognised >= RECOGNISED => KEEP_RECOGNISED,
            true if !(doubted && experts && adaptation) => KEEP,
            false if doubted && experts => ACCEPT,
            _ => STAY,
        }
    }

    /// So many of its landmarks look like themselves on this frame.
    pub(super) fn recognise(&mut self, recognised: u32, now: i64) {
        if recognised >= RECOGNISED {
            self.known_us = now;
        }
    }

    /// Whether it was sure at least once since it was found.
    pub(super) fn is_trusted(&self) -> bool {
        self.trusted
    }

    /// Somebody else from here on, of whom nothing is known.
    pub(super) fn become_stranger(&mut self) {
        self.identity = IdentityEstimator::new();
        self.person = Appearance::EMPTY;
        self.trusted_frames = 0;
        self.trusted = false;
    }

    /// The same face, of which nothing is known any more.
    pub(super) fn forget_identity(&mut self) {
        self.identity = IdentityEstimator::new();
        self.person = Appearance::EMPTY;
        self.face.identity = [0.0; MAX_IDENTITIES];
    }

    /// Goes where the face is on this frame, with a probability of `face`. The next frame starts from `shape`.
    pub(super) fn move_to(
        &mut self,
        now: i64,
        shape: &Shape,
        fitted: &FaceFit,
        face: f32,
        whose: Whose,
    ) {
        self.motion = match whose {
            Whose::Tracked => {
                let elapsed_us = now.saturating_sub(self.fitted_us);
                Motion::between(&self.shape, shape, elapsed_us)
            }
            Whose::Stranger | Whose::Lost => Motion::STILL,
        };
        if whose != Whose::Tracked {
            // From here on the crop moves as little as it can.
            self.guess = *shape;
        }
        self.shape = *shape;
        self.fitted_us = now;
        self.face = fitted.state;
        self.trusted |= face >= TRUST;
        if face >= if self.trusted { STAY } else { ACCEPT } {
            self.known_us = now;
        }
        self.trusted_frames = self.trusted_frames.wrapping_add(u32::from(face >= TRUST));
    }

    /// Whether the frame that it has moved to, with a probability of `face`, teaches the identity.
    pub(super) fn learns(&self, face: f32) -> bool {
        face >= TRUST
            && (self.identity.frames() < IDENTITY_FRAMES
                || self.trusted_frames.is_multiple_of(REFINED_EVERY))
    }
}

#[cfg(all(test, feature = "verifier", feature = "adaptation"))]
mod tests {
    use super::*;

    #[test]
    fn a_doubted_face_is_kept_for_a_while_and_longer_where_it_is_recognised() {
        let stranger = Subject {
            known_us: 1_000_000,
            ..Subject::EMPTY
        };
        let subject = Subject {
            trusted: true,
            ..stranger.clone()
        };
        let (soon, late) = (1_000_000 + DOUBTED_US, 1_000_001 + DOUBTED_US);
        assert_eq!(stranger.keep(0, soon), STAY);
        assert_eq!(stranger.keep(RECOGNISED, late), ACCEPT);
        assert_eq!(subject.keep(0, soon), KEEP);
        assert_eq!(subject.keep(0, late), STAY);
        assert_eq!(subject.keep(RECOGNISED - 1, late), STAY);
        assert_eq!(subject.keep(RECOGNISED, late), KEEP_RECOGNISED);
    }
}
