//! Yawns: a mouth that stays wide open for longer than a word and shorter than a grimace.

use super::config::MonitorConfig;
use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};

/// The mouth.
#[derive(Clone)]
pub(super) struct Yawns {
    is_open: bool,
    start_us: i64,
    pub(super) open_us: u32,
    unknown_us: u32,
    is_reported: bool,
    pub(super) count: u32,
}

impl Yawns {
    pub(super) const NONE: Yawns = Yawns {
        is_open: false,
        start_us: 0,
        open_us: 0,
        unknown_us: 0,
        is_reported: false,
        count: 0,
    };

    /// Lets time pass with this openness of the jaw.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        jaw: Option<f32>,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if !self.is_open {
            return;
        }
        if jaw.is_none() {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
            if self.unknown_us > config.gap_us {
                self.end(now_us, true, config, log);
            }
            return;
        }
        self.unknown_us = 0;
        self.open_us = self.open_us.saturating_add(time_us);
        if self.open_us >= config.yawn_us && !self.is_reported {
            self.is_reported = true;
            log.push(self.event(MonitorEventKind::Yawn, now_us, false));
        }
    }

    /// The openness of the jaw in a new observation.
    pub(super) fn see(
        &mut self,
        jaw: f32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if self.is_open && jaw < config.yawn_below {
            self.end(now_us, false, config, log);
        } else if !self.is_open && jaw > config.yawn_above {
            *self = Yawns {
                is_open: true,
                start_us: now_us,
                count: self.count,
                ..Yawns::NONE
            };
        }
    }

    /// Ends it. A mouth that was open for too long has not yawned, whatever was reported.
    #[inline(never)]
    pub(super) fn end(
        &mut self,
        now_us: i64,
        is_cut: bool,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if self.is_open && self.is_reported {
            if self.open_us <= config.yawn_max_us {
                self.count = self.count.saturating_add(1);
            }
            log.push(self.event(MonitorEventKind::YawnEnd, now_us, is_cut));
        }
        (self.is_open, self.is_reported, self.open_us) = (false, false, 0);
    }

    fn event(&self, kind: MonitorEventKind, now_us: i64, is_cut: bool) -> MonitorEvent {
        MonitorEvent {
            timestamp_us: now_us,
            start_us: self.start_us,
            duration_us: self.open_us,
            kind,
            is_cut,
            ..MonitorEvent::default()
        }
    }
}
