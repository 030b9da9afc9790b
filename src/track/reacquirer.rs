//! The keyframes of tracked faces, and everything that a build without the feature `keyframes`
//! lacks.

use super::TrackResult;
use super::scanner::LastSeen;
use super::step::Step;
use super::target::Origin;
use crate::align::Shape;
use crate::image::Frame;

#[cfg(feature = "keyframes")]
pub(super) use keyframes::Reacquirer;
#[cfg(not(feature = "keyframes"))]
pub(super) use none::Reacquirer;

/// A face whose keyframe matches this frame.
pub(super) struct Match<Entry> {
    /// Where its landmarks should be \[px\].
    pub(super) shape: Shape,
    /// The target, or another face that was tracked before.
    pub(super) origin: Origin,
    entry: Entry,
}

#[cfg(feature = "keyframes")]
mod keyframes {
    use super::super::geometry::detection_of;
    use super::super::policy::TRUST_CONFIDENCE;
    use super::{Frame, LastSeen, Match, Origin, Shape, Step, TrackResult};
    use crate::keyframe::{KeyframeMatch, Keyframes, Observation, Query};
    use crate::math::HeadAngles;

    /// Keyframes of the faces that were tracked. Plain data, all zero when empty.
    #[derive(Clone)]
    pub struct Reacquirer {
        keyframes: Keyframes,
        /// Counts the searches since a face was tracked: each takes another window of the frame.
        searches: u32,
    }

    impl Reacquirer {
        pub const EMPTY: Reacquirer = Reacquirer {
            keyframes: Keyframes::EMPTY,
            searches: 0,
        };

        pub fn reset(&mut self) {
            self.searches = 0;
            self.forget();
        }

        /// Removes all keyframes.
        pub fn forget(&mut self) {
            self.keyframes.clear();
        }

        /// A face is tracked on this frame: the next search starts with the first window.
        pub fn tracked(&mut self) {
            self.searches = 0;
        }

        /// The tracked face is a new identity.
        pub fn begin_identity(&mut self) {
            self.keyframes.new_identity();
        }

        /// Whether there is anything to search for.
        pub fn can_find(&self, last_seen: &LastSeen) -> bool {
            last_seen.size_px > 0.0 && !self.keyframes.is_empty()
        }

        pub fn find(
            &mut self,
            frame: &Frame<'_>,
            last_seen: &LastSeen,
            memory: &mut [u8],
        ) -> Option<Match<KeyframeMatch>> {
            let query = Query {
                size_px: last_seen.size_px,
                roll: last_seen.roll,
                attempt: self.searches,
            };
            self.searches = self.searches.wrapping_add(1);
            let entry = self.keyframes.query(frame, &query, memory)?;
            Some(Match {
                shape: entry.shape,
                origin: match entry.identity == self.keyframes.identity() {
                    true => Origin::Reacquired,
                    false => Origin::NewFace,
                },
                entry,
            })
        }

        /// The match was accepted: the tracked face has the identity of its keyframe.
        pub fn confirm(&mut self, found: &Match<KeyframeMatch>) {
            self.keyframes.mark_used(&found.entry);
        }

        pub fn add(
            &mut self,
            step: &Step<'_>,
            result: &TrackResult,
            shape: &Shape,
            memory: &mut [u8],
        ) {
            let angles = HeadAngles {
                yaw_deg: result.facing_yaw_deg,
                pitch_deg: result.facing_pitch_deg,
                roll_deg: result.facing_roll_deg,
            };
            let quality = result.confidence * result.visible_share;
            if result.confidence < TRUST_CONFIDENCE
                || self.keyframes.entry_for(&angles, quality).is_none()
            {
                return;
            }
            let observation = Observation {
                shape,
                angles,
                size_px: detection_of(step.model, shape).size,
                quality,
            };
            self.keyframes.add(step.frame, &observation, memory);
        }
    }
}

#[cfg(not(feature = "keyframes"))]
mod none {
    use super::{Frame, LastSeen, Match, Shape, Step, TrackResult};
    use core::convert::Infallible;

    /// Keeps no keyframes and finds nothing.
    #[derive(Clone)]
    pub struct Reacquirer;

    impl Reacquirer {
        pub const EMPTY: Reacquirer = Reacquirer;

        pub fn reset(&mut self) {}

        pub fn forget(&mut self) {}

        pub fn tracked(&mut self) {}

        pub fn begin_identity(&mut self) {}

        pub fn can_find(&self, _: &LastSeen) -> bool {
            false
        }

        pub fn find(
            &mut self,
            _: &Frame<'_>,
            _: &LastSeen,
            _: &mut [u8],
        ) -> Option<Match<Infallible>> {
            None
        }

        pub fn confirm(&mut self, found: &Match<Infallible>) {
            match found.entry {}
        }

        pub fn add(&mut self, _: &Step<'_>, _: &TrackResult, _: &Shape, _: &mut [u8]) {}
    }
}
