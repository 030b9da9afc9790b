//! Eye closures: from blinks to sleep.
//!
//! A closure begins when the openness falls below one threshold and ends when it rises above a
//! larger one. Its length is the time for which the eyes were known in between.

use super::config::MonitorConfig;
use super::episode::{Episode, Reports};
use super::event::{MonitorEventKind, MonitorEventLog};

/// The closure that goes on.
#[derive(Clone)]
pub(super) struct Closures {
    closure: Episode,
    pub(super) blinks: u32,
}

fn reports(config: &MonitorConfig) -> Reports<4> {
    Reports {
        levels: [
            // A blink may be as long as its limit.
            (
                config.long_closure_us.saturating_add(1),
                MonitorEventKind::LongClosure,
            ),
            (config.microsleep_us, MonitorEventKind::Microsleep),
            (config.sleep_us, MonitorEventKind::Sleep),
            (config.unresponsive_us, MonitorEventKind::Unresponsive),
        ],
        end: MonitorEventKind::ClosureEnd,
        gap_us: config.gap_us,
    }
}

impl Closures {
    pub(super) const NONE: Closures = Closures {
        closure: Episode::NONE,
        blinks: 0,
    };

    pub(super) fn is_closed(&self) -> bool {
        self.closure.is_on
    }

    /// For how long the eyes are closed \[µs\].
    pub(super) fn closed_us(&self) -> u32 {
        self.closure.time_us
    }

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
        let most_us = match may_look_down {
            Some(true) => config.long_closure_us,
            _ => u32::MAX,
        };
        let (is_known, reports) = (may_look_down.is_some(), reports(config));
        let cut = (self.closure).pass(time_us, is_known, most_us, now_us, &reports, log)?;
        self.count(&cut, now_us, true, config, log)
    }

    /// The openness of a new observation; returns the length of a closure that it ends.
    pub(super) fn see(
        &mut self,
        openness: f32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if self.is_closed() && openness > config.open_above {
            return self.end(now_us, false, config, log);
        }
        if !self.is_closed() && openness < config.closed_below {
            self.closure.begin(now_us);
        }
        None
    }

    /// Ends the closure; returns its length if it counts.
    pub(super) fn end(
        &mut self,
        now_us: i64,
        is_cut: bool,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        let ended = (self.closure).end(now_us, is_cut, &reports(config), log)?;
        self.count(&ended, now_us, is_cut, config, log)
    }

    /// Counts blinks; returns the length of a closure that counts.
    fn count(
        &mut self,
        ended: &Episode,
        now_us: i64,
        is_cut: bool,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if !ended.is_reported() {
            if ended.time_us < config.blink_us || is_cut {
                // What ends in the unknown may be an eye that something was about to hide.
                return None;
            }
            self.blinks = self.blinks.saturating_add(1);
            log.push(ended.event(MonitorEventKind::Blink, now_us, false));
        }
        Some(ended.time_us)
    }
}
