//! The monitor: takes observations in the order of time, and lets each of its parts see them.

use super::aim::{Aim, Directions};
use super::baseline::Baseline;
use super::clock::{Clock, Passed};
use super::closure::Closures;
use super::config::{MonitorConfig, MonitorConfigError, Place};
use super::drowsiness;
use super::event::{MonitorEvent, MonitorEventKind, MonitorEventLog};
use super::glance::Glances;
use super::look_down::LookDown;
use super::lowered::Lowered;
use super::natural::{Natural, is_learnt};
use super::nod::Nods;
use super::observation::Observation;
use super::perclos::Windows;
use super::place::Seat;
use super::preset::Preset;
use super::reading::Reading;
use super::record::{Learnt, MONITOR_RECORD_BYTES};
use super::state::{Drowsiness, EyeState, MonitorState, UnknownReason};
use super::yawn::Yawns;
use super::zone::{Zone, ZoneState, Zones};
use crate::record::RecordError;
use core::fmt;

/// Watches one driver. Plain data of fixed size: a copy is a second, independent monitor.
///
/// ```
/// use posewise::TrackResult;
/// use posewise::monitor::{Monitor, MonitorConfig, Observation};
///
/// let mut monitor = Monitor::new(&MonitorConfig::default())?;
/// // What a tracker returned for the frame of this time.
/// let (result, timestamp_us) = (TrackResult::default(), 33_333);
/// monitor.update(&Observation::from(&result), timestamp_us)?;
/// while let Some(event) = monitor.events().pop() {
///     println!("{} at {} µs", event.kind.name(), event.start_us);
/// }
/// // Nothing is known without a face.
/// assert_eq!(monitor.state().perclos_60.known, 0.0);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Monitor {
    config: MonitorConfig,
    zones: Zones,
    clock: Clock,
    /// The last observation, which counts until the next one.
    reading: Reading,
    directions: Directions,
    windows: Windows,
    closures: Closures,
    yawns: Yawns,
    nods: Nods,
    look_down: LookDown,
    lowered: Lowered,
    aim: Aim,
    glances: Glances,
    baseline: Baseline,
    natural: Natural,
    natural_gaze: Natural,
    seat: Seat,
    drowsiness: Drowsiness,
    drowsy_since_us: i64,
    drowsy_us: u32,
    sight: Sight,
    log: MonitorEventLog,
}

/// Settings and state.
impl fmt::Debug for Monitor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Monitor")
            .field("config", &self.config)
            .field("state", &self.state())
            .finish_non_exhaustive()
    }
}

/// For how long eyes are unknown, or known again.
#[derive(Clone, Copy, Default)]
struct Sight {
    unknown_us: u32,
    since_us: i64,
    is_degraded: bool,
}

/// A timestamp equals the one before: nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MonitorTimeError;

impl core::fmt::Display for MonitorTimeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the timestamp is that of the last observation")
    }
}

impl core::error::Error for MonitorTimeError {}

impl Monitor {
    /// A monitor with these settings and the zones of the default preset.
    pub fn new(config: &MonitorConfig) -> Result<Monitor, MonitorConfigError> {
        Self::with_zones(config, Preset::default().zones())
    }

    /// A monitor with these settings and zones.
    pub fn with_zones(
        config: &MonitorConfig,
        zones: &[Zone],
    ) -> Result<Monitor, MonitorConfigError> {
        config.check()?;
        Ok(Monitor {
            config: *config,
            zones: Zones::new(zones).ok_or(MonitorConfigError::Zone)?,
            clock: Clock::NEW,
            reading: Reading::NONE,
            directions: Directions::NONE,
            windows: Windows::EMPTY,
            closures: Closures::NONE,
            yawns: Yawns::NONE,
            nods: Nods::NONE,
            look_down: LookDown::NONE,
            lowered: Lowered::NEVER,
            aim: Aim::NONE,
            glances: Glances::NONE,
            baseline: Baseline::NEW,
            natural: Natural::NEW,
            natural_gaze: Natural::NEW,
            seat: Seat::NEW,
            drowsiness: Drowsiness::Unknown,
            drowsy_since_us: 0,
            drowsy_us: 0,
            sight: Sight::default(),
            log: MonitorEventLog::EMPTY,
        })
    }

    /// Replaces the zones; dwell times begin anew.
    pub fn set_zones(&mut self, zones: &[Zone]) -> Result<(), MonitorConfigError> {
        self.zones = Zones::new(zones).ok_or(MonitorConfigError::Zone)?;
        (self.aim, self.glances) = (Aim::NONE, Glances::NONE);
        Ok(())
    }

    /// Its settings.
    pub fn config(&self) -> &MonitorConfig {
        &self.config
    }

    /// The events that were not read yet.
    pub fn events(&mut self) -> &mut MonitorEventLog {
        &mut self.log
    }

    /// Another person drives: forgets open eye, natural pose, all measures and the last timestamp,
    /// so that the next observation may have any. Settings, zones and unread events stay.
    pub fn forget_driver(&mut self) {
        (self.windows, self.closures) = (Windows::EMPTY, Closures::NONE);
        (self.yawns, self.nods, self.glances) = (Yawns::NONE, Nods::NONE, Glances::NONE);
        (self.baseline, self.natural) = (Baseline::NEW, Natural::NEW);
        (self.aim, self.natural_gaze, self.seat) = (Aim::NONE, Natural::NEW, Seat::NEW);
        (self.reading, self.clock) = (Reading::NONE, Clock::NEW);
        (self.directions, self.look_down) = (Directions::NONE, LookDown::NONE);
        self.lowered = Lowered::NEVER;
        (self.drowsiness, self.sight) = (Drowsiness::Unknown, Sight::default());
    }

    /// What was learnt of the driver, for [`Monitor::restore`] on the next drive.
    pub fn save(&self) -> [u8; MONITOR_RECORD_BYTES] {
        let offset_deg = |natural: &Natural| {
            let is_known = natural.is_final(&self.config) && is_learnt(&self.config);
            is_known.then(|| natural.offset_deg())
        };
        let learnt = Learnt {
            open_eye: (self.baseline.is_final()).then(|| self.baseline.open_eye()),
            natural_deg: offset_deg(&self.natural),
            gaze_deg: offset_deg(&self.natural_gaze),
            place_mm: (self.config.place == Place::Learnt && self.seat.is_final(&self.config))
                .then(|| self.seat.at_mm(&self.config))
                .flatten(),
        };
        learnt.to_bytes()
    }

    /// Guesses what a record says of the driver: it counts from the next observation on, is never
    /// final, and what is observed replaces it, so that the record of another person does harm for
    /// a minute at most. Measures, events and clock stay.
    ///
    /// # Errors
    /// [`RecordError`]; the monitor is then unchanged.
    pub fn restore(&mut self, record: &[u8]) -> Result<(), RecordError> {
        let learnt = Learnt::from_bytes(record)?;
        if let Some(open_eye) = learnt.open_eye {
            self.baseline = Baseline::guessed(open_eye);
        }
        if let Some(natural_deg) = learnt.natural_deg {
            self.natural = Natural::guessed(natural_deg, &self.config);
        }
        if let Some(gaze_deg) = learnt.gaze_deg {
            self.natural_gaze = Natural::guessed(gaze_deg, &self.config);
        }
        if let Some(place_mm) = learnt.place_mm {
            self.seat = Seat::guessed(place_mm);
        }
        Ok(())
    }

    /// Takes one observation. Timestamps may come at any rate. One that is before the last one ends
    /// closures, yawns and glances, keeps the measures, and time goes on from there: drowsiness and
    /// unknown eyes last on, and begin at that timestamp.
    pub fn update(&mut self, seen: &Observation, now_us: i64) -> Result<(), MonitorTimeError> {
        match self.clock.pass(now_us).ok_or(MonitorTimeError)? {
            Passed::Nothing => self.sight.since_us = now_us,
            Passed::Time(time_us) if time_us <= self.config.gap_us => {
                self.pass(time_us, self.reading, self.aim.by.is_some(), now_us);
            }
            Passed::Time(time_us) => self.pass(time_us, Reading::NONE, false, now_us),
            Passed::Back => self.interrupt(now_us),
        }
        let open_eye = self.baseline.open_eye();
        self.reading = Reading::new(seen, &self.reading, open_eye, &self.seat, &self.config);
        let (head, gaze) = (&self.natural, &self.natural_gaze);
        self.directions = Directions::new(&self.reading, head, gaze, &self.config);
        self.see(now_us);
        Ok(())
    }

    /// Lets time pass with what was read at its beginning.
    fn pass(&mut self, time_us: u32, held: Reading, is_directed: bool, now_us: i64) {
        self.lowered.pass(time_us, &held);
        let (lids, held) = (held.lids(), self.without_doubt(held));
        let (config, log) = (&self.config, &mut self.log);
        let sure = held.openness.ok().filter(|_| !held.may_look_down);
        self.windows.pass(time_us, sure);
        self.drowsy_us = self.drowsy_us.saturating_add(time_us);
        let ended = (self.closures).pass(time_us, lids, now_us, config, log);
        if let Some(closed_us) = ended {
            self.windows.add_closure(closed_us);
        }
        self.yawns.pass(time_us, held.jaw, now_us, config, log);
        let is_closed = self.closures.is_closed() && held.openness.is_ok();
        let pitch = held.pose.map(|pose| pose.pitch_deg());
        self.nods.pass(time_us, pitch, is_closed, config);
        let is_known = held.gaze_deg.is_some();
        (self.look_down).pass(time_us, is_known, now_us, config, log);
        self.aim.pass(time_us, is_known);
        let zone = match is_directed {
            true => self.glances.zone,
            false => ZoneState::Unknown,
        };
        (self.glances).pass(time_us, zone, &self.zones, now_us, config, log);
        self.learn(time_us, &held, now_us);
        self.watch_sight(time_us, held.openness.is_ok(), now_us);
    }

    /// A reading as all but the closures see it: lids that may follow a lowered gaze are unknown.
    fn without_doubt(&self, mut reading: Reading) -> Reading {
        if reading.openness.is_ok() && self.closures.is_doubted() {
            reading.openness = Err(UnknownReason::Hidden);
        }
        reading
    }

    /// Learns open eye, natural pose and gaze, and the driver's place.
    fn learn(&mut self, time_us: u32, held: &Reading, now_us: i64) {
        let mut learnt = |kind, value| {
            self.log.push(MonitorEvent {
                timestamp_us: now_us,
                start_us: now_us,
                kind,
                value,
                ..MonitorEvent::default()
            });
        };
        if let Some(at_mm) = held.at_mm {
            self.seat.pass(time_us, at_mm, &self.config);
        }
        let is_long = self.closures.closed_us() > self.config.long_closure_us;
        if held.openness.is_ok() && self.baseline.pass(time_us, held.eyes, is_long) {
            let [left, right] = self.baseline.open_eye();
            learnt(MonitorEventKind::OpenEyeLearnt, (left + right) / 2.0);
        }
        if let Some(pose) = held.pose {
            let config = &self.config;
            let forward_deg = [config.forward_yaw_deg, config.forward_pitch_deg];
            let from_forward = |[yaw, pitch]: [f32; 2]| {
                let [forward_yaw, forward_pitch] = forward_deg;
                [yaw - forward_yaw, pitch - forward_pitch]
            };
            if (self.natural).pass(time_us, from_forward(pose.turn_deg), config) {
                let [yaw, _] = self.natural.offset_deg();
                learnt(MonitorEventKind::NaturalLearnt, yaw);
            }
            if let Some(gaze_deg) = held.gaze_deg {
                (self.natural_gaze).pass(time_us, from_forward(gaze_deg), config);
            }
        }
    }

    /// Reports eyes that are unknown for long.
    fn watch_sight(&mut self, time_us: u32, is_known: bool, now_us: i64) {
        let sight = &mut self.sight;
        let kind = if is_known {
            let was_degraded = core::mem::take(&mut sight.is_degraded);
            was_degraded.then_some(MonitorEventKind::Restored)
        } else {
            sight.unknown_us = sight.unknown_us.saturating_add(time_us);
            let is_new = sight.unknown_us >= self.config.degraded_us && !sight.is_degraded;
            sight.is_degraded |= is_new;
            is_new.then_some(MonitorEventKind::Degraded)
        };
        if let Some(kind) = kind {
            self.log.push(MonitorEvent {
                timestamp_us: now_us,
                start_us: sight.since_us,
                duration_us: sight.unknown_us,
                kind,
                ..MonitorEvent::default()
            });
        }
        if is_known {
            (self.sight.unknown_us, self.sight.since_us) = (0, now_us);
        }
    }

    /// Lets the parts see what was read now.
    fn see(&mut self, now_us: i64) {
        let (config, log) = (&self.config, &mut self.log);
        if let Ok(openness) = self.reading.openness {
            let was_lowered = self.lowered.is_recent();
            let ended = (self.closures).see(openness, was_lowered, now_us, config, log);
            if let Some(closed_us) = ended {
                self.windows.add_closure(closed_us);
            }
        }
        if let Some(jaw) = self.reading.jaw {
            self.yawns.see(jaw, now_us, config, log);
        }
        if let Some(pitch) = self.reading.pose.map(|pose| pose.pitch_deg()) {
            self.nods.see(pitch, now_us, config, log);
        }
        if let Some([_, pitch]) = self.directions.gaze_deg {
            (self.look_down).see(pitch, now_us, config, log);
        }
        let (last, is_lowered) = (self.glances.zone, self.look_down.is_on());
        let zone = (self.aim).see(&self.directions, is_lowered, &self.zones, last, config);
        self.glances.see(zone, &self.zones, now_us);
        self.watch_drowsiness(now_us);
    }

    fn watch_drowsiness(&mut self, now_us: i64) {
        let windows = self.windows.measures();
        let next = drowsiness::next(self.drowsiness, &windows, &self.config);
        let last = core::mem::replace(&mut self.drowsiness, next);
        let kind = match (last == Drowsiness::Drowsy, next == Drowsiness::Drowsy) {
            (false, true) => MonitorEventKind::Drowsy,
            (true, false) => MonitorEventKind::DrowsyEnd,
            _ => return,
        };
        if next == Drowsiness::Drowsy {
            (self.drowsy_since_us, self.drowsy_us) = (now_us, 0);
        }
        self.log.push(MonitorEvent {
            timestamp_us: now_us,
            start_us: self.drowsy_since_us,
            duration_us: self.drowsy_us,
            kind,
            value: windows[0].p80,
            ..MonitorEvent::default()
        });
    }

    /// The clock was set back: what goes on ends.
    fn interrupt(&mut self, now_us: i64) {
        let (config, log) = (&self.config, &mut self.log);
        if let Some(closed_us) = self.closures.end(now_us, true, config, log) {
            self.windows.add_closure(closed_us);
        }
        self.yawns.end(now_us, true, config, log);
        self.nods.forget();
        self.look_down.end(now_us, true, config, log);
        self.glances.end(now_us, true, log);
        self.glances.interrupt();
        (self.reading, self.directions) = (Reading::NONE, Directions::NONE);
        (self.aim, self.lowered) = (Aim::NONE, Lowered::NEVER);
        (self.sight.since_us, self.drowsy_since_us) = (now_us, now_us);
        log.push(MonitorEvent {
            timestamp_us: now_us,
            start_us: now_us,
            kind: MonitorEventKind::ClockBack,
            ..MonitorEvent::default()
        });
    }

    /// What is known after the last observation.
    pub fn state(&self) -> MonitorState {
        let reading = self.without_doubt(self.reading);
        let [perclos_60, perclos_180] = self.windows.measures();
        MonitorState {
            timestamp_us: self.clock.last_us(),
            eyes: match (reading.openness, self.closures.is_closed()) {
                (Err(reason), _) => EyeState::Unknown(reason),
                (_, true) => EyeState::Closed,
                (_, false) => EyeState::Open,
            },
            openness: reading.openness.ok(),
            closure_us: self.closures.closed_us(),
            perclos_60,
            perclos_180,
            blinks: self.closures.blinks,
            yawns: self.yawns.count,
            nods: self.nods.count,
            mouth_open_us: self.yawns.open_us(),
            look_down_us: self.look_down.time_us(),
            zone: self.glances.zone,
            zone_by: self.aim.by,
            zone_us: self.glances.zone_us,
            away_us: self.glances.away_us(),
            away_30_us: self.glances.recent_us(),
            zones_us: self.glances.zones_us,
            from_road_deg: self.directions.head_deg,
            gaze_from_road_deg: (self.directions.by_gaze)
                .map(|at| [at.yaw_deg, at.pitch_deg])
                .or(self.directions.gaze_deg),
            natural_deg: self.natural.offset_deg(),
            natural_is_final: self.natural.is_final(&self.config),
            natural_gaze_deg: self.natural_gaze.offset_deg(),
            natural_gaze_is_final: self.natural_gaze.is_final(&self.config),
            open_eye: self.baseline.open_eye(),
            open_eye_is_final: self.baseline.is_final(),
            place_mm: self.seat.at_mm(&self.config),
            place_is_final: self.seat.is_final(&self.config),
            drowsiness: self.drowsiness,
            degraded: self.sight.is_degraded,
        }
    }
}
