//! Several faces: one tracker each, which share the model and do not take each other's face.
//!
//! On each frame, trackers that have a face go first. A tracker without one is told the boxes of
//! the faces that the others track, and finds none of those. Of the trackers without a face, those
//! search that lost theirs a moment ago, so that a person keeps the number; if there is none, and
//! none coasts, a scout looks for new faces, each of which is then given to one of the others. The
//! scout only detects: its scan goes on where it was when a face is found. Where two trackers are
//! on the same face, the one with the smaller claim has slid onto it, mostly from a face that went
//! behind it: it gives it back. A tracker's claim is its recent mean of confidence times visible
//! share.

use std::time::Duration;

use anyhow::Result;
use posewise::{EventLog, FoundFace, Intrinsics, Model, Roi, State, TrackResult, is_same_face};

use crate::cli::TrackerArgs;
use crate::picture::Picture;
use crate::session::Session;

/// How long after a loss a tracker searches by itself, before another one looks for a new face
/// \[µs\]. Source: chosen; somebody who passes behind another is back sooner.
const RETURN_US: i64 = 2_000_000;
/// Time constant of a claim \[µs\]. Source: chosen: a face that is being covered has a smaller
/// claim for this long.
const CLAIM_US: f32 = 500_000.0;
/// A face whose tracker has this claim is expected back after a loss. Source: chosen: a false
/// positive is lost before, which takes 0.2 s.
const ESTABLISHED: f32 = 0.3;

/// A result and the number of its tracker.
pub struct Face {
    /// From 0.
    pub id: usize,
    /// Of the last step, smoothed if that is wanted.
    pub result: TrackResult,
}

/// One tracker.
struct Slot<'m> {
    session: Session<'m>,
    /// Recent mean of confidence times visible share, 0..1.
    claim: f32,
    /// When it last tracked an established face \[µs\].
    tracked_us: Option<i64>,
}

/// Trackers for several faces.
pub struct Faces<'m> {
    slots: Vec<Slot<'m>>,
    /// Detects new faces, and has none itself.
    scout: Session<'m>,
    /// Whether the scout has searched every place since a face was found or lost.
    is_scanned: bool,
    last_us: Option<i64>,
}

impl<'m> Faces<'m> {
    /// So many trackers.
    pub fn new(
        count: usize,
        model: &'m Model<'m>,
        args: &TrackerArgs,
        live: bool,
        roi: Option<Roi>,
    ) -> Result<Self> {
        let session = || -> Result<Session<'m>> {
            let mut session = Session::new(model, args, live)?;
            session.set_roi(roi)?;
            Ok(session)
        };
        let slot = |_| -> Result<Slot<'m>> {
            Ok(Slot {
                session: session()?,
                claim: 0.0,
                tracked_us: None,
            })
        };
        Ok(Faces {
            slots: (0..count.max(1)).map(slot).collect::<Result<_>>()?,
            scout: session()?,
            is_scanned: false,
            last_us: None,
        })
    }

    /// One frame: a single tracker's result, or those that have a face.
    pub fn step(&mut self, picture: &Picture) -> Result<Vec<Face>> {
        let now_us = picture.timestamp_us;
        match self.slots.len() {
            1 => self.step_one(0, picture)?,
            _ => self.step_all(picture)?,
        }
        self.update_claims(now_us);
        let single = self.slots.len() == 1;
        let all = self.slots.iter().enumerate();
        // A face is shown once: a tracker that slid onto another one's gives it back next time.
        let is_own = |id: usize| !self.slots[id].is_tracking() || self.excluded(id).is_empty();
        Ok(all
            .filter(|(id, slot)| single || (slot.has_face() && is_own(*id)))
            .map(|(id, slot)| Face {
                id,
                result: *slot.session.shown(),
            })
            .collect())
    }

    /// Trackers that have a face, then those that lost it a moment ago, then those without one.
    fn step_all(&mut self, picture: &Picture) -> Result<()> {
        let ids = 0..self.slots.len();
        let with_face: Vec<usize> = ids.filter(|id| self.slots[*id].has_face()).collect();
        for id in &with_face {
            self.step_one(*id, picture)?;
        }
        // Some of these may have lost their face on this frame.
        self.is_scanned &= with_face.iter().all(|id| self.slots[*id].has_face());
        let returning = self.returning(picture.timestamp_us);
        for id in returning.iter().filter(|id| !with_face.contains(id)) {
            self.step_one(*id, picture)?;
        }
        // A new number would be given to a face that another tracker has just lost.
        let mut faces = self.slots.iter().filter(|slot| slot.has_face());
        if returning.is_empty() && faces.all(Slot::is_tracking) {
            let free = (0..self.slots.len()).filter(|id| !with_face.contains(id));
            self.find_new(picture, free.collect())?;
        }
        Ok(())
    }

    fn step_one(&mut self, id: usize, picture: &Picture) -> Result<()> {
        let excluded = self.excluded(id);
        let session = &mut self.slots[id].session;
        session.exclude(&excluded)?;
        session.step(picture)?;
        Ok(())
    }

    /// The trackers that lost their face a moment ago, the last one first.
    fn returning(&self, now_us: i64) -> Vec<usize> {
        let is_back_soon = |id: &usize| {
            let slot = &self.slots[*id];
            let since = |then| now_us.saturating_sub(then);
            !slot.has_face() && slot.tracked_us.is_some_and(|then| since(then) < RETURN_US)
        };
        let mut ids: Vec<usize> = (0..self.slots.len()).filter(is_back_soon).collect();
        ids.sort_by_key(|id| std::cmp::Reverse(self.slots[*id].tracked_us));
        ids
    }

    /// Gives new faces to trackers that have none, which this frame was not shown: those that had a
    /// face before come last. The work is a step's for the scout and each tracker, until every
    /// place was searched; then one step's.
    fn find_new(&mut self, picture: &Picture, mut free: Vec<usize>) -> Result<()> {
        free.sort_by_key(|id| self.slots[*id].tracked_us);
        let calls = if self.is_scanned {
            1
        } else {
            self.slots.len() + 1
        };
        for _ in 0..calls {
            if free.is_empty() {
                break;
            }
            let tracked = self.slots.iter().filter(|slot| slot.is_tracking());
            let tracked: Vec<[f32; 4]> = tracked.map(Slot::face_box).collect();
            self.scout.exclude(&tracked)?;
            let mut found = [FoundFace::default(); 4];
            let most = free.len().min(found.len());
            let detected = self.scout.detect(picture, &mut found[..most])?;
            for face in &found[..detected.count] {
                let id = free.remove(0);
                let excluded = self.excluded(id);
                let session = &mut self.slots[id].session;
                session.exclude(&excluded)?;
                session.step_at(picture, face)?;
                self.is_scanned = false;
            }
            if detected.finished {
                self.is_scanned = detected.count == 0;
                break;
            }
        }
        Ok(())
    }

    /// Boxes of faces that a tracker must leave to others.
    fn excluded(&self, id: usize) -> Vec<[f32; 4]> {
        let own = &self.slots[id];
        let others = self.slots.iter().enumerate().filter(|(k, _)| *k != id);
        others
            .filter(|(_, other)| other.is_tracking())
            .filter(|(k, other)| {
                // Of two equal claims that of the lower number is the greater one.
                let is_greater = (other.claim, id) > (own.claim, *k);
                !own.is_tracking()
                    || (is_greater && is_same_face(&own.face_box(), &other.face_box()))
            })
            .map(|(_, other)| other.face_box())
            .collect()
    }

    fn update_claims(&mut self, now_us: i64) {
        let elapsed_us = self.last_us.map_or(0, |last| now_us.saturating_sub(last));
        self.last_us = Some(now_us);
        let share = 1.0 - (-(elapsed_us as f32) / CLAIM_US).exp();
        for slot in &mut self.slots {
            let result = slot.session.result();
            let now = match result.state {
                State::Tracking => result.confidence * result.visible_share,
                State::Searching | State::Coasting => 0.0,
            };
            slot.claim += share * (now - slot.claim);
            if slot.is_tracking() && slot.claim >= ESTABLISHED {
                slot.tracked_us = Some(now_us);
            }
        }
    }

    /// The events of each tracker that were not written yet, with its number where there are
    /// several.
    pub fn events(&mut self) -> impl Iterator<Item = (Option<usize>, &mut EventLog)> {
        let several = self.slots.len() > 1;
        let slots = self.slots.iter_mut().enumerate();
        slots.map(move |(id, slot)| (several.then_some(id), slot.session.events()))
    }

    /// The tracker of face 0.
    pub fn first(&self) -> &Session<'m> {
        &self.slots[0].session
    }

    /// The camera that the trackers assume for the current frame.
    pub fn intrinsics(&self) -> Intrinsics {
        self.slots[0].session.intrinsics()
    }

    /// Time spent in steps.
    pub fn busy(&self) -> Duration {
        let slots = self.slots.iter().map(|slot| slot.session.busy);
        slots.sum::<Duration>() + self.scout.busy
    }
}

impl Slot<'_> {
    fn has_face(&self) -> bool {
        self.session.result().state != State::Searching
    }

    fn is_tracking(&self) -> bool {
        self.session.result().state == State::Tracking
    }

    fn face_box(&self) -> [f32; 4] {
        self.session.result().face_box
    }
}
