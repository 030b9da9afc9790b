//! Nods: the head drops within a second and comes up again, while the eyes are closed.

use super::config::MonitorConfig;
use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};

/// The pitch of the last second is kept as its largest value in bins of this length \[µs\].
const BIN_US: u32 = 100_000;
/// A drop takes at most this many bins: one second.
const BINS: usize = 10;
/// The head is up again within this share of the drop from where it was. Chosen: half, because
/// sleepy heads come up slowly.
const UP_SHARE: f32 = 0.5;
/// Least time of closed eyes during a nod \[µs\], as for a blink that is not missed at 10 fps, and
/// its least share of the nod: a blink during a glance at the lap is no nod.
const CLOSED_US: u32 = 100_000;
const CLOSED_SHARE: f32 = 0.25;
/// No pitch is lower \[deg\].
const LOWEST_DEG: f32 = -360.0;

/// The head.
#[derive(Clone)]
pub(super) struct Nods {
    /// Largest pitch in each bin, and which one fills.
    highest: [f32; BINS],
    current: usize,
    into_us: u32,
    unknown_us: u32,
    down: Option<Down>,
    pub(super) count: u32,
}

/// A head that has dropped.
#[derive(Clone, Copy)]
struct Down {
    start_us: i64,
    time_us: u32,
    closed_us: u32,
    from_deg: f32,
    lowest_deg: f32,
}

impl Nods {
    pub(super) const NONE: Nods = Nods {
        highest: [LOWEST_DEG; BINS],
        current: 0,
        into_us: 0,
        unknown_us: 0,
        down: None,
        count: 0,
    };

    /// Lets time pass with this pitch and these eyes.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        pitch_deg: Option<f32>,
        is_closed: bool,
        config: &MonitorConfig,
    ) {
        let passed = self.into_us.saturating_add(time_us);
        let shift = ((passed / BIN_US) as usize).min(BINS);
        self.into_us = passed % BIN_US;
        for _ in 0..shift {
            self.current = (self.current + 1) % BINS;
            if let Some(bin) = self.highest.get_mut(self.current) {
                *bin = pitch_deg.unwrap_or(LOWEST_DEG);
            }
        }
        if pitch_deg.is_some() {
            self.unknown_us = 0;
        } else {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
        }
        let is_lost = self.unknown_us > config.gap_us;
        if let Some(down) = &mut self.down {
            down.time_us = down.time_us.saturating_add(time_us);
            if is_closed {
                down.closed_us = down.closed_us.saturating_add(time_us);
            }
            if is_lost || down.time_us > config.nod_us {
                self.down = None;
            }
        }
    }

    /// The pitch in a new observation.
    pub(super) fn see(
        &mut self,
        pitch_deg: f32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if let Some(newest) = self.highest.get_mut(self.current) {
            *newest = newest.max(pitch_deg);
        }
        let highest = self.highest.iter().copied().fold(LOWEST_DEG, f32::max);
        match &mut self.down {
            None if highest - pitch_deg >= config.nod_deg => {
                self.down = Some(Down {
                    start_us: now_us,
                    time_us: 0,
                    closed_us: 0,
                    from_deg: highest,
                    lowest_deg: pitch_deg,
                });
            }
            None => {}
            Some(down) => {
                down.lowest_deg = down.lowest_deg.min(pitch_deg);
                let drop_deg = down.from_deg - down.lowest_deg;
                if pitch_deg >= down.from_deg - UP_SHARE * drop_deg {
                    let least_us = CLOSED_SHARE * down.time_us as f32;
                    if down.closed_us >= CLOSED_US && down.closed_us as f32 >= least_us {
                        self.count = self.count.saturating_add(1);
                        log.push(MonitorEvent {
                            timestamp_us: now_us,
                            start_us: down.start_us,
                            duration_us: down.time_us,
                            kind: MonitorEventKind::Nod,
                            value: drop_deg,
                            ..MonitorEvent::default()
                        });
                    }
                    self.forget();
                }
            }
        }
    }

    /// Nothing of the past counts any more.
    pub(super) fn forget(&mut self) {
        *self = Nods {
            count: self.count,
            ..Nods::NONE
        };
    }
}
