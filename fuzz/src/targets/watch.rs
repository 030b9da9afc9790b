//! A driver monitor in guarded memory, and its outputs, checked.

use super::memory::Guarded;
use crate::ffi::{monitor::*, monitor_types::*, types::*};
use std::ffi::CStr;
use std::mem::size_of;
use std::ptr::null;

const STATE: usize = size_of::<posewise_monitor_state>();
const EVENT: usize = size_of::<posewise_monitor_event>();
const EVENTS: usize = POSEWISE_MONITOR_EVENTS as usize;

/// Memory that a monitor needs.
pub fn size() -> usize {
    // SAFETY: NULL is a valid argument.
    unsafe { posewise_monitor_memory_size(null()) }
}

/// A monitor in memory of its own.
pub struct Watcher {
    memory: Guarded,
}

impl Watcher {
    /// With the settings of a preset, in memory that was filled with `fill`.
    pub fn new(preset: u32, fill: u8) -> Watcher {
        let memory = Guarded::new(size(), fill);
        let config = posewise_monitor_config {
            struct_size: size_of::<posewise_monitor_config>() as u32,
            preset,
            ..Default::default()
        };
        let mut monitor = std::ptr::null_mut();
        // SAFETY: as long as stated, and a whole struct.
        let status = unsafe {
            let start = memory.ptr().cast();
            posewise_monitor_init(&mut monitor, start, memory.len(), &config)
        };
        assert_eq!(status, POSEWISE_OK);
        assert_eq!(monitor.cast::<u8>(), memory.ptr());
        Watcher { memory }
    }

    fn ptr(&self) -> *mut posewise_monitor {
        self.memory.ptr().cast()
    }

    /// Shows it the last step of a tracker.
    pub fn watch(&mut self, tracker: *const posewise_tracker, now_us: i64) -> posewise_status {
        let mut seen = posewise_monitor_observation {
            struct_size: size_of::<posewise_monitor_observation>() as u32,
            ..Default::default()
        };
        // SAFETY: a live tracker, a live monitor and whole structs.
        let status = unsafe {
            assert_eq!(posewise_monitor_observe(tracker, &mut seen), POSEWISE_OK);
            posewise_monitor_update(self.ptr(), &seen, now_us)
        };
        self.memory.check();
        status
    }

    /// What it knows.
    pub fn state(&self) -> posewise_monitor_state {
        let mut state = posewise_monitor_state {
            struct_size: STATE as u32,
            ..Default::default()
        };
        // SAFETY: a live monitor and a whole struct.
        let status = unsafe { posewise_monitor_read(self.ptr(), &mut state) };
        assert_eq!(status, POSEWISE_OK);
        check_state(&state);
        state
    }

    /// Takes all of its events.
    pub fn events(&mut self) -> Vec<posewise_monitor_event> {
        let mut events = vec![posewise_monitor_event::default(); EVENTS];
        let (mut count, mut lost) = (0, 0);
        // SAFETY: as long as the capacity says.
        let status = unsafe {
            let out = events.as_mut_ptr();
            posewise_monitor_events(self.ptr(), out, EVENTS, &mut count, &mut lost)
        };
        assert_eq!((status, lost), (POSEWISE_OK, 0));
        events.truncate(count);
        events.iter().for_each(check_event);
        events
    }

    /// Another person drives.
    pub fn forget(&mut self) {
        // SAFETY: a live monitor.
        let status = unsafe { posewise_monitor_forget_driver(self.ptr()) };
        assert_eq!(status, POSEWISE_OK);
    }
}

/// Checks what the header states of every state.
pub fn check_state(state: &posewise_monitor_state) {
    let text = format!("{state:?}");
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    let unit = |v: f32| (0.0..=1.0).contains(&v);
    let is_known = state.eyes != POSEWISE_MONITOR_EYES_UNKNOWN;
    assert!(state.eyes <= POSEWISE_MONITOR_EYES_CLOSED, "{text}");
    assert!(
        state.eyes_reason <= POSEWISE_MONITOR_REASON_ELSEWHERE,
        "{text}"
    );
    assert_eq!(
        is_known,
        state.eyes_reason == POSEWISE_MONITOR_REASON_NONE,
        "{text}"
    );
    assert_eq!(is_known, unit(state.openness), "{text}");
    assert!(is_known || state.openness == -1.0, "{text}");
    assert!(
        state.drowsiness <= POSEWISE_MONITOR_DROWSINESS_DROWSY,
        "{text}"
    );
    assert!(state.degraded <= 1, "{text}");
    assert!(state.open_eye.iter().all(|open| unit(*open)), "{text}");
    assert!(state.away_30_us <= 30_000_000, "{text}");
    let zone = state.zone;
    assert!(
        zone < POSEWISE_MONITOR_ZONES
            || matches!(
                zone,
                POSEWISE_MONITOR_ZONE_OUTSIDE | POSEWISE_MONITOR_ZONE_UNKNOWN
            ),
        "{text}"
    );
    for window in [&state.perclos_60, &state.perclos_180] {
        let shares = [window.p70, window.p80, window.em, window.known];
        // Sums of f32 may be off by their last digit.
        assert!(
            shares.iter().all(|v| (0.0..=1.000_01).contains(v)),
            "{text}"
        );
        assert!(window.p80 <= window.p70, "{text}");
    }
}

/// Checks what the header states of every event.
pub fn check_event(event: &posewise_monitor_event) {
    // SAFETY: a static string or NULL.
    let has_name = unsafe {
        let name = posewise_monitor_event_name(event.kind);
        !name.is_null() && !CStr::from_ptr(name).is_empty()
    };
    assert!(has_name && event.value.is_finite(), "{event:?}");
    assert!(event.flags <= POSEWISE_MONITOR_CUT && event.reserved == 0);
}

/// An event in memory.
pub fn events_of(bytes: &[u8]) -> Vec<posewise_monitor_event> {
    let events = bytes.chunks_exact(EVENT);
    // SAFETY: as long as the struct, in which every bit pattern is valid.
    let read = |bytes: &[u8]| unsafe {
        bytes
            .as_ptr()
            .cast::<posewise_monitor_event>()
            .read_unaligned()
    };
    events.map(read).collect()
}
