//! Several trackers on the same frames: each follows a face of its own.
//!
//! On each frame, trackers that have a face go first. The others leave these faces alone. Of them,
//! those search that lost their face a moment ago, so that a person keeps the tracker; where there
//! is none, and none coasts, new faces are listed by one scan for all, and each is given to a
//! tracker without a face. Where two trackers are on the same face, the one with the smaller claim
//! has slid onto it, mostly from a face that went behind it: it gives it back. A claim is the
//! recent mean of confidence times visible share.
//!
//! What does not depend on the face is done once: the measure of noise, and the scan. Of the
//! trackers that have a face, one runs all networks on a frame, by turns; the others hold what some
//! of these changed when they last ran ([`Networks::Few`]).

use super::output::State;
use super::policy::{CLAIM_US, ESTABLISHED_CLAIM, RETURN_US};
use super::search::{FoundFace, Wanted};
use super::step::SharedFrame;
use super::{Model, StepError, Tracker, is_same_face};
use crate::align::Networks;
use crate::detect::Scan;
use crate::image::Frame;
use core::borrow::BorrowMut;
use core::fmt;

/// Capacity: trackers of a group.
pub const MAX_GROUP: usize = 16;

/// New faces of one frame at most.
const MOST_FOUND: usize = 4;

/// What several trackers share: steps them on the same frames, so that each follows a face of its
/// own, for less than they cost alone. Plain data, without the trackers.
///
/// ```
/// use posewise::{Config, Frame, FrameLayout, Group, Model, State, Tracker};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// let model = Model::load(posewise::DEFAULT_MODEL)?;
/// let tracker = || Tracker::new(&Config::default()).map(Box::new);
/// let mut trackers = [tracker()?, tracker()?, tracker()?];
/// let mut group = Group::new();
///
/// # let pixels = [128; 320 * 240];
/// # let frame = Frame::new(&FrameLayout::grey(320, 240), &pixels)?;
/// # let timestamp_us = 33_333;
/// group.step(&model, &mut trackers, &frame, timestamp_us)?;
/// for (number, tracker) in trackers.iter().enumerate() {
///     if tracker.result().state == State::Tracking {
///         println!("face {number}: yaw {:.1} deg", tracker.result().yaw_deg);
///     }
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Group {
    slots: [Slot; MAX_GROUP],
    /// Of new faces.
    scan: Scan,
    /// Whether every place was searched since a face was found or lost.
    is_scanned: bool,
    last_us: Option<i64>,
}

/// What is known of one tracker.
#[derive(Clone, Copy)]
struct Slot {
    /// Recent mean of confidence times visible share, 0..1.
    claim: f32,
    /// When it last tracked an established face \[µs\].
    tracked_us: Option<i64>,
    /// Steps since all networks saw its face.
    rested: u8,
    /// Of its last step.
    state: State,
    face_box: [f32; 4],
    /// Whether it has seen this frame.
    is_done: bool,
}

impl Slot {
    const EMPTY: Slot = Slot {
        claim: 0.0,
        tracked_us: None,
        rested: 0,
        state: State::Searching,
        face_box: [0.0; 4],
        is_done: false,
    };

    /// Takes what a tracker says of itself.
    fn take(&mut self, tracker: &Tracker) {
        let result = tracker.result();
        (self.state, self.face_box) = (result.state, result.face_box);
        self.rested = tracker.rested();
    }

    fn has_face(&self) -> bool {
        self.state != State::Searching
    }

    fn is_tracking(&self) -> bool {
        self.state == State::Tracking
    }

    /// Whether it lost its face a moment ago.
    fn is_back_soon(&self, now_us: i64) -> bool {
        let since = |then| now_us.saturating_sub(then);
        !self.has_face() && self.tracked_us.is_some_and(|then| since(then) < RETURN_US)
    }
}

/// The trackers of a step, in the order of the steps before, and their models.
pub(crate) trait Members {
    fn count(&self) -> usize;
    /// `None` from [`Members::count`] on.
    fn get(&mut self, k: usize) -> Option<(&Model<'_>, &mut Tracker)>;
}

/// Trackers that share a model.
struct SameModel<'a, 'm, T> {
    model: &'a Model<'m>,
    trackers: &'a mut [T],
}

impl<T: BorrowMut<Tracker>> Members for SameModel<'_, '_, T> {
    fn count(&self) -> usize {
        self.trackers.len()
    }

    fn get(&mut self, k: usize) -> Option<(&Model<'_>, &mut Tracker)> {
        let tracker = self.trackers.get_mut(k)?;
        Some((self.model, tracker.borrow_mut()))
    }
}

/// Which face each tracker has; the rest is more than anybody reads.
impl fmt::Debug for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let states = self.slots.iter().map(|slot| slot.state);
        f.debug_list().entries(states).finish()
    }
}

impl Default for Group {
    fn default() -> Self {
        Self::new()
    }
}

impl Group {
    /// A group that has seen nothing.
    pub const fn new() -> Group {
        Group {
            slots: [Slot::EMPTY; MAX_GROUP],
            scan: Scan::new(),
            is_scanned: false,
            last_us: None,
        }
    }

    /// Steps all trackers on one frame; [`Tracker::result`] has the result of each. The trackers
    /// are those of the steps before, in the same order; those that come later are new. They
    /// replace what [`Tracker::set_excluded`] said. Work is bounded: a step of each tracker, and
    /// one more for each of them that has no face.
    ///
    /// # Errors
    /// [`StepError::Group`] for more than [`MAX_GROUP`] trackers; that of the first tracker which
    /// cannot take the frame. All trackers are then unchanged.
    pub fn step<T: BorrowMut<Tracker>>(
        &mut self,
        model: &Model<'_>,
        trackers: &mut [T],
        frame: &Frame<'_>,
        timestamp_us: i64,
    ) -> Result<(), StepError> {
        self.step_members(&mut SameModel { model, trackers }, frame, timestamp_us)
    }

    /// Whether the face of this tracker is its own. For one frame it may not be: then it is that of
    /// another tracker, onto which it slid, and to which it gives it back on the next frame.
    pub fn is_own(&self, tracker: usize) -> bool {
        let is_tracking = self.slots.get(tracker).is_some_and(Slot::is_tracking);
        !is_tracking || self.excluded(tracker).is_empty()
    }

    /// As [`Group::step`].
    pub(crate) fn step_members(
        &mut self,
        members: &mut impl Members,
        frame: &Frame<'_>,
        now_us: i64,
    ) -> Result<(), StepError> {
        let count = members.count();
        if count > MAX_GROUP {
            return Err(StepError::Group);
        }
        for k in 0..count {
            if let Some((_, tracker)) = members.get(k) {
                tracker.check(frame, now_us)?;
            }
        }
        self.begin(members);
        let shared = &mut SharedFrame::new(frame);
        let turn = self.turn();
        for k in 0..count {
            if self.has_face(k) {
                let networks = match Some(k) == turn {
                    true => Networks::All,
                    false => Networks::Few,
                };
                self.step_one(members, k, shared, now_us, &Wanted::Any, networks);
                // Others may have its face now.
                self.is_scanned &= self.has_face(k);
            }
        }
        self.search(members, shared, now_us);
        for k in 0..count {
            if let (false, Some((_, tracker))) = (self.is_done(k), members.get(k)) {
                tracker.wait(now_us);
            }
        }
        self.update_claims(members, now_us);
        Ok(())
    }

    /// Takes what the trackers say: somebody may have stepped or reset one.
    fn begin(&mut self, members: &mut impl Members) {
        for (k, slot) in self.slots.iter_mut().enumerate() {
            let Some((_, tracker)) = members.get(k) else {
                *slot = Slot::EMPTY;
                continue;
            };
            slot.take(tracker);
            slot.is_done = false;
        }
    }

    /// The tracker whose turn it is to run all networks: that for which it is longest ago.
    fn turn(&self) -> Option<usize> {
        let tracking = self.slots.iter().enumerate();
        let tracking = tracking.filter(|(_, slot)| slot.is_tracking());
        let turn = tracking.max_by_key(|(k, slot)| (slot.rested, core::cmp::Reverse(*k)));
        turn.map(|(k, _)| k)
    }

    fn has_face(&self, k: usize) -> bool {
        self.slots.get(k).is_some_and(Slot::has_face)
    }

    fn is_done(&self, k: usize) -> bool {
        self.slots.get(k).is_some_and(|slot| slot.is_done)
    }

    /// A step of one tracker, which leaves the others their faces.
    #[inline(never)]
    fn step_one(
        &mut self,
        members: &mut impl Members,
        k: usize,
        shared: &mut SharedFrame<'_>,
        now_us: i64,
        wanted: &Wanted,
        networks: Networks,
    ) {
        let excluded = self.excluded(k);
        let (Some((model, tracker)), Some(slot)) = (members.get(k), self.slots.get_mut(k)) else {
            return;
        };
        tracker.leave(&excluded);
        tracker.step_shared(model, shared, now_us, wanted, networks);
        slot.take(tracker);
        slot.is_done = true;
    }

    /// Trackers that lost their face a moment ago search; else new faces are.
    fn search(&mut self, members: &mut impl Members, shared: &mut SharedFrame<'_>, now_us: i64) {
        let mut is_expected = false;
        for k in 0..MAX_GROUP {
            let Some(slot) = self.slots.get(k) else {
                continue;
            };
            is_expected |= slot.is_back_soon(now_us) || slot.state == State::Coasting;
            if slot.is_back_soon(now_us) && !slot.is_done {
                self.step_one(members, k, shared, now_us, &Wanted::Any, Networks::All);
            }
        }
        // A new tracker would be given the face that another one has just lost.
        if !is_expected {
            self.find_new(members, shared, now_us);
        }
    }

    /// Gives new faces to trackers without one; those that had one before come last.
    fn find_new(&mut self, members: &mut impl Members, shared: &mut SharedFrame<'_>, now_us: i64) {
        let calls = match self.is_scanned {
            true => 1,
            false => members.count(),
        };
        for _ in 0..calls {
            let Some(scout) = self.free(members.count()) else {
                break;
            };
            let excluded = self.excluded(scout);
            let Some((model, tracker)) = members.get(scout) else {
                break;
            };
            tracker.leave(&excluded);
            let mut found = [FoundFace::default(); MOST_FOUND];
            let listed = tracker.list(model, shared, Some(&mut self.scan), &mut found);
            for face in found.iter().take(listed.count) {
                if let (Some(k), Some(at)) = (self.free(members.count()), face.hint().detection()) {
                    let wanted = &Wanted::Near(at);
                    self.step_one(members, k, shared, now_us, wanted, Networks::All);
                    self.is_scanned = false;
                }
            }
            if listed.finished {
                self.is_scanned = listed.count == 0;
                break;
            }
        }
    }

    /// A tracker that has no face and has not seen this frame: the one whose last is longest ago.
    fn free(&self, count: usize) -> Option<usize> {
        let slots = self.slots.iter().take(count).enumerate();
        let free = slots.filter(|(_, slot)| !slot.has_face() && !slot.is_done);
        free.min_by_key(|(_, slot)| slot.tracked_us).map(|(k, _)| k)
    }

    /// Boxes of the faces that a tracker must leave to others.
    #[inline(never)]
    fn excluded(&self, k: usize) -> Boxes {
        let mut boxes = Boxes::new();
        let Some(own) = self.slots.get(k) else {
            return boxes;
        };
        for (other_k, other) in self.slots.iter().enumerate() {
            // Of two equal claims that of the lower number is the greater one.
            let is_greater = (other.claim, k) > (own.claim, other_k);
            let is_own =
                own.is_tracking() && !(is_greater && is_same_face(&own.face_box, &other.face_box));
            if other_k != k && other.is_tracking() && !is_own {
                // There is room for all.
                let _ = boxes.push(other.face_box);
            }
        }
        boxes
    }

    fn update_claims(&mut self, members: &mut impl Members, now_us: i64) {
        let elapsed_us = self.last_us.map_or(0, |last| now_us.saturating_sub(last));
        self.last_us = Some(now_us);
        let share = 1.0 - libm::expf(-(elapsed_us.max(0) as f32) / CLAIM_US);
        for (k, slot) in self.slots.iter_mut().enumerate() {
            let Some((_, tracker)) = members.get(k) else {
                continue;
            };
            let result = tracker.result();
            let now = match result.state {
                State::Tracking => result.confidence * result.visible_share,
                State::Searching | State::Coasting => 0.0,
            };
            slot.claim += share * (now - slot.claim);
            if slot.is_tracking() && slot.claim >= ESTABLISHED_CLAIM {
                slot.tracked_us = Some(now_us);
            }
        }
    }
}

/// Boxes of faces.
type Boxes = heapless::Vec<[f32; 4], MAX_GROUP>;
