//! Something that begins, is reported when it has lasted for a while, and ends: a yawn, a look
//! down. Its length is the time for which it was known: unknown time neither lengthens it nor, up
//! to the gap of the settings, ends it.

use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};

/// One that goes on, or none.
#[derive(Clone)]
pub(super) struct Episode {
    pub(super) is_on: bool,
    start_us: i64,
    pub(super) time_us: u32,
    /// Since it was last known.
    unknown_us: u32,
    is_reported: bool,
}

/// The events of a kind of episode, and the times of it.
pub(super) struct Reports {
    pub(super) begin: MonitorEventKind,
    pub(super) end: MonitorEventKind,
    /// The first is reported after this time \[µs\]; the second only after the first.
    pub(super) after_us: u32,
    /// It ends after so much unknown time \[µs\].
    pub(super) gap_us: u32,
}

impl Episode {
    pub(super) const NONE: Episode = Episode {
        is_on: false,
        start_us: 0,
        time_us: 0,
        unknown_us: 0,
        is_reported: false,
    };

    /// It begins.
    pub(super) fn begin(&mut self, now_us: i64) {
        *self = Episode {
            is_on: true,
            start_us: now_us,
            ..Episode::NONE
        };
    }

    /// Lets time pass, in which it is known to go on or not known; returns the length of one that
    /// was reported and that this ends.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        is_known: bool,
        now_us: i64,
        reports: &Reports,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if !self.is_on {
            return None;
        }
        if !is_known {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
            let is_cut = self.unknown_us > reports.gap_us;
            return is_cut.then(|| self.end(now_us, true, reports, log))?;
        }
        self.unknown_us = 0;
        self.time_us = self.time_us.saturating_add(time_us);
        if self.time_us >= reports.after_us && !self.is_reported {
            self.is_reported = true;
            log.push(self.event(reports.begin, now_us, false));
        }
        None
    }

    /// Ends it; returns the length of one that was reported.
    #[inline(never)]
    pub(super) fn end(
        &mut self,
        now_us: i64,
        is_cut: bool,
        reports: &Reports,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        let ended = (self.is_on && self.is_reported).then_some(self.time_us);
        if ended.is_some() {
            log.push(self.event(reports.end, now_us, is_cut));
        }
        *self = Episode::NONE;
        ended
    }

    fn event(&self, kind: MonitorEventKind, now_us: i64, is_cut: bool) -> MonitorEvent {
        MonitorEvent {
            timestamp_us: now_us,
            start_us: self.start_us,
            duration_us: self.time_us,
            kind,
            is_cut,
            ..MonitorEvent::default()
        }
    }
}
