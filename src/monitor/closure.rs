//! Eye closures: from blinks to sleep.
//!
//! A closure begins when the openness falls below one threshold and ends when it rises above a
//! larger one. Its length is the time for which the eyes were known in between.
//!
//! One that begins while the eyes may look down is doubted, until both eyes have surely been shut
//! for a while. Before that it is no longer than a usual blink.

use super::config::MonitorConfig;
use super::episode::{Episode, Reports};
use super::event::{MonitorEventKind, MonitorEventLog};

/// A doubted closure is believed when both eyes have surely been shut for so long without a break
/// \[µs\]. Chosen on rendered drivers who read: after 0.5 s one of 3 s is believed that is none.
const BELIEVED_US: u32 = 700_000;
/// Most length of one that is doubted \[µs\]: that of a usual blink, so that blinks count.
const DOUBTED_US: u32 = 150_000;

/// What is known of lids that seem shut.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Lids {
    /// The eyes are unknown.
    Unknown,
    /// They may follow a lowered gaze: they do, or the network is not sure.
    MayLookDown,
    /// A gaze is seen between them.
    WithGaze,
    /// One eye, seen alone, is shut.
    OneShut,
    /// Both eyes are.
    Shut,
}

/// The closure that goes on.
#[derive(Clone)]
pub(super) struct Closures {
    closure: Episode,
    /// Whether, and for how long, it may be a look down.
    doubt: Option<Doubt>,
    pub(super) blinks: u32,
}

/// A closure that may be a look down.
#[derive(Clone, Copy, Default)]
struct Doubt {
    /// Its known time \[µs\].
    known_us: u32,
    /// For how long both eyes have been shut \[µs\].
    shut_us: u32,
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
        doubt: None,
        blinks: 0,
    };

    pub(super) fn is_closed(&self) -> bool {
        self.closure.is_on
    }

    /// Whether what goes on may be a look down.
    pub(super) fn is_doubted(&self) -> bool {
        self.is_closed() && self.doubt.is_some()
    }

    /// For how long the eyes are closed \[µs\].
    pub(super) fn closed_us(&self) -> u32 {
        self.closure.time_us
    }

    /// Lets time pass with these lids; returns the length of a closure that is cut by it.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        lids: Lids,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        let is_known = lids != Lids::Unknown;
        let (time_us, most_us) = match self.doubt.filter(|_| is_known) {
            Some(doubt) => self.doubt(doubt, time_us, lids),
            None if lids == Lids::MayLookDown => (time_us, config.long_closure_us),
            None => (time_us, u32::MAX),
        };
        let reports = reports(config);
        let cut = (self.closure).pass(time_us, is_known, most_us, now_us, &reports, log)?;
        self.count(&cut, now_us, true, config, log)
    }

    /// Time of a closure that is doubted: by how much it lengthens it, and up to which length.
    fn doubt(&mut self, mut doubt: Doubt, time_us: u32, lids: Lids) -> (u32, u32) {
        doubt.known_us = doubt.known_us.saturating_add(time_us);
        doubt.shut_us = match lids {
            Lids::Shut => doubt.shut_us.saturating_add(time_us),
            Lids::OneShut => doubt.shut_us,
            _ => 0,
        };
        let is_believed = doubt.shut_us >= BELIEVED_US;
        self.doubt = (!is_believed).then_some(doubt);
        match lids {
            _ if is_believed => (
                doubt.known_us.saturating_sub(self.closure.time_us),
                u32::MAX,
            ),
            Lids::MayLookDown | Lids::WithGaze => (0, DOUBTED_US),
            _ => (time_us, DOUBTED_US),
        }
    }

    /// The openness of a new observation, whose lids may follow a gaze that was lowered; returns
    /// the length of a closure that it ends.
    pub(super) fn see(
        &mut self,
        openness: f32,
        was_lowered: bool,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) -> Option<u32> {
        if self.is_closed() && openness > config.open_above {
            return self.end(now_us, false, config, log);
        }
        if !self.is_closed() && openness < config.closed_below {
            self.closure.begin(now_us);
            self.doubt = was_lowered.then(Doubt::default);
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
