//! Something that begins, is reported when it has lasted for a while, and ends: a closure of the
//! eyes, a yawn, a look down. Its length is the time for which it was known: unknown time neither
//! lengthens it nor, up to the gap of the settings, ends it.

use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};

/// One that goes on, or none.
#[derive(Clone)]
pub(super) struct Episode {
    pub(super) is_on: bool,
    start_us: i64,
    pub(super) time_us: u32,
    /// Since it was last known.
    unknown_us: u32,
    /// How many of the levels of [`Reports`] it has reached.
    levels: u8,
}

/// The events of a kind of episode, and the times of it.
pub(super) struct Reports<const N: usize> {
    /// What is reported from which length \[µs\] on, in the order in which it is reached.
    pub(super) levels: [(u32, MonitorEventKind); N],
    /// The end of one that reached a level.
    pub(super) end: MonitorEventKind,
    /// It ends after so much unknown time \[µs\].
    pub(super) gap_us: u32,
}

impl Episode {
    pub(super) const NONE: Episode = Episode {
        is_on: false,
        start_us: 0,
        time_us: 0,
        unknown_us: 0,
        levels: 0,
    };

    /// Whether it reached a level.
    pub(super) fn is_reported(&self) -> bool {
        self.levels > 0
    }

    /// It begins.
    pub(super) fn begin(&mut self, now_us: i64) {
        *self = Episode {
            is_on: true,
            start_us: now_us,
            ..Episode::NONE
        };
    }

    /// Lets time pass, in which it is known to go on or not known; `most_us` is the length beyond
    /// which this time does not lengthen it. Returns one that this ends.
    pub(super) fn pass<const N: usize>(
        &mut self,
        time_us: u32,
        is_known: bool,
        most_us: u32,
        now_us: i64,
        reports: &Reports<N>,
        log: &mut MonitorEventLog,
    ) -> Option<Episode> {
        if !self.is_on {
            return None;
        }
        if !is_known {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
            let is_cut = self.unknown_us > reports.gap_us;
            return is_cut.then(|| self.end(now_us, true, reports, log))?;
        }
        self.unknown_us = 0;
        let longer_us = self.time_us.saturating_add(time_us);
        self.time_us = longer_us.min(most_us.max(self.time_us));
        for (level, (after_us, kind)) in reports.levels.into_iter().enumerate() {
            if self.time_us >= after_us && usize::from(self.levels) == level {
                self.levels += 1;
                log.push(self.event(kind, now_us, false));
            }
        }
        None
    }

    /// Ends it; returns what it was.
    #[inline(never)]
    pub(super) fn end<const N: usize>(
        &mut self,
        now_us: i64,
        is_cut: bool,
        reports: &Reports<N>,
        log: &mut MonitorEventLog,
    ) -> Option<Episode> {
        let ended = core::mem::replace(self, Episode::NONE);
        if ended.is_reported() {
            log.push(ended.event(reports.end, now_us, is_cut));
        }
        ended.is_on.then_some(ended)
    }

    pub(super) fn event(&self, kind: MonitorEventKind, now_us: i64, is_cut: bool) -> MonitorEvent {
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
