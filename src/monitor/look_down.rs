//! Looks down: a gaze that stays lowered, as at a telephone or the instruments. Lids follow such a
//! gaze; they are not shut.

use super::config::MonitorConfig;
use super::episode::{Episode, Reports};
use super::event::{MonitorEventKind, MonitorEventLog};

/// How much less a gaze must be lowered for the look to end \[deg\]. Chosen: half of what lids and
/// iris leave uncertain.
const MARGIN_DEG: f32 = 5.0;

/// Whether the eyes look down, and since when.
#[derive(Clone)]
pub(super) struct LookDown {
    look: Episode,
}

fn reports(config: &MonitorConfig) -> Reports<1> {
    Reports {
        levels: [(config.look_down_us, MonitorEventKind::LookDown)],
        end: MonitorEventKind::LookDownEnd,
        gap_us: config.gap_us,
    }
}

impl LookDown {
    pub(super) const NONE: LookDown = LookDown {
        look: Episode::NONE,
    };

    pub(super) fn is_on(&self) -> bool {
        self.look.is_on
    }

    /// For how long they do \[µs\].
    pub(super) fn time_us(&self) -> u32 {
        self.look.time_us
    }

    /// Lets time pass with a gaze that is known or not.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        is_known: bool,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        let reports = reports(config);
        (self.look).pass(time_us, is_known, u32::MAX, now_us, &reports, log);
    }

    /// The pitch of a new gaze from the direction of the road \[deg\].
    pub(super) fn see(
        &mut self,
        pitch_deg: f32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if self.look.is_on && pitch_deg > MARGIN_DEG - config.look_down_deg {
            self.end(now_us, false, config, log);
        } else if !self.look.is_on && pitch_deg < -config.look_down_deg {
            self.look.begin(now_us);
        }
    }

    /// Ends it.
    pub(super) fn end(
        &mut self,
        now_us: i64,
        is_cut: bool,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        self.look.end(now_us, is_cut, &reports(config), log);
    }
}
