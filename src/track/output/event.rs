//! What happened to the tracked face: a ring of events that the caller reads when it wants to. It
//! takes part in no decision.

use super::{Loss, TrackResult};
use core::fmt;

/// Unread events that a tracker keeps. Chosen: a face that comes and goes once a second fills it in
/// half a minute.
pub const EVENTS: usize = 64;

/// What happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum EventKind {
    /// A new face is tracked, of which nothing is known.
    #[default]
    Acquired,
    /// A face that was lost is tracked again, with its identity. Where its keyframes find it on the
    /// frame that lost it, no `Coasting` comes before.
    Reacquired,
    /// The face is not found on this frame: its last fit is repeated.
    Coasting,
    /// The face is given up, and the search begins.
    Lost,
    /// The region of the face that is lost now is suppressed for ten seconds: a candidate there
    /// needs a higher confidence. The face never had high confidence.
    Suppressed,
    /// The frames are noisy: they are box-filtered from this one on.
    FilterOn,
    /// The frames are no longer noisy: they are read as they are from this one on.
    FilterOff,
    /// The caller reset the tracker.
    Reset,
    /// The caller had the tracker forget the identity.
    Forgotten,
}

impl EventKind {
    /// Every kind, in the order of the C ABI.
    pub const ALL: [EventKind; 9] = [
        EventKind::Acquired,
        EventKind::Reacquired,
        EventKind::Coasting,
        EventKind::Lost,
        EventKind::Suppressed,
        EventKind::FilterOn,
        EventKind::FilterOff,
        EventKind::Reset,
        EventKind::Forgotten,
    ];

    /// Its name in every table and language, as `filter-on`.
    pub const fn name(self) -> &'static str {
        match self {
            EventKind::Acquired => "acquired",
            EventKind::Reacquired => "reacquired",
            EventKind::Coasting => "coasting",
            EventKind::Lost => "lost",
            EventKind::Suppressed => "suppressed",
            EventKind::FilterOn => "filter-on",
            EventKind::FilterOff => "filter-off",
            EventKind::Reset => "reset",
            EventKind::Forgotten => "forgotten",
        }
    }
}

/// One event. All but time and kind are those of the tracker's result when it happened: of the fit
/// that was accepted, or the last one of the face that is lost. They are zero where there was no
/// face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Event {
    /// Timestamp of the frame \[µs\]; of a call between two frames, that of the first.
    pub timestamp_us: i64,
    /// What happened.
    pub kind: EventKind,
    /// Why the face is lost; while searching, why the last one was.
    pub loss: Option<Loss>,
    /// As [`crate::TrackResult::confidence`].
    pub confidence: f32,
    /// As [`crate::TrackResult::face_box`] \[px\].
    pub face_box: [f32; 4],
}

impl Event {
    /// All zero.
    const EMPTY: Event = Event {
        timestamp_us: 0,
        kind: EventKind::Acquired,
        loss: None,
        confidence: 0.0,
        face_box: [0.0; 4],
    };

    /// What happened while this was the result.
    pub(in crate::track) fn new(kind: EventKind, timestamp_us: i64, result: &TrackResult) -> Event {
        Event {
            timestamp_us,
            kind,
            loss: result.loss,
            confidence: result.confidence,
            face_box: result.face_box,
        }
    }
}

/// Unread events, oldest first; when it is full, the oldest one is overwritten and counted. Plain
/// data.
#[derive(Clone)]
pub struct EventRing<E, const N: usize> {
    ring: [E; N],
    /// Place of the oldest unread event.
    first: u32,
    unread: u32,
    overwritten: u32,
}

/// The unread events of a tracker.
pub type EventLog = EventRing<Event, EVENTS>;

impl EventLog {
    pub(in crate::track) const EMPTY: EventLog = EventRing::new(Event::EMPTY);
}

/// How many events are unread, and were overwritten.
impl<E, const N: usize> fmt::Debug for EventRing<E, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EventRing")
            .field("unread", &self.unread)
            .field("overwritten", &self.overwritten)
            .finish_non_exhaustive()
    }
}

impl<E: Copy, const N: usize> EventRing<E, N> {
    /// Without unread events; `empty` is any event.
    pub(crate) const fn new(empty: E) -> Self {
        EventRing {
            ring: [empty; N],
            first: 0,
            unread: 0,
            overwritten: 0,
        }
    }

    /// Takes the oldest unread event; `None` when all are read.
    pub fn pop(&mut self) -> Option<E> {
        if self.unread == 0 {
            return None;
        }
        let event = self.ring.get(self.first as usize).copied();
        self.first = (self.first + 1) % N as u32;
        self.unread -= 1;
        event
    }

    /// Number of unread events.
    pub fn unread(&self) -> usize {
        self.unread as usize
    }

    /// How many events were overwritten unread since this was last asked.
    pub fn take_overwritten(&mut self) -> u32 {
        core::mem::take(&mut self.overwritten)
    }

    /// Not inlined, as other parts that are called from several places: code is to stay small.
    #[inline(never)]
    pub(crate) fn push(&mut self, event: E) {
        let place = (self.first + self.unread) as usize % N;
        if let Some(slot) = self.ring.get_mut(place) {
            *slot = event;
        }
        if self.unread < N as u32 {
            self.unread += 1;
        } else {
            self.first = (self.first + 1) % N as u32;
            self.overwritten = self.overwritten.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(timestamp_us: i64) -> Event {
        Event {
            timestamp_us,
            ..Event::EMPTY
        }
    }

    #[test]
    fn events_are_read_once_and_in_order() {
        let mut log = EventLog::EMPTY;
        assert_eq!(log.pop(), None);
        for time in 0..200 {
            log.push(at(2 * time));
            log.push(at(2 * time + 1));
            assert_eq!(log.pop(), Some(at(2 * time)));
            assert_eq!(log.pop(), Some(at(2 * time + 1)));
        }
        assert_eq!((log.pop(), log.take_overwritten()), (None, 0));
    }

    #[test]
    fn the_oldest_are_overwritten_and_counted() {
        let mut log = EventLog::EMPTY;
        let more = 7;
        (0..EVENTS as i64 + more).for_each(|time| log.push(at(time)));
        assert_eq!(log.unread(), EVENTS);
        assert_eq!(log.take_overwritten(), more as u32);
        assert_eq!(log.take_overwritten(), 0);
        for time in more..EVENTS as i64 + more {
            assert_eq!(log.pop(), Some(at(time)));
        }
        assert_eq!(log.pop(), None);
    }
}
