//! Calls of `posewise_monitor_*()`, on a monitor beside each tracker.

use super::World;
use super::arguments::{is_good, lay_out, number, spoilt, stated};
use crate::ffi::{monitor::*, monitor_types::*, types::*};
use crate::targets::input::Input;
use crate::targets::memory::{Exact, Guarded};
use crate::targets::watch::{check_event, check_state, events_of, size};
use std::mem::size_of;
use std::ptr::null;

const CONFIG: u32 = size_of::<posewise_monitor_config>() as u32;
const OBSERVATION: u32 = size_of::<posewise_monitor_observation>() as u32;
const STATE: u32 = size_of::<posewise_monitor_state>() as u32;

/// A monitor, and what is expected of it.
pub(super) struct Watched {
    pub(super) memory: Guarded,
    /// The time of the last observation, if the monitor is live.
    live: Option<Option<i64>>,
}

impl Watched {
    pub(super) fn new(fill: u8) -> Watched {
        Watched {
            memory: Guarded::new(size(), fill),
            live: None,
        }
    }
}

impl World {
    pub(super) fn monitor(&mut self, which: u8, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let before = self.monitors[slot].memory.get().to_vec();
        let (status, good) = match which % 9 {
            0 => self.monitor_init(input, slot, pointer),
            1 => self.monitor_observe(input, slot, pointer),
            2 => self.monitor_state(input, slot, pointer),
            3 => self.monitor_events(input, slot, pointer),
            4 => self.monitor_zones(input, slot, pointer),
            5 => self.monitor_forget(slot, pointer),
            6 => monitor_config_default(input, pointer),
            7 => self.monitor_init_valid(slot),
            _ => self.monitor_update(input, slot, pointer),
        };
        assert_eq!(status == POSEWISE_OK, good, "status {status}");
        assert!((-28..=0).contains(&status) && status != POSEWISE_E_ARG);
        // The bytes include padding, whose reading Miri rejects.
        let same = good || cfg!(miri) || self.monitors[slot].memory.get() == before;
        assert!(same, "a call that failed has changed the monitor");
        self.log.extend(status.to_le_bytes());
    }

    pub(super) fn watched(&self, slot: usize, pointer: u8) -> (*mut posewise_monitor, bool) {
        let watched = &self.monitors[slot];
        let good = is_good(pointer) && watched.live.is_some();
        (spoilt(watched.memory.ptr(), pointer).cast(), good)
    }

    fn monitor_init_valid(&mut self, slot: usize) -> (posewise_status, bool) {
        let memory = &self.monitors[slot].memory;
        let mut out = std::ptr::null_mut();
        // SAFETY: as long as stated; NULL selects all defaults.
        let status =
            unsafe { posewise_monitor_init(&mut out, memory.ptr().cast(), memory.len(), null()) };
        self.monitors[slot].live = Some(None);
        (status, true)
    }

    fn monitor_init(
        &mut self,
        input: &mut Input<'_>,
        slot: usize,
        pointer: u8,
    ) -> (posewise_status, bool) {
        let config = config(input);
        let short = usize::from(input.u8() == 255) + usize::from(pointer == 7);
        let memory = &self.monitors[slot].memory;
        let mut out = std::ptr::null_mut();
        // SAFETY: as long as stated.
        let (needed, status) = unsafe {
            let config = config.ptr().cast();
            let (start, len) = (spoilt(memory.ptr(), pointer), memory.len() - short);
            (
                posewise_monitor_memory_size(config),
                posewise_monitor_init(&mut out, start.cast(), len, config),
            )
        };
        let good = needed > 0 && short == 0 && is_good(pointer);
        assert!(needed == 0 || needed == size());
        assert_eq!(out.is_null(), !good);
        if good {
            self.monitors[slot].live = Some(None);
        }
        (status, good)
    }

    /// Observes the tracker of the same slot.
    fn monitor_observe(
        &mut self,
        input: &mut Input<'_>,
        slot: usize,
        pointer: u8,
    ) -> (posewise_status, bool) {
        let (tracker, live) = self.tracker(slot, pointer);
        let size = stated(input, OBSERVATION);
        let out = lay_out(posewise_monitor_observation::default(), size);
        let good = live && size == OBSERVATION;
        // SAFETY: as long as stated.
        let status = unsafe { posewise_monitor_observe(tracker, out.ptr().cast()) };
        if status == POSEWISE_OK && good {
            self.log.extend(out.get());
            // SAFETY: as long as the struct, as just checked.
            let seen = unsafe { out.ptr().cast::<posewise_monitor_observation>().read() };
            let text = format!("{seen:?}");
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            let now_us = input.u32().into();
            return self.observe(slot, &out, now_us, 0, true);
        }
        (status, good)
    }

    fn monitor_update(
        &mut self,
        input: &mut Input<'_>,
        slot: usize,
        pointer: u8,
    ) -> (posewise_status, bool) {
        let struct_size = stated(input, OBSERVATION);
        let mut next = || match input.u8() {
            any @ 0..16 => {
                let _ = any;
                number(input)
            }
            other => f32::from(other) / 255.0,
        };
        let seen = posewise_monitor_observation {
            struct_size,
            state: POSEWISE_TRACKING,
            confidence: next(),
            yaw_deg: 100.0 * next() - 50.0,
            pitch_deg: 60.0 * next() - 30.0,
            translation_mm: [next(), next(), 600.0 * next()],
            rotation_sigma_deg: [next(), next(), next()],
            eye_open: [next(), next()],
            jaw_open: next(),
            camera_assumed: u32::from(next() > 0.5),
            gaze: [next(), 2.0 * next() - 1.0, -next()],
            may_look_down: u32::from(next() > 0.5),
            gaze_sigma_deg: 30.0 * next(),
        };
        let now_us = match input.u8() {
            255 => input.u64() as i64,
            254 => i64::MAX,
            253 => i64::MIN,
            _ => {
                let last = self.monitors[slot].live.flatten().unwrap_or(0);
                last.saturating_add(i64::from(input.u16()) * 64)
            }
        };
        let out = lay_out(seen, struct_size);
        self.observe(slot, &out, now_us, pointer, struct_size == OBSERVATION)
    }

    fn observe(
        &mut self,
        slot: usize,
        seen: &Exact,
        now_us: i64,
        pointer: u8,
        sound: bool,
    ) -> (posewise_status, bool) {
        let (monitor, live) = self.watched(slot, pointer);
        let last = self.monitors[slot].live.flatten();
        let good = live && sound && last != Some(now_us);
        // SAFETY: as long as stated.
        let status = unsafe { posewise_monitor_update(monitor, seen.ptr().cast(), now_us) };
        if good {
            self.monitors[slot].live = Some(Some(now_us));
        }
        (status, good)
    }

    fn monitor_state(
        &mut self,
        input: &mut Input<'_>,
        slot: usize,
        pointer: u8,
    ) -> (posewise_status, bool) {
        let (monitor, live) = self.watched(slot, pointer);
        let size = stated(input, STATE);
        let out = lay_out(posewise_monitor_state::default(), size);
        let good = live && size == STATE;
        // SAFETY: as long as stated.
        let status = unsafe { posewise_monitor_read(monitor, out.ptr().cast()) };
        if good {
            // SAFETY: as long as the struct.
            check_state(unsafe { &*out.ptr().cast::<posewise_monitor_state>() });
        }
        self.log.extend(out.get());
        (status, good)
    }

    fn monitor_events(
        &mut self,
        input: &mut Input<'_>,
        slot: usize,
        pointer: u8,
    ) -> (posewise_status, bool) {
        let (monitor, live) = self.watched(slot, pointer);
        let (wrong, capacity) = (input.u8(), input.u8() as usize % 32);
        let good = live && is_good(wrong);
        let event = size_of::<posewise_monitor_event>();
        let out = Guarded::new(capacity * event, 0x33);
        let (mut count, mut overwritten) = (usize::MAX, usize::MAX);
        // SAFETY: as long as the capacity says.
        let status = unsafe {
            let events = spoilt(out.ptr(), wrong).cast();
            posewise_monitor_events(monitor, events, capacity, &mut count, &mut overwritten)
        };
        out.check();
        let most = capacity.min(POSEWISE_MONITOR_EVENTS as usize);
        assert_eq!(good, count <= most);
        let (events, rest) = out.get().split_at(if good { count * event } else { 0 });
        assert!(rest.iter().all(|b| *b == 0x33));
        events_of(events).iter().for_each(check_event);
        self.log.extend(events);
        (status, good)
    }

    /// The monitor itself checks the numbers of zones; what it refuses must change nothing.
    fn monitor_zones(
        &mut self,
        input: &mut Input<'_>,
        slot: usize,
        pointer: u8,
    ) -> (posewise_status, bool) {
        let (monitor, live) = self.watched(slot, pointer);
        let count = input.u8() as usize % 10;
        let zone = |input: &mut Input<'_>| posewise_monitor_zone {
            kind: u32::from(input.u8() % 4),
            flags: u32::from(input.u8() / 127),
            grace_us: u32::from(input.u16()) * 64,
            numbers: [0; 9].map(|_| number(input) - 400.0),
        };
        let zones: Vec<posewise_monitor_zone> = (0..count).map(|_| zone(input)).collect();
        // SAFETY: `count` zones.
        let status = unsafe { posewise_monitor_set_zones(monitor, zones.as_ptr(), count) };
        assert!(status != POSEWISE_OK || live && count <= POSEWISE_MONITOR_ZONES as usize);
        assert!(status == POSEWISE_OK || !live || count > 0);
        (status, status == POSEWISE_OK)
    }

    fn monitor_forget(&mut self, slot: usize, pointer: u8) -> (posewise_status, bool) {
        let (monitor, good) = self.watched(slot, pointer);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_monitor_forget_driver(monitor) };
        if good {
            self.monitors[slot].live = Some(None);
        }
        (status, good)
    }
}

/// The settings of any preset, which must be valid, and the names of events.
fn monitor_config_default(input: &mut Input<'_>, pointer: u8) -> (posewise_status, bool) {
    let (preset, kind) = (u32::from(input.u8() % 8), input.u32());
    let size = stated(input, CONFIG);
    let out = lay_out(posewise_monitor_config::default(), size);
    let good = is_good(pointer) && size == CONFIG && preset <= POSEWISE_MONITOR_PRESET_EU_DDAW;
    // SAFETY: as long as stated.
    unsafe {
        let to = spoilt(out.ptr(), pointer);
        let status = posewise_monitor_config_default(preset, to.cast());
        assert!(!good || posewise_monitor_memory_size(to.cast()) == self::size());
        let is_known = kind <= POSEWISE_MONITOR_EVENT_CLOCK_BACK;
        assert_eq!(posewise_monitor_event_name(kind).is_null(), !is_known);
        (status, good)
    }
}

/// Settings in memory, some of them wild.
fn config(input: &mut Input<'_>) -> Exact {
    let struct_size = stated(input, CONFIG);
    let mut config = posewise_monitor_config {
        struct_size,
        preset: u32::from(input.u8() % 6),
        flags: u32::from(input.u8() / 100),
        ..Default::default()
    };
    let value = number(input);
    match input.u8() % 12 {
        0 => config.gap_us = input.u32(),
        1 => config.closed_below = value,
        2 => config.open_above = value,
        3 => config.long_closure_us = input.u32(),
        4 => config.eye_yaw_deg = value,
        5 => config.forward_yaw_deg = value,
        6 => config.natural_pitch_deg = value,
        7 => config.drowsy_p80_60 = value,
        8 => config.cumulative_us = input.u32(),
        _ => {}
    }
    lay_out(config, struct_size)
}
