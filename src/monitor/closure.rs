//! Eye closures: from blinks to sleep.
//!
//! A closure begins when the openness falls below one threshold and ends when it rises above a
//! larger one. Its length is the time for which the eyes were known in between: unknown time
//! neither lengthens it nor, up to the gap of the settings, ends it.

use super::config::MonitorConfig;
use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};

/// The closure that goes on.
#[derive(Clone)]
pub(super) struct Closures {
    pub(super) is_closed: bool,
    start_us: i64,
    pub(super) closed_us: u32,
    /// Since the eyes were last known.
    unknown_us: u32,
    /// How many of the levels below it has reached.
    levels: u8,
    pub(super) blinks: u32,
}

/// Levels of a closure, in the order in which it reaches them.
const LEVELS: [MonitorEventKind; 4] = [
    MonitorEventKind::LongClosure,
    MonitorEventKind::Microsleep,
    MonitorEventKind::Sleep,
    MonitorEventKind::Unresponsive,
];

impl Closures {
    pub(super) const NONE: Closures = Closures {
        is_closed: false,
        start_us: 0,
        closed_us: 0,
        unknown_us: 0,
        levels: 0,
        blinks: 0,
    };

    /// Lets time pass with eyes that are known or not, and that may look down; returns the length
    /// of a closure that is cut by it.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        may_look_down: Option<bool>,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if !self.is_closed {
            return None;
        }
        let Some(may_look_down) = may_look_down else {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
            let is_cut = self.unknown_us > config.gap_us;
            return is_cut.then(|| self.end(now_us, true, config, log))?;
        };
        self.unknown_us = 0;
        let closed_us = self.closed_us.saturating_add(time_us);
        self.closed_us = match may_look_down {
            true => closed_us.min(config.long_closure_us.max(self.closed_us)),
            false => closed_us,
        };
        // A blink may be as long as its limit; the levels are reached with their times.
        let reached = [
            self.closed_us > config.long_closure_us,
            self.closed_us >= config.microsleep_us,
            self.closed_us >= config.sleep_us,
            self.closed_us >= config.unresponsive_us,
        ];
        for (level, kind) in LEVELS.into_iter().enumerate() {
            if reached.get(level) == Some(&true) && usize::from(self.levels) == level {
                self.levels += 1;
                log.push(self.event(kind, now_us, false));
            }
        }
        None
    }

    /// The openness of a new observation; returns the length of a closure that it ends.
    pub(super) fn see(
        &mut self,
        openness: f32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if self.is_closed && openness > config.open_above {
            return self.end(now_us, false, config, log);
        }
        if !self.is_closed && openness < config.closed_below {
            *self = Closures {
                is_closed: true,
                start_us: now_us,
                blinks: self.blinks,
                ..Closures::NONE
            };
        }
        None
    }

    /// Ends the closure; returns its length if it counts.
    #[inline(never)]
    pub(super) fn end(
        &mut self,
        now_us: i64,
        is_cut: bool,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if !core::mem::take(&mut self.is_closed) {
            return None;
        }
        let closed_us = core::mem::take(&mut self.closed_us);
        if self.levels > 0 {
            let event = self.event(MonitorEventKind::ClosureEnd, now_us, is_cut);
            log.push(MonitorEvent {
                duration_us: closed_us,
                ..event
            });
        } else if closed_us < config.blink_us || is_cut {
            // What ends in the unknown may be an eye that something was about to hide.
            return None;
        } else {
            self.blinks = self.blinks.saturating_add(1);
            let event = self.event(MonitorEventKind::Blink, now_us, false);
            log.push(MonitorEvent {
                duration_us: closed_us,
                ..event
            });
        }
        Some(closed_us)
    }

    fn event(&self, kind: MonitorEventKind, now_us: i64, is_cut: bool) -> MonitorEvent {
        MonitorEvent {
            timestamp_us: now_us,
            start_us: self.start_us,
            duration_us: self.closed_us,
            kind,
            is_cut,
            ..MonitorEvent::default()
        }
    }
}
