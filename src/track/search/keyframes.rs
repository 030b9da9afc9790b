//! The keyframes of tracked faces, and everything that a build without the feature `keyframes`
//! lacks.
//!
//! A keyframe is added on trusted frames that bring something new, at most one per step. On the
//! step that loses the target, and on steps without a face after it, one window of the frame is
//! compared with the keyframes; a match is attempted like any candidate. Keyframes outlive a loss
//! and a new identity, because the person may come back. Those of a new identity replace the least
//! recently used.

use crate::align::Shape;
use crate::detect::Detection;
use crate::image::Frame;
use crate::track::align::Origin;
use crate::track::fit::Fitted;

#[cfg(feature = "keyframes")]
pub use kept::Keyframes;
#[cfg(not(feature = "keyframes"))]
pub use none::Keyframes;

/// A face whose keyframe matches this frame.
pub struct Match {
    /// Where its landmarks should be \[px\].
    pub shape: Shape,
    /// The target, or another face that was tracked before.
    pub origin: Origin,
    /// The keyframe.
    pub entry: usize,
}

#[cfg(feature = "keyframes")]
mod kept {
    use super::{Detection, Fitted, Frame, Match, Origin};
    use crate::keyframe::{Keyframes as Table, Observation, Query, SCRATCH_BYTES};
    use crate::network::ARENA;
    use crate::track::policy::TRUST_CONFIDENCE;

    // The reduced image is made in the networks' memory.
    const _: () = assert!(SCRATCH_BYTES <= ARENA);

    /// Keyframes of the faces that were tracked. Plain data, all zero when empty.
    #[derive(Clone)]
    pub struct Keyframes {
        table: Table,
        /// Counts the searches since a face was tracked: each takes another window of the frame.
        searches: u32,
    }

    impl Keyframes {
        pub const EMPTY: Keyframes = Keyframes {
            table: Table::EMPTY,
            searches: 0,
        };

        pub fn reset(&mut self) {
            self.searches = 0;
            self.forget();
        }

        /// Removes all keyframes.
        pub fn forget(&mut self) {
            self.table.clear();
        }

        /// Whether there is anything to search for, after a target was seen at this place.
        pub fn can_find(&self, last: &Detection) -> bool {
            last.size > 0.0 && !self.table.is_empty()
        }

        /// Compares one window of the frame with all keyframes.
        #[inline(never)]
        pub fn find(
            &mut self,
            frame: &Frame<'_>,
            last: &Detection,
            memory: &mut [u8],
        ) -> Option<Match> {
            let query = Query {
                size_px: last.size,
                roll: last.roll,
                attempt: self.searches,
            };
            self.searches = self.searches.wrapping_add(1);
            let found = self.table.query(frame, &query, memory)?;
            Some(Match {
                shape: found.shape,
                origin: match found.identity == self.table.identity() {
                    true => Origin::Reacquired,
                    false => Origin::NewFace,
                },
                entry: found.entry,
            })
        }

        /// The match was accepted: the tracked face has the identity of its keyframe.
        pub fn confirm(&mut self, entry: usize) {
            self.table.mark_used(entry);
        }

        /// A face of this size \[px\] is accepted on this frame. One that was tracked is added,
        /// if it is trusted and brings something new.
        pub fn accept(
            &mut self,
            frame: &Frame<'_>,
            fitted: &Fitted<'_>,
            origin: Origin,
            size_px: f32,
            memory: &mut [u8],
        ) {
            match origin {
                Origin::NewFace => self.table.new_identity(),
                Origin::Reacquired => {}
                Origin::Tracked => {
                    // The next search starts with the first window.
                    self.searches = 0;
                    self.add(frame, fitted, size_px, memory);
                }
            }
        }

        #[inline(never)]
        fn add(&mut self, frame: &Frame<'_>, fitted: &Fitted<'_>, size_px: f32, memory: &mut [u8]) {
            let confidence = fitted.confidence();
            let angles = fitted.fit.state.pose.facing_angles();
            let quality = confidence.face * confidence.visible_share();
            if confidence.face < TRUST_CONFIDENCE
                || self.table.entry_for(&angles, quality).is_none()
            {
                return;
            }
            let observation = Observation {
                shape: fitted.shape(),
                angles,
                size_px,
                quality,
            };
            self.table.add(frame, &observation, memory);
        }
    }
}

#[cfg(not(feature = "keyframes"))]
mod none {
    use super::{Detection, Fitted, Frame, Match, Origin};

    /// Keeps no keyframes and finds nothing.
    #[derive(Clone)]
    pub struct Keyframes;

    impl Keyframes {
        pub const EMPTY: Keyframes = Keyframes;

        pub fn reset(&mut self) {}

        pub fn forget(&mut self) {}

        pub fn can_find(&self, _: &Detection) -> bool {
            false
        }

        pub fn find(&mut self, _: &Frame<'_>, _: &Detection, _: &mut [u8]) -> Option<Match> {
            None
        }

        pub fn confirm(&mut self, _: usize) {}

        pub fn accept(&mut self, _: &Frame<'_>, _: &Fitted<'_>, _: Origin, _: f32, _: &mut [u8]) {}
    }
}
