//! Records events of the tracker, and gives them to the caller.

use super::Tracker;
use super::event::{Event, EventKind, EventLog};

impl Tracker {
    /// The events that were not read yet. They outlive [`Tracker::reset`].
    ///
    /// ```
    /// # use posewise::{Config, Tracker};
    /// # let mut tracker = Box::new(Tracker::new(&Config::default()).unwrap());
    /// while let Some(event) = tracker.events().pop() {
    ///     println!("{} us: {}, {:?}", event.timestamp_us, event.kind.name(), event.loss);
    /// }
    /// let missed = tracker.events().take_overwritten();
    /// # assert_eq!(missed, 0);
    /// ```
    pub fn events(&mut self) -> &mut EventLog {
        &mut self.events
    }

    /// Adds an event with what the result says now.
    #[inline(never)]
    pub(super) fn record(&mut self, kind: EventKind) {
        self.events.push(Event {
            timestamp_us: self.last_timestamp_us.unwrap_or(0),
            kind,
            loss: self.result.loss,
            confidence: self.result.confidence,
            face_box: self.result.face_box,
        });
    }
}
