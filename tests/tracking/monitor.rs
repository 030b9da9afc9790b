//! The driver monitor against a reference that keeps every observation and computes its measures
//! from scratch, over simulated hours with jitter, dropped frames and clocks that jump; and what
//! single events need.
#![cfg(feature = "monitor")]

use crate::common::random::Random;
use posewise::State;
use posewise::monitor::{
    EyeState, MAX_ZONES, Monitor, MonitorConfig, MonitorEvent, MonitorEventKind, Observation,
    Preset, UnknownReason, Zone, ZoneShape, ZoneState, ZonesBy,
};

const SECOND_US: u64 = 1_000_000;

/// A face that is tracked.
fn face(openness: Option<f32>, yaw_deg: f32) -> Observation {
    let mut seen = Observation::default();
    seen.state = State::Tracking;
    seen.confidence = 0.99;
    seen.yaw_deg = yaw_deg;
    seen.translation_mm = [0.0, 0.0, 700.0];
    seen.eye_open = [openness; 2];
    seen.jaw_open = Some(0.0);
    seen
}

/// Settings that know the road: nothing is learnt.
fn fixed() -> MonitorConfig {
    let mut config = MonitorConfig::default();
    config.natural_yaw_deg = 0.0;
    // The gazes here are exact.
    config.gaze_gain = 1.0;
    config
}

fn drain(monitor: &mut Monitor) -> Vec<MonitorEvent> {
    std::iter::from_fn(|| monitor.events().pop()).collect()
}

/// Shows observations at a frame rate; returns the events.
struct Show {
    monitor: Monitor,
    now_us: i64,
    step_us: i64,
}

impl Show {
    fn new(config: &MonitorConfig, fps: i64) -> Show {
        Show {
            monitor: Monitor::new(config).expect("good settings"),
            now_us: 1_000_000,
            step_us: 1_000_000 / fps,
        }
    }

    fn show(&mut self, seconds: f64, seen: &Observation) -> Vec<MonitorEvent> {
        let frames = (seconds * 1e6 / self.step_us as f64).round() as usize;
        let mut events = Vec::new();
        for _ in 0..frames {
            self.monitor
                .update(seen, self.now_us)
                .expect("time goes on");
            self.now_us += self.step_us;
            events.extend(drain(&mut self.monitor));
        }
        events
    }
}

fn kinds(events: &[MonitorEvent]) -> Vec<MonitorEventKind> {
    events.iter().map(|event| event.kind).collect()
}

/// A stretch of time and what was read at its beginning.
#[derive(Clone, Copy)]
struct Stretch {
    /// Time since the first observation \[µs\].
    at_us: u64,
    time_us: u64,
    openness: Option<f32>,
    zone: Option<usize>,
}

/// Everything that was observed.
#[derive(Default)]
struct Reference {
    elapsed_us: u64,
    stretches: Vec<Stretch>,
    /// When closures ended, and their lengths.
    closures: Vec<(u64, u64)>,
}

impl Reference {
    /// Sum over the part of each stretch that lies in a window.
    fn sum(&self, from_us: u64, to_us: u64, of: impl Fn(&Stretch) -> u64) -> u64 {
        let within = |s: &Stretch| {
            let end = (s.at_us + s.time_us).min(to_us);
            end.saturating_sub(s.at_us.max(from_us))
        };
        self.stretches.iter().map(|s| within(s) * of(s)).sum()
    }

    /// P70, P80, EM, known share, closures, their mean: over the last complete seconds.
    fn measures(&self, seconds: u64) -> ([f32; 4], u32, u32) {
        let to_us = self.elapsed_us / SECOND_US * SECOND_US;
        let from_us = to_us.saturating_sub(seconds * SECOND_US);
        let below = |limit: f32| {
            self.sum(from_us, to_us, |s| {
                u64::from(s.openness.is_some_and(|o| o <= limit))
            })
        };
        let known = self.sum(from_us, to_us, |s| u64::from(s.openness.is_some()));
        let square = |s: &Stretch| {
            let closure = 1.0 - s.openness.unwrap_or(1.0);
            (closure * closure * 1024.0) as u64
        };
        let em = self.sum(from_us, to_us, square);
        let share = |sum: u64| {
            if known == 0 {
                0.0
            } else {
                sum as f32 / known as f32
            }
        };
        let in_window = |at: &u64| (from_us..to_us).contains(at);
        let ended = self.closures.iter().filter(|(at, _)| in_window(at));
        let lengths: Vec<u64> = ended.map(|(_, length)| *length).collect();
        let count = lengths.len() as u64;
        let mean = lengths.iter().sum::<u64>().checked_div(count).unwrap_or(0);
        let known_share = known as f32 / (seconds * SECOND_US) as f32;
        (
            [
                share(below(0.3)),
                share(below(0.2)),
                share(em) / 1024.0,
                known_share,
            ],
            count as u32,
            mean as u32,
        )
    }

    /// Time away from the road in the current quarter of a second and the 119 before.
    fn away_us(&self, is_road: impl Fn(usize) -> bool, clear_us: u64) -> u64 {
        let bin_us = SECOND_US / 4;
        let from_us = (self.elapsed_us / bin_us + 1).saturating_sub(120) * bin_us;
        // Clearing: at the end of a stretch that makes the time on the road long enough.
        let (mut road_us, mut unknown_us, mut cleared) = (0, 0, 0);
        for stretch in &self.stretches {
            match stretch.zone {
                None => {
                    unknown_us += stretch.time_us;
                    road_us = if unknown_us > 300_000 { 0 } else { road_us };
                    continue;
                }
                Some(zone) if is_road(zone) => road_us += stretch.time_us,
                Some(_) => road_us = 0,
            }
            unknown_us = 0;
            if road_us >= clear_us {
                cleared = stretch.at_us + stretch.time_us;
            }
        }
        self.sum(from_us.max(cleared), u64::MAX, |s| {
            u64::from(s.zone.is_some_and(|zone| !is_road(zone)))
        })
    }
}

/// A driver who blinks, sleeps, looks around and disappears.
struct Driver {
    random: Random,
    openness: Option<f32>,
    yaw_deg: Option<f32>,
    until_us: [u64; 2],
}

impl Driver {
    fn act(&mut self, now_us: u64) {
        let random = &mut self.random;
        if now_us >= self.until_us[0] {
            let (seconds, openness) = match random.next() % 8 {
                0 | 1 => (random.within(0.05, 0.4), Some(random.within(0.0, 0.3))),
                2 => (random.within(0.4, 8.0), Some(random.within(0.0, 0.25))),
                3 => (random.within(0.05, 3.0), None),
                4 => (random.within(0.1, 2.0), Some(random.within(0.2, 0.5))),
                _ => (random.within(0.5, 6.0), Some(random.within(0.4, 1.0))),
            };
            self.openness = openness.map(|o| o as f32);
            self.until_us[0] = now_us + (seconds * 1e6) as u64;
        }
        if now_us >= self.until_us[1] {
            let (seconds, yaw) = match random.next() % 4 {
                0 => (random.within(0.05, 5.0), Some(30.0)),
                1 => (random.within(0.05, 1.0), None),
                _ => (random.within(0.1, 4.0), Some(0.0)),
            };
            self.yaw_deg = yaw;
            self.until_us[1] = now_us + (seconds * 1e6) as u64;
        }
    }
}

/// Zones of the simulation: the road, and everything to the image right.
fn two_zones() -> [Zone; 2] {
    let side = |yaw_deg| {
        Zone::new(ZoneShape::Angles {
            yaw_deg,
            pitch_deg: [-90.0, 90.0],
        })
    };
    [side([-15.0, 15.0]).as_road(), side([15.0, 90.0])]
}

/// Hours of driving at a rate, with every measure compared at random times.
fn compare(seed: u64, fps: f64, hours: f64) {
    let config = fixed();
    let mut monitor = Monitor::with_zones(&config, &two_zones()).expect("good settings");
    let mut reference = Reference::default();
    let mut driver = Driver {
        random: Random(seed),
        openness: None,
        yaw_deg: None,
        until_us: [0; 2],
    };
    let mut now_us = 7_000_000i64;
    let mut last: Option<(i64, Stretch)> = None;
    let (mut checks, mut known_checks) = (0, 0);
    while (reference.elapsed_us as f64) < hours * 3.6e9 {
        driver.act(reference.elapsed_us);
        let random = &mut driver.random;
        // Jitter; a frame in ten is dropped; a clock that jumps ahead or back, and long gaps.
        let mut step_us = (1e6 / fps * random.within(0.7, 1.3)) as i64;
        step_us *= if random.is(0.1) { 2 } else { 1 };
        match random.next() % 20_000 {
            0 => step_us = (random.within(0.3, 400.0) * 1e6) as i64,
            1 => step_us = -(random.within(0.0, 900.0) * 1e6) as i64,
            2 => step_us = 3_000_000,
            _ => {}
        }
        now_us += step_us.max(1 - now_us);
        let yaw_deg = driver.yaw_deg.unwrap_or(f32::NAN);
        // A head without a known pose has no known eyes.
        let openness = driver.openness.filter(|_| driver.yaw_deg.is_some());
        let seen = face(openness, yaw_deg);
        if let Some((before_us, stretch)) = last {
            if now_us == before_us {
                continue;
            }
            if now_us > before_us {
                let time_us = (now_us - before_us) as u64;
                let holds = time_us <= u64::from(config.gap_us);
                reference.stretches.push(Stretch {
                    at_us: reference.elapsed_us,
                    time_us,
                    openness: stretch.openness.filter(|_| holds),
                    zone: stretch.zone.filter(|_| holds),
                });
                reference.elapsed_us += time_us;
            }
        }
        monitor.update(&seen, now_us).expect("another time");
        for event in drain(&mut monitor) {
            let is_end = matches!(
                event.kind,
                MonitorEventKind::Blink | MonitorEventKind::ClosureEnd
            );
            if is_end {
                let length = u64::from(event.duration_us);
                reference.closures.push((reference.elapsed_us, length));
            }
        }
        // Relative to this driver's open eyes, once they are learnt.
        let read = monitor.state().openness;
        assert_eq!(read.is_some(), openness.is_some());
        let stretch = Stretch {
            at_us: 0,
            time_us: 0,
            openness: read,
            zone: driver.yaw_deg.map(|yaw| usize::from(yaw > 15.0)),
        };
        last = Some((now_us, stretch));
        if driver.random.is(0.002) {
            let state = monitor.state();
            check(&reference, &state, &config);
            checks += 1;
            known_checks += u32::from(state.perclos_180.known > 0.5);
        }
    }
    assert!(
        checks > 100 && known_checks > checks / 2,
        "{checks} {known_checks}"
    );
}

fn check(reference: &Reference, state: &posewise::monitor::MonitorState, config: &MonitorConfig) {
    let seconds = [(60, &state.perclos_60), (180, &state.perclos_180)];
    for (seconds, found) in seconds {
        let (shares, closures, mean_us) = reference.measures(seconds);
        let at = format!("{seconds} s at {} µs", reference.elapsed_us);
        assert_eq!(
            [found.p70, found.p80, found.em, found.known],
            shares,
            "{at}"
        );
        assert_eq!(
            (found.closures, found.mean_closure_us),
            (closures, (closures > 0).then_some(mean_us)),
            "{at}"
        );
    }
    let away_us = reference.away_us(|zone| zone == 0, u64::from(config.clear_us));
    assert_eq!(
        u64::from(state.away_30_us),
        away_us,
        "at {} µs",
        reference.elapsed_us
    );
    for zone in 0..MAX_ZONES {
        let dwell = reference.sum(0, u64::MAX, |s| u64::from(s.zone == Some(zone)));
        assert_eq!(state.zones_us[zone], dwell);
    }
}

#[test]
fn windows_are_exact_at_30_frames_per_second() {
    compare(1, 30.0, 1.5);
}

#[test]
fn windows_are_exact_at_10_frames_per_second() {
    compare(2, 10.0, 5.0);
}

#[test]
fn windows_are_exact_at_an_odd_rate() {
    compare(3, 7.3, 5.0);
}

#[test]
fn closures_have_their_length_and_level() {
    use MonitorEventKind::*;
    for fps in [10, 15, 30, 60] {
        let levels = [
            (0.2, vec![Blink]),
            (0.4, vec![Blink]),
            (0.8, vec![LongClosure, ClosureEnd]),
            (1.5, vec![LongClosure, Microsleep, ClosureEnd]),
            (3.5, vec![LongClosure, Microsleep, Sleep, ClosureEnd]),
            (
                7.0,
                vec![LongClosure, Microsleep, Sleep, Unresponsive, ClosureEnd],
            ),
        ];
        for (seconds, expected) in levels {
            let mut show = Show::new(&fixed(), fps);
            show.show(2.0, &face(Some(0.9), 0.0));
            let start_us = show.now_us;
            let mut events = show.show(seconds, &face(Some(0.05), 0.0));
            events.extend(show.show(1.0, &face(Some(0.9), 0.0)));
            assert_eq!(kinds(&events), expected, "{seconds} s at {fps}");
            let end = events.last().expect("an end");
            let off = f64::from(end.duration_us) / 1e6 - seconds;
            assert!(
                off.abs() <= 0.5 / fps as f64,
                "{seconds} s at {fps}: {end:?}"
            );
            assert!(events.iter().all(|event| event.start_us == start_us));
        }
    }
}

#[test]
fn a_lid_that_hovers_is_one_closure() {
    let mut show = Show::new(&fixed(), 30);
    show.show(2.0, &face(Some(0.9), 0.0));
    let mut events = Vec::new();
    for _ in 0..20 {
        events.extend(show.show(0.1, &face(Some(0.25), 0.0)));
        events.extend(show.show(0.1, &face(Some(0.4), 0.0)));
    }
    events.extend(show.show(1.0, &face(Some(0.9), 0.0)));
    let ends = |kind| events.iter().filter(|event| event.kind == kind).count();
    assert_eq!(ends(MonitorEventKind::ClosureEnd), 1, "{events:?}");
    assert_eq!(ends(MonitorEventKind::Blink), 0);
}

/// The commonest failure in the field: eyes that are not seen count as closed.
#[test]
fn the_unknown_is_never_closed() {
    let unseen: [(Observation, UnknownReason); 5] = [
        (face(None, 0.0), UnknownReason::Hidden),
        (face(Some(0.0), 60.0), UnknownReason::Turned),
        (face(Some(0.0), -60.0), UnknownReason::Turned),
        (Observation::default(), UnknownReason::NoFace),
        (
            {
                let mut seen = face(Some(0.0), 0.0);
                seen.confidence = 0.2;
                seen
            },
            UnknownReason::LowConfidence,
        ),
    ];
    for (unseen, why) in unseen {
        let mut show = Show::new(&fixed(), 30);
        show.show(65.0, &face(Some(0.9), 0.0));
        // A lid that closes while it is being hidden.
        let mut events = show.show(0.1, &face(Some(0.1), 0.0));
        events.extend(show.show(9.0, &unseen));
        let state = show.monitor.state();
        assert_eq!(state.eyes, EyeState::Unknown(why));
        assert_eq!((state.openness, state.closure_us), (None, 0));
        assert!(state.perclos_60.p80 < 0.002 && state.perclos_60.known < 0.87);
        events.extend(show.show(2.0, &face(Some(0.9), 0.0)));
        let closed = |event: &MonitorEvent| (event.kind as usize) < 6;
        assert!(!events.iter().any(closed), "{why:?}: {events:?}");
    }
}

#[test]
fn a_closure_goes_on_through_a_short_unknown() {
    let mut show = Show::new(&fixed(), 30);
    show.show(2.0, &face(Some(0.9), 0.0));
    let mut events = show.show(0.6, &face(Some(0.1), 0.0));
    events.extend(show.show(0.2, &face(None, 0.0)));
    events.extend(show.show(0.6, &face(Some(0.1), 0.0)));
    events.extend(show.show(0.2, &face(Some(0.9), 0.0)));
    use MonitorEventKind::*;
    assert_eq!(kinds(&events), [LongClosure, Microsleep, ClosureEnd]);
    let length = events[2].duration_us;
    assert!((1_150_000..1_250_000).contains(&length), "{length}");
}

#[test]
fn yawns_are_counted_and_talking_is_not() {
    use MonitorEventKind::*;
    let jaw = |open| {
        let mut seen = face(Some(0.9), 0.0);
        seen.jaw_open = Some(open);
        seen
    };
    let mut show = Show::new(&fixed(), 15);
    let mut events = Vec::new();
    for _ in 0..30 {
        events.extend(show.show(0.2, &jaw(0.7)));
        events.extend(show.show(0.2, &jaw(0.1)));
    }
    assert_eq!(kinds(&events), []);
    events.extend(show.show(4.0, &jaw(0.8)));
    events.extend(show.show(1.0, &jaw(0.1)));
    assert_eq!(kinds(&events), [Yawn, YawnEnd]);
    assert!((events[1].duration_us as i64 - 4_000_000).abs() < 70_000);
    // A mouth that stays open has not yawned.
    show.show(20.0, &jaw(0.8));
    show.show(1.0, &jaw(0.1));
    assert_eq!(show.monitor.state().yawns, 1);
}

#[test]
fn nods_need_closed_eyes_and_a_return() {
    let count = |openness: f32, depth_deg: f32, down: f64, back: bool| {
        let mut show = Show::new(&fixed(), 30);
        show.show(2.0, &face(Some(0.9), 0.0));
        let pitch = |pitch_deg: f32| {
            let mut seen = face(Some(openness), 0.0);
            seen.pitch_deg = pitch_deg;
            seen
        };
        for step in 0..12 {
            show.show(0.06, &pitch(-depth_deg * step as f32 / 12.0));
        }
        show.show(down, &pitch(-depth_deg));
        if back {
            show.show(1.0, &face(Some(0.9), 0.0));
        }
        show.show(4.0, &face(Some(0.9), 0.0));
        show.monitor.state().nods
    };
    assert_eq!(count(0.05, 16.0, 0.8, true), 1);
    assert_eq!(count(0.9, 16.0, 0.8, true), 0, "open eyes");
    assert_eq!(count(0.05, 8.0, 0.8, true), 0, "not deep");
    assert_eq!(count(0.05, 16.0, 5.0, true), 0, "too long");
    // A glance at the lap, with a blink.
    let mut show = Show::new(&fixed(), 30);
    let looks = |openness: f32, pitch_deg: f32| {
        let mut seen = face(Some(openness), 0.0);
        seen.pitch_deg = pitch_deg;
        seen
    };
    show.show(2.0, &looks(0.9, 0.0));
    show.show(1.0, &looks(0.7, -20.0));
    show.show(0.2, &looks(0.05, -20.0));
    show.show(1.0, &looks(0.7, -20.0));
    show.show(1.0, &looks(0.9, 0.0));
    assert_eq!(show.monitor.state().nods, 0, "a blink");
}

#[test]
fn glances_are_timed() {
    use MonitorEventKind::*;
    let lap = |seconds: f64, show: &mut Show| {
        let mut seen = face(Some(0.9), 0.0);
        seen.pitch_deg = -35.0;
        show.show(seconds, &seen)
    };
    let road = face(Some(0.9), 0.0);
    let mut show = Show::new(&fixed(), 30);
    assert_eq!(kinds(&show.show(3.0, &road)), []);
    let mut events = lap(3.5, &mut show);
    assert_eq!(show.monitor.state().zone, ZoneState::In(1));
    events.extend(show.show(1.0, &road));
    assert_eq!(kinds(&events), [LongGlance, Glance]);
    assert_eq!((events[1].zone, events[1].is_cut), (Some(1), false));
    // 3.5 s, and four times 2 s with a second between: 10 s within 30.
    let mut events = Vec::new();
    for _ in 0..4 {
        events.extend(lap(2.0, &mut show));
        events.extend(show.show(1.0, &road));
    }
    let cumulative = |events: &[MonitorEvent]| {
        let all = events.iter();
        all.filter(|event| event.kind == CumulativeGlance).count()
    };
    assert_eq!(cumulative(&events), 1, "{events:?}");
    // Two seconds on the road clear it.
    show.show(1.5, &road);
    assert_eq!(show.monitor.state().away_30_us, 0);
    // A short look at a mirror does not count.
    let events = show.show(0.9, &face(Some(0.9), 35.0));
    assert_eq!(show.monitor.state().away_us, 0, "{events:?}");
    show.show(1.1, &face(Some(0.9), 35.0));
    let away_us = show.monitor.state().away_us;
    assert!((900_000..1_050_000).contains(&away_us), "{away_us}");
}

/// A face whose eyes look down by so much from straight ahead.
fn looking_down(openness: f32, down_deg: f32) -> Observation {
    let (down, level) = down_deg.to_radians().sin_cos();
    let mut seen = face(Some(openness), 0.0);
    seen.gaze = Some([0.0, down, -level]);
    seen
}

#[test]
fn a_look_down_is_off_the_road_and_no_closure() {
    use MonitorEventKind::{Glance, LongGlance, LookDown, LookDownEnd};
    let mut show = Show::new(&fixed(), 25);
    assert_eq!(show.show(2.0, &looking_down(1.0, 2.0)), []);
    // At the telephone for 4 s, with a blink; the head does not move.
    let mut events = show.show(2.0, &looking_down(0.8, 40.0));
    let state = show.monitor.state();
    assert_eq!((state.eyes, state.zone), (EyeState::Open, ZoneState::In(1)));
    assert!((1_900_000..2_100_000).contains(&state.look_down_us));
    events.extend(show.show(0.16, &face(Some(0.0), 0.0)));
    events.extend(show.show(1.9, &looking_down(0.8, 40.0)));
    events.extend(show.show(2.0, &looking_down(1.0, 2.0)));
    let seen: Vec<_> = kinds(&events);
    let blink = MonitorEventKind::Blink;
    assert_eq!(seen, [LookDown, blink, LongGlance, LookDownEnd, Glance]);
    assert_eq!(show.monitor.state().look_down_us, 0);
    let [.., end, _] = &events[..] else {
        panic!("{events:?}");
    };
    // Without the time in which the lids were shut.
    assert!((3_850_000..3_950_000).contains(&end.duration_us), "{end:?}");
    // Too short, and not low enough.
    for (seconds, down_deg) in [(0.3, 25.0), (0.3, 2.0), (2.0, 14.0)] {
        let events = show.show(seconds, &looking_down(0.8, down_deg));
        assert_eq!(kinds(&events).into_iter().find(|k| *k != Glance), None);
    }
}

/// Lids of a driver who looks down are seen as shut, or one of them is, or the network is not sure.
#[test]
fn lids_after_a_lowered_gaze_are_believed_when_both_stay_shut() {
    use MonitorEventKind::{Blink, ClosureEnd, LongClosure, Microsleep};
    let of_lids = |events: &[MonitorEvent]| -> Vec<MonitorEventKind> {
        let kinds = kinds(events).into_iter();
        kinds
            .filter(|kind| [Blink, ClosureEnd, LongClosure, Microsleep].contains(kind))
            .collect()
    };
    let shut = face(Some(0.0), 0.0);
    let (mut unsure, mut one) = (face(Some(0.1), 0.0), shut);
    unsure.may_look_down = true;
    one.eye_open = [Some(0.0), None];
    let mut show = Show::new(&fixed(), 25);
    show.show(1.0, &looking_down(0.8, 30.0));
    let mut events = Vec::new();
    for _ in 0..5 {
        events.extend(show.show(0.6, &shut));
        events.extend(show.show(0.4, &unsure));
    }
    events.extend(show.show(2.0, &one));
    let state = show.monitor.state();
    assert_eq!(state.eyes, EyeState::Unknown(UnknownReason::Hidden));
    assert_eq!(state.perclos_60.p80, 0.0);
    events.extend(show.show(1.0, &looking_down(0.8, 30.0)));
    assert_eq!(of_lids(&events), [Blink]);
    // Falls asleep over it.
    let start_us = show.now_us;
    let events = show.show(1.3, &shut);
    assert_eq!(of_lids(&events), [LongClosure, Microsleep]);
    assert_eq!(show.monitor.state().eyes, EyeState::Closed);
    let sleep = events.iter().find(|event| event.kind == Microsleep);
    let sleep = sleep.expect("a microsleep");
    assert_eq!(sleep.start_us, start_us, "its whole time counts");
    assert!((1_000_000..1_050_000).contains(&sleep.duration_us));
    // A gaze that is up again is forgotten.
    show.show(0.5, &looking_down(0.8, 0.0));
    let events = show.show(0.6, &one);
    assert_eq!(of_lids(&events), [LongClosure]);
}

/// A head that is on the road, whose eyes look this far to the image right and up.
fn looking(yaw_deg: f32, pitch_deg: f32, sigma_deg: f32) -> Observation {
    let (yaw, pitch) = (yaw_deg.to_radians(), pitch_deg.to_radians());
    let mut seen = face(Some(0.9), 0.0);
    let level = pitch.cos();
    seen.gaze = Some([level * yaw.sin(), -pitch.sin(), -level * yaw.cos()]);
    seen.gaze_sigma_deg = sigma_deg;
    seen
}

#[test]
fn zones_are_met_by_the_gaze_and_by_the_head_where_it_is_unknown() {
    use MonitorEventKind::Glance;
    let mut show = Show::new(&fixed(), 25);
    show.show(2.0, &looking(0.0, 0.0, 5.0));
    let at = |show: &Show| (show.monitor.state().zone, show.monitor.state().zone_by);
    assert_eq!(at(&show), (ZoneState::In(0), Some(ZonesBy::Gaze)));
    // Eyes alone at a mirror: a moment later they are there, and the state says where.
    show.show(0.08, &looking(35.0, 2.0, 5.0));
    assert_eq!(at(&show).0, ZoneState::In(0), "no glance is as short");
    show.show(1.4, &looking(35.0, 2.0, 5.0));
    assert_eq!(at(&show), (ZoneState::In(3), Some(ZonesBy::Gaze)));
    let [yaw, pitch] = show.monitor.state().gaze_from_road_deg.expect("a gaze");
    assert!((yaw - 35.0).abs() < 0.1 && (pitch - 2.0).abs() < 0.1);
    assert_eq!(
        show.monitor.state().from_road_deg,
        Some([0.0; 2]),
        "the face"
    );
    let events = show.show(1.0, &looking(0.0, 0.0, 5.0));
    let [glance] = &events[..] else {
        panic!("{events:?}");
    };
    assert_eq!((glance.kind, glance.zone), (Glance, Some(3)));
    assert!(
        (1_300_000..1_600_000).contains(&glance.duration_us),
        "{glance:?}"
    );
    // Without a gaze the head's turn counts one and a half times.
    show.show(1.0, &face(Some(0.9), 18.0));
    assert_eq!(at(&show), (ZoneState::In(3), Some(ZonesBy::Head)));
    show.show(1.0, &face(Some(0.9), 0.0));
    assert_eq!(at(&show), (ZoneState::In(0), Some(ZonesBy::Head)));
    show.show(0.1, &Observation::default());
    assert_eq!(at(&show), (ZoneState::Unknown, None));
}

#[test]
fn blinks_and_saccades_end_no_glance() {
    let mut show = Show::new(&fixed(), 25);
    show.show(2.0, &looking(0.0, 0.0, 5.0));
    let mut events = Vec::new();
    for _ in 0..3 {
        events.extend(show.show(1.5, &looking(-33.0, 0.0, 5.0)));
        // A blink, and a gaze that passes the road.
        events.extend(show.show(0.2, &face(Some(0.05), 0.0)));
        events.extend(show.show(1.0, &looking(-33.0, 0.0, 5.0)));
        events.extend(show.show(0.08, &looking(2.0, 0.0, 5.0)));
    }
    let zone = show.monitor.state().zone;
    assert_eq!(zone, ZoneState::In(4));
    let long = kinds(&events);
    let long = long
        .iter()
        .filter(|kind| **kind == MonitorEventKind::LongGlance);
    assert_eq!(long.count(), 1, "{events:?}");
    // A gaze that stays unknown is one: the head is on the road.
    let events = show.show(1.0, &face(Some(0.9), 0.0));
    assert_eq!(kinds(&events), [MonitorEventKind::Glance]);
}

#[test]
fn an_uncertain_gaze_leaves_a_zone_farther_outside() {
    let zone_of = |config: &MonitorConfig, yaw_deg: f32, sigma_deg: f32| {
        let mut show = Show::new(config, 25);
        show.show(1.0, &looking(0.0, 0.0, sigma_deg));
        show.show(1.0, &looking(yaw_deg, 0.0, sigma_deg));
        (show.monitor.state().zone, show.monitor.state().zone_by)
    };
    let zone = |yaw_deg: f32, sigma_deg: f32| zone_of(&fixed(), yaw_deg, sigma_deg);
    let gaze = Some(ZonesBy::Gaze);
    let mut config = fixed();
    config.gaze_gain = 1.3;
    assert_eq!(zone_of(&config, 17.0, 2.0), (ZoneState::In(3), gaze));
    assert_eq!(zone(17.0, 2.0), (ZoneState::In(0), gaze));
    assert_eq!(zone(20.0, 2.0), (ZoneState::In(3), gaze));
    assert_eq!(zone(20.0, 10.0), (ZoneState::In(0), gaze));
    assert_eq!(zone(25.0, 10.0), (ZoneState::In(3), gaze));
    assert_eq!(zone(25.0, 16.0), (ZoneState::In(0), Some(ZonesBy::Head)));
}

#[test]
fn heads_alone_are_as_they_were() {
    let mut config = fixed();
    config.zones_by = ZonesBy::Head;
    let mut show = Show::new(&config, 25);
    for (seen, zone, by) in [
        (looking(35.0, 0.0, 5.0), 0, ZonesBy::Head),
        (looking(0.0, -40.0, 5.0), 1, ZonesBy::Gaze),
        (face(Some(0.9), 14.0), 0, ZonesBy::Head),
        (face(Some(0.9), 19.0), 3, ZonesBy::Head),
    ] {
        show.show(1.0, &seen);
        let state = show.monitor.state();
        assert_eq!((state.zone, state.zone_by), (ZoneState::In(zone), Some(by)));
    }
}

#[test]
fn the_gaze_on_the_road_is_learnt_and_kept() {
    let mut show = Show::new(&MonitorConfig::default(), 10);
    // The head is turned less than the eyes, from a camera at the side.
    let road = || {
        let mut seen = looking(-24.0, 6.0, 5.0);
        seen.yaw_deg = -18.0;
        seen
    };
    let mirror = || {
        let mut seen = looking(8.0, 6.0, 5.0);
        seen.yaw_deg = -18.0;
        seen
    };
    for _ in 0..20 {
        show.show(3.0, &road());
        show.show(1.0, &mirror());
    }
    let state = show.monitor.state();
    let [yaw, pitch] = state.natural_gaze_deg;
    assert!(state.natural_gaze_is_final, "{state:?}");
    assert!(
        (yaw + 24.0).abs() < 1.5 && (pitch - 6.0).abs() < 1.5,
        "{state:?}"
    );
    assert_eq!(state.zone, ZoneState::In(3));
    let record = show.monitor.save();
    show.monitor.forget_driver();
    assert_eq!(show.monitor.state().natural_gaze_deg, [0.0; 2]);
    show.monitor.restore(&record).expect("a record");
    show.show(1.0, &road());
    let state = show.monitor.state();
    assert_eq!(
        (state.zone, state.zone_by),
        (ZoneState::In(0), Some(ZonesBy::Gaze))
    );
    assert!(!state.natural_gaze_is_final);
}

/// The areas of Regulation (EU) 2023/2590, by gazes that a camera beside the wheel sees: a gaze
/// that stays 30° and more below straight ahead is reported after 3.5 s and 6 s, no other one.
#[test]
fn gazes_below_30_degrees_are_timed_as_the_addw_has_it() {
    for (preset, seconds) in [(Preset::EuAddwFast, 3.5), (Preset::EuAddwSlow, 6.0)] {
        let mut config = preset.config();
        config.forward_yaw_deg = 22.0;
        (config.natural_yaw_deg, config.gaze_gain) = (0.0, 1.0);
        for yaw in [-40.0f32, -15.0, 0.0, 15.0, 40.0] {
            for pitch in [20.0f32, 0.0, -20.0, -26.0, -38.0, -50.0] {
                let monitor = Monitor::with_zones(&config, preset.zones()).expect("good zones");
                let mut show = Show {
                    monitor,
                    now_us: 1,
                    step_us: 40_000,
                };
                let gaze = |yaw: f32, pitch: f32| {
                    let mut seen = looking(22.0 + yaw, pitch, 4.0);
                    (seen.yaw_deg, seen.pitch_deg) = (22.0 + yaw / 3.0, pitch / 3.0);
                    seen
                };
                show.show(3.0, &gaze(0.0, 0.0));
                let start_us = show.now_us;
                let events = show.show(8.0, &gaze(yaw, pitch));
                let long = |event: &&MonitorEvent| event.kind == MonitorEventKind::LongGlance;
                let after_s = (events.iter().find(long))
                    .map(|event| (event.timestamp_us - start_us) as f64 / 1e6);
                let at = format!("{preset:?} {yaw} {pitch}: {after_s:?}");
                match pitch < -30.0 {
                    true => assert!((after_s.expect(&at) - seconds).abs() < 0.2, "{at}"),
                    false => assert!(after_s.is_none(), "{at}"),
                }
            }
        }
    }
}

#[test]
fn a_gaze_that_is_lost_ends_a_look_down() {
    let mut show = Show::new(&fixed(), 25);
    show.show(1.0, &looking_down(0.8, 30.0));
    let events = show.show(1.0, &face(Some(0.8), 0.0));
    let end = events.first().expect("an event");
    assert_eq!(end.kind, MonitorEventKind::LookDownEnd);
    assert!(end.is_cut);
    // A direction that is none.
    let mut seen = looking_down(0.8, 30.0);
    for gaze in [[f32::NAN; 3], [0.0, 3.0, -1.0], [f32::INFINITY, 0.0, 0.0]] {
        seen.gaze = Some(gaze);
        assert_eq!(show.show(1.0, &seen), []);
        assert_eq!(show.monitor.state().look_down_us, 0);
    }
}

#[test]
fn a_camera_at_the_side_is_learnt() {
    for yaw in [-40.0, 0.0, 30.0] {
        let mut show = Show::new(&MonitorConfig::default(), 10);
        show.show(9.0, &face(Some(0.9), yaw));
        assert_eq!(
            show.monitor.state().zone,
            ZoneState::Unknown,
            "not known yet"
        );
        let events = show.show(60.0, &face(Some(0.9), yaw));
        let state = show.monitor.state();
        assert_eq!(state.zone, ZoneState::In(0), "{yaw}");
        assert!((state.natural_deg[0] - yaw).abs() <= 1.0, "{state:?}");
        let learnt = |kind| events.iter().any(|event| event.kind == kind);
        assert!(learnt(MonitorEventKind::NaturalLearnt), "{events:?}");
        assert!(learnt(MonitorEventKind::OpenEyeLearnt), "{events:?}");
        show.monitor.forget_driver();
        assert!(!show.monitor.state().natural_is_final);
    }
}

#[test]
fn drowsiness_rises_and_falls_once() {
    use MonitorEventKind::*;
    let mut show = Show::new(&fixed(), 10);
    show.show(200.0, &face(Some(0.9), 0.0));
    let mut events = Vec::new();
    // A fifth of the time closed.
    for _ in 0..60 {
        events.extend(show.show(0.8, &face(Some(0.05), 0.0)));
        events.extend(show.show(3.2, &face(Some(0.9), 0.0)));
    }
    for _ in 0..20 {
        events.extend(show.show(10.0, &face(Some(0.9), 0.0)));
    }
    let of = |kind| events.iter().filter(|event| event.kind == kind).count();
    assert_eq!((of(Drowsy), of(DrowsyEnd)), (1, 1));
    // Nobody in the seat is not drowsy, and is reported.
    let events = show.show(200.0, &Observation::default());
    let state = show.monitor.state();
    assert_eq!(state.drowsiness, posewise::monitor::Drowsiness::Unknown);
    assert!(state.degraded && state.perclos_180.known < 0.01);
    assert_eq!(
        events.iter().filter(|event| event.kind == Degraded).count(),
        1
    );
    let events = show.show(1.0, &face(Some(0.9), 0.0));
    assert_eq!(kinds(&events), [Restored]);
}

#[test]
fn a_clock_that_is_set_back_ends_what_goes_on() {
    use MonitorEventKind::*;
    let mut show = Show::new(&fixed(), 30);
    show.show(70.0, &face(Some(0.9), 0.0));
    show.show(0.7, &face(Some(0.1), 0.0));
    let before = show.monitor.state().perclos_60;
    show.now_us -= 50_000_000;
    let events = show.show(0.03, &face(Some(0.1), 0.0));
    assert_eq!(kinds(&events), [ClosureEnd, ClockBack]);
    assert!(events[0].is_cut);
    assert_eq!(
        show.monitor.state().perclos_60.p80,
        before.p80,
        "measures stay"
    );
    assert!(
        show.monitor
            .update(&face(None, 0.0), show.now_us - show.step_us)
            .is_err()
    );
}

/// What goes on over a clock that is set back lasts as long as it did, and begins in the new time.
#[test]
fn durations_outlast_a_clock_that_is_set_back() {
    use MonitorEventKind::*;
    let mut show = Show::new(&fixed(), 10);
    show.show(200.0, &face(Some(0.9), 0.0));
    let mut events = Vec::new();
    for _ in 0..60 {
        events.extend(show.show(0.8, &face(Some(0.05), 0.0)));
        events.extend(show.show(3.2, &face(Some(0.9), 0.0)));
    }
    let drowsy = *events.iter().find(|e| e.kind == Drowsy).expect("drowsy");
    let before_us = show.now_us - drowsy.timestamp_us;
    let back_us = show.now_us - 3_000_000_000;
    show.now_us = back_us;
    let mut events = Vec::new();
    for _ in 0..20 {
        events.extend(show.show(10.0, &face(Some(0.9), 0.0)));
    }
    let end = *events.iter().find(|e| e.kind == DrowsyEnd).expect("awake");
    assert_eq!(end.start_us, back_us);
    // The time of the jump itself is unknown.
    let lasted_us = before_us - show.step_us + (end.timestamp_us - back_us);
    assert_eq!(i64::from(end.duration_us), lasted_us);

    // Eyes that are unknown before the jump and after it.
    show.show(7.0, &face(None, 0.0));
    let back_us = show.now_us - 3_000_000_000;
    show.now_us = back_us;
    let events = show.show(7.0, &face(None, 0.0));
    let degraded = *events.iter().find(|e| e.kind == Degraded).expect("unknown");
    assert_eq!(degraded.start_us, back_us);
    assert_eq!(degraded.duration_us, fixed().degraded_us);
}

/// Another driver comes with a clock of his own.
#[test]
fn the_clock_is_forgotten_with_the_driver() {
    let mut show = Show::new(&fixed(), 10);
    show.show(5.0, &face(Some(0.9), 0.0));
    for now_us in [show.now_us - show.step_us, -40_000_000] {
        show.monitor.forget_driver();
        assert_eq!(show.monitor.state().timestamp_us, 0);
        let updated = show.monitor.update(&face(Some(0.9), 0.0), now_us);
        assert_eq!(updated, Ok(()));
        assert_eq!(kinds(&drain(&mut show.monitor)), []);
    }
}

/// The limits that the header states, and what is just beyond them.
#[test]
fn planes_have_limits() {
    let mut monitor = Monitor::new(&fixed()).expect("good settings");
    let mut is_plane = |centre_mm: [f32; 3], half_u_mm: [f32; 3], half_v_mm: [f32; 3]| {
        let shape = ZoneShape::Plane {
            centre_mm,
            half_u_mm,
            half_v_mm,
        };
        monitor.set_zones(&[Zone::new(shape)]).is_ok()
    };
    let origin = [0.0; 3];
    assert!(is_plane(origin, [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]));
    assert!(!is_plane(origin, [10.0, 0.0, 0.0], [0.0, 9.99, 0.0]));
    // A sine of 0.1 is 5.74 degrees.
    let at = |deg: f32| {
        [
            500.0 * deg.to_radians().cos(),
            500.0 * deg.to_radians().sin(),
            0.0,
        ]
    };
    for (deg, is_one) in [(5.7, false), (5.8, true), (174.2, true), (174.3, false)] {
        assert_eq!(
            is_plane(origin, [500.0, 0.0, 0.0], at(deg)),
            is_one,
            "{deg}"
        );
    }
    let far = [0.0, 0.0, 20_000.0];
    assert!(is_plane(far, [20_000.0, 0.0, 0.0], [0.0, 20_000.0, 0.0]));
    for far in [20_001.0, -20_001.0, f32::NAN] {
        let beyond = [0.0, 0.0, far];
        assert!(!is_plane(beyond, [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]));
        assert!(!is_plane(origin, [10.0, 0.0, far], [0.0, 10.0, 0.0]));
    }
}

#[test]
fn presets_differ_as_their_rules_do() {
    let config = |preset: Preset| preset.config();
    assert_eq!(config(Preset::EuAddwFast).long_glance_us, 3_500_000);
    assert_eq!(config(Preset::EuAddwSlow).long_glance_us, 6_000_000);
    assert_eq!(config(Preset::EuroNcap).long_glance_us, 3_000_000);
    assert_eq!(config(Preset::EuDdaw).drowsy_p80_60, 0.12);
    // Area 3 of the ADDW begins 30° down, and the rest of the car is not timed.
    let zones = Preset::EuAddwFast.zones();
    let mut monitor = Monitor::with_zones(&fixed(), zones).expect("good zones");
    let mut at = |yaw: f32, pitch: f32, now_us: i64| {
        let mut seen = face(Some(0.9), yaw);
        seen.pitch_deg = pitch;
        monitor.update(&seen, now_us).expect("time goes on");
        monitor.state().zone
    };
    assert_eq!(at(0.0, -20.0, 1), ZoneState::In(0));
    assert_eq!(at(0.0, -34.0, 2), ZoneState::In(1));
    assert_eq!(at(70.0, 0.0, 3), ZoneState::In(2));
}

#[test]
fn memory_is_bounded() {
    assert!(size_of::<Monitor>() <= 8 * 1024, "{}", size_of::<Monitor>());
    println!("{} bytes", size_of::<Monitor>());
}

/// A tenth of what it may take: 5 % of a tracking step, which takes 1.6 ms.
const UPDATE_NS: u128 = 8_000;

#[test]
fn an_update_is_cheap() {
    let mut show = Show::new(&MonitorConfig::default(), 30);
    let start = std::time::Instant::now();
    for _ in 0..60 {
        show.show(9.0, &face(Some(0.9), 3.0));
        show.show(0.7, &face(Some(0.1), 25.0));
    }
    let updates = 60 * (9 * 30 + 21);
    let each_ns = start.elapsed().as_nanos() / updates;
    println!("{each_ns} ns an update");
    assert!(each_ns < UPDATE_NS, "{each_ns} ns an update");
}

#[test]
fn settings_out_of_range_are_rejected() {
    let wrong: [fn(&mut MonitorConfig); 8] = [
        |c| c.gap_us = 0,
        |c| c.closed_below = f32::NAN,
        |c| c.open_above = c.closed_below,
        |c| c.sleep_us = c.microsleep_us,
        |c| c.yawn_below = 0.9,
        |c| c.natural_yaw_deg = 51.0,
        |c| c.forward_pitch_deg = f32::INFINITY,
        |c| c.cumulative_us = 30_000_001,
    ];
    for change in wrong {
        let mut config = MonitorConfig::default();
        change(&mut config);
        assert!(Monitor::new(&config).is_err(), "{config:?}");
    }
}
