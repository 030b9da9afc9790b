//! Glances away from the road, and the time spent in each zone.

use super::config::MonitorConfig;
use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};
use super::recent::Recent;
use super::zone::{MAX_ZONES, ZoneState, Zones};

/// Where the driver looks, and since when.
#[derive(Clone)]
pub(super) struct Glances {
    pub(super) zone: ZoneState,
    pub(super) zone_us: u32,
    pub(super) zones_us: [u64; MAX_ZONES],
    /// The zone whose grace is used up, and how much of it is \[µs\]: short unknown times between
    /// do not bring it back.
    stay: (u8, u32),
    /// On the road without a break.
    road_us: u32,
    glance: Option<Glance>,
    unknown_us: u32,
    is_cumulative: bool,
    recent: Recent,
}

/// A glance away from the road.
#[derive(Clone, Copy)]
struct Glance {
    start_us: i64,
    /// Known time of it, and what of it counts.
    time_us: u32,
    away_us: u32,
    zone: u8,
    is_long: bool,
}

impl Glances {
    pub(super) const NONE: Glances = Glances {
        zone: ZoneState::Unknown,
        zone_us: 0,
        zones_us: [0; MAX_ZONES],
        stay: (0, 0),
        road_us: 0,
        glance: None,
        unknown_us: 0,
        is_cumulative: false,
        recent: Recent::EMPTY,
    };

    /// Time away in the glance that goes on \[µs\].
    pub(super) fn away_us(&self) -> u32 {
        self.glance.map_or(0, |glance| glance.away_us)
    }

    /// Time away within the last 30 s \[µs\].
    pub(super) fn recent_us(&self) -> u32 {
        self.recent.sum_us()
    }

    /// Lets time pass in this zone.
    pub(super) fn pass(
        &mut self,
        time_us: u32,
        held: ZoneState,
        zones: &Zones,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        if held != self.zone {
            // A gap between frames.
            (self.zone, self.zone_us) = (held, 0);
        }
        self.zone_us = self.zone_us.saturating_add(time_us);
        let (index, zone) = match held {
            ZoneState::In(index) => (index, zones.get(index)),
            _ => (0, None),
        };
        let is_road = zone.is_some_and(|zone| zone.is_road);
        let counted_us = match zone {
            Some(zone) if !is_road => self.count(time_us, zone.grace_us),
            _ => 0,
        };
        self.recent.pass(time_us, counted_us);
        if held == ZoneState::Unknown {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
            if self.unknown_us > config.gap_us {
                (self.road_us, self.stay.1) = (0, 0);
                self.end(now_us, true, log);
            }
            return;
        }
        self.unknown_us = 0;
        if zone.is_some()
            && let Some(sum) = self.zones_us.get_mut(usize::from(index))
        {
            *sum = sum.saturating_add(u64::from(time_us));
        }
        if is_road {
            self.road_us = self.road_us.saturating_add(time_us);
            if self.road_us >= config.return_us {
                self.end(now_us, false, log);
            }
            if self.road_us >= config.clear_us {
                self.recent.clear();
                self.is_cumulative = false;
            }
            return;
        }
        self.road_us = 0;
        self.stay(time_us, counted_us, now_us, config, log);
    }

    /// How much of this time lies beyond the grace of the zone.
    fn count(&mut self, time_us: u32, grace_us: u32) -> u32 {
        let before_us = self.stay.1;
        self.stay.1 = before_us.saturating_add(time_us);
        match grace_us {
            u32::MAX => 0,
            grace_us => self.stay.1 - grace_us.clamp(before_us, self.stay.1),
        }
    }

    /// Time passes away from the road.
    fn stay(
        &mut self,
        time_us: u32,
        counted_us: u32,
        now_us: i64,
        config: &MonitorConfig,
        log: &mut MonitorEventLog,
    ) {
        let Some(glance) = &mut self.glance else {
            return;
        };
        glance.time_us = glance.time_us.saturating_add(time_us);
        glance.away_us = glance.away_us.saturating_add(counted_us);
        if glance.away_us >= config.long_glance_us && !glance.is_long {
            glance.is_long = true;
            log.push(event(MonitorEventKind::LongGlance, glance, now_us));
        }
        if self.recent.sum_us() >= config.cumulative_us && !self.is_cumulative {
            self.is_cumulative = true;
            let glance = Glance {
                away_us: self.recent.sum_us(),
                ..*glance
            };
            log.push(event(MonitorEventKind::CumulativeGlance, &glance, now_us));
        }
    }

    /// The zone of a new observation.
    pub(super) fn see(&mut self, zone: ZoneState, zones: &Zones, now_us: i64) {
        if zone != self.zone {
            (self.zone, self.zone_us) = (zone, 0);
        }
        let ZoneState::In(index) = zone else { return };
        if index != self.stay.0 {
            self.stay = (index, 0);
        }
        if zones.get(index).is_none_or(|zone| zone.is_road) {
            return;
        }
        let glance = self.glance.get_or_insert(Glance {
            start_us: now_us,
            time_us: 0,
            away_us: 0,
            zone: index,
            is_long: false,
        });
        glance.zone = index;
    }

    /// Ends the glance.
    #[inline(never)]
    pub(super) fn end(&mut self, now_us: i64, is_cut: bool, log: &mut MonitorEventLog) {
        if let Some(glance) = self.glance.take() {
            log.push(MonitorEvent {
                duration_us: glance.time_us,
                is_cut,
                ..event(MonitorEventKind::Glance, &glance, now_us)
            });
        }
    }

    /// Nothing goes on any more; sums stay.
    pub(super) fn interrupt(&mut self) {
        (self.zone, self.zone_us) = (ZoneState::Unknown, 0);
        (self.road_us, self.unknown_us, self.stay.1) = (0, 0, 0);
    }
}

fn event(kind: MonitorEventKind, glance: &Glance, now_us: i64) -> MonitorEvent {
    MonitorEvent {
        timestamp_us: now_us,
        start_us: glance.start_us,
        duration_us: glance.away_us,
        kind,
        zone: Some(glance.zone),
        ..MonitorEvent::default()
    }
}
