//! Yawns: a mouth that stays wide open for longer than a word and shorter than a grimace.

use super::config::MonitorConfig;
use super::episode::{Episode, Reports};
use super::event::{MonitorEventKind, MonitorEventLog};

/// The mouth.
#[derive(Clone)]
pub(super) struct Yawns {
    mouth: Episode,
    pub(super) count: u32,
}

fn reports(config: &MonitorConfig) -> Reports<1> {
    Reports {
        levels: [(config.yawn_us, MonitorEventKind::Yawn)],
        end: MonitorEventKind::YawnEnd,
        gap_us: config.gap_us,
    }
}

impl Yawns {
    pub(super) const NONE: Yawns = Yawns {
        mouth: Episode::NONE,
        count: 0,
    };

    /// Time for which the mouth has been open \[µs\].
    pub(super) fn open_us(&self) -> u32 {
        self.mouth.time_us
    }

    /// Lets time pass with this openness of the jaw.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        jaw: Option<f32>,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        let (is_known, reports) = (jaw.is_some(), reports(config));
        let ended = (self.mouth).pass(time_us, is_known, u32::MAX, now_us, &reports, log);
        self.count(ended, config);
    }

    /// The openness of the jaw in a new observation.
    pub(super) fn see(
        &mut self,
        jaw: f32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if self.mouth.is_on && jaw < config.yawn_below {
            self.end(now_us, false, config, log);
        } else if !self.mouth.is_on && jaw > config.yawn_above {
            self.mouth.begin(now_us);
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
        let ended = self.mouth.end(now_us, is_cut, &reports(config), log);
        self.count(ended, config);
    }

    /// A mouth that was open for too long has not yawned, whatever was reported.
    fn count(&mut self, ended: Option<Episode>, config: &MonitorConfig) {
        let yawned = |mouth: &Episode| mouth.is_reported() && mouth.time_us <= config.yawn_max_us;
        let is_yawn = ended.as_ref().is_some_and(yawned);
        self.count = self.count.saturating_add(u32::from(is_yawn));
    }
}
