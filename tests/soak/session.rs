//! A session: some trackers, some scenes, a step of each tracker on each frame.

use super::checks::{check_change, check_events, check_place, check_watched, expected_status};
use crate::common::random::Random;
use crate::ffi::{api::*, types::*};
use crate::tally::Tally;
use crate::targets::memory::Exact;
use crate::targets::outputs::{Outputs, Tracker};
use crate::targets::watch::Watcher;
use crate::video::{Library, Picture, Scene};
use std::ptr::null;
use std::time::Instant;

/// Video of a session \[µs\].
const SESSION_US: i64 = 60_000_000;

/// A tracker, and what is expected of it.
pub(super) struct Slot {
    pub(super) tracker: Tracker,
    pub(super) state: u32,
    pub(super) last_us: Option<i64>,
    /// When the face was fitted last \[µs\].
    pub(super) fitted_us: i64,
    /// Landmarks of the last step.
    pub(super) landmarks: Vec<u8>,
    pub(super) face_box: [f32; 4],
    /// Region of interest: x, y, width, height; all 0 for the whole frame.
    pub(super) roi: [u32; 4],
    pub(super) has_camera: bool,
    /// A monitor of whom the tracker tracks.
    pub(super) watcher: Watcher,
}

pub struct Session<'a> {
    pub(super) random: Random,
    pub(super) model: &'a Exact,
    /// Whether it was trained: a face is then where the picture is.
    is_trained: bool,
    pub(super) fill: u8,
    pub(super) slots: Vec<Slot>,
    /// Another tracker, which is overwritten with copies.
    spare: Tracker,
    now_us: i64,
    pub(super) tally: &'a mut Tally,
    hash: u64,
}

impl<'a> Session<'a> {
    /// Runs the session that follows from a seed; returns the hash of all outputs.
    pub fn run(
        seed: u64,
        (model, is_trained): (&'a Exact, bool),
        library: &Library,
        fill: u8,
        tally: &'a mut Tally,
    ) -> u64 {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let count = [1, 1, 1, 2, 2, 3][random.below(6)];
        let slots = (0..count).map(|_| new_slot(&mut random, model, fill));
        let slots = slots.collect();
        let mut session = Session {
            random,
            model,
            is_trained,
            fill,
            slots,
            spare: Tracker::new(model, None, fill).expect("defaults"),
            now_us: 0,
            tally,
            hash: 0xCBF2_9CE4_8422_2325,
        };
        session.tally.sessions += 1;
        let until = session.tally.video_us + SESSION_US;
        while session.tally.video_us < until {
            session.scene(library);
        }
        session.hash
    }

    fn scene(&mut self, library: &Library) {
        let scene = Scene::new(&mut self.random, library);
        for slot in &mut self.slots {
            // Else the region stays, in which the new frames may not lie.
            if self.random.below(4) > 0 {
                slot.roi = [0; 4];
                // SAFETY: NULL is a valid region.
                let status = unsafe { posewise_set_roi(slot.tracker.ptr(), null()) };
                assert_eq!(status, POSEWISE_OK);
            }
        }
        for number in 0..scene.frames {
            let mut picture = scene.frame(number, library);
            self.advance_clock(scene.interval_us);
            picture.frame.timestamp_us = self.now_us;
            for index in 0..self.slots.len() {
                self.call_something(index, &picture);
                self.step(index, &picture);
            }
            assert!(picture.is_whole(), "the frame was written to");
            self.tally.video_us += scene.interval_us;
        }
    }

    /// Mostly the next frame's time; sometimes the clock jumps.
    fn advance_clock(&mut self, interval_us: i64) {
        let jitter = self.random.below(2000) as i64 - 1000;
        let jump = match self.random.below(2000) {
            0 => i64::MAX - 10_000_000 - self.now_us.max(0),
            1..6 => 10f32.powf(5.0 + 9.0 * self.random.unit()) as i64,
            _ => 0,
        };
        self.now_us = self.now_us.saturating_add(interval_us + jitter);
        self.now_us = self.now_us.saturating_add(jump);
        if self.now_us > i64::MAX - 5_000_000 {
            // The end of time: all clocks begin anew.
            self.now_us = [i64::MIN, -1_000_000, 0][self.random.below(3)];
            (0..self.slots.len()).for_each(|index| self.reset(index));
        }
    }

    /// A step, or several, whose outputs are checked.
    fn step(&mut self, index: usize, picture: &Picture) {
        let hint = self.hint(index);
        let slot = &mut self.slots[index];
        let expected = expected_status(slot, picture);
        let before = (expected != POSEWISE_OK).then(|| slot.tracker.memory().get().to_vec());
        let copied = self.random.once_in(200) && expected == POSEWISE_OK;
        if copied {
            let bytes = slot.tracker.memory().get();
            self.spare.memory().get_mut().copy_from_slice(bytes);
        }
        let hint = hint.as_ref().map_or(null(), std::ptr::from_ref);
        let start = Instant::now();
        // SAFETY: a whole frame, and NULL or a whole hint.
        let outputs = unsafe { slot.tracker.step_at(&picture.frame, hint) };
        self.tally.longest = self.tally.longest.max(start.elapsed());
        let name = match hint.is_null() {
            true => "posewise_step",
            false => "posewise_step_at",
        };
        match (outputs, before) {
            (Ok(outputs), None) => {
                if copied {
                    // SAFETY: as above.
                    let again = unsafe { self.spare.step_at(&picture.frame, hint) };
                    assert!(again.as_ref() == Ok(&outputs), "the copy differs");
                    self.tally.count("copies stepped");
                }
                self.tally.count(name);
                self.accepted(index, picture, &outputs);
            }
            (Err(status), Some(before)) => {
                assert_eq!(status, expected);
                assert!(slot.tracker.memory().get() == before, "changed by {status}");
                self.tally.count("steps refused");
            }
            (outputs, _) => panic!("{:?} in place of {expected}", outputs.map(drop)),
        }
    }

    /// A hint, now and then: where a face is, or anywhere.
    fn hint(&mut self, index: usize) -> Option<posewise_hint> {
        let known = self.slots[index].face_box;
        let random = &mut self.random;
        random.once_in(100).then(|| {
            let side = 16.0 + 200.0 * random.unit();
            let anywhere = [random.unit() * 300.0, random.unit() * 200.0, side, side];
            posewise_hint {
                struct_size: size_of::<posewise_hint>() as u32,
                face_box: match known[2] >= 16.0 && random.once_in(2) {
                    true => known,
                    false => anywhere,
                },
                yaw_deg: random.unit() * 180.0 - 90.0,
                roll_deg: random.unit() * 360.0 - 180.0,
            }
        })
    }

    /// What must hold after a step.
    fn accepted(&mut self, index: usize, picture: &Picture, outputs: &Outputs) {
        self.mix(outputs.bytes());
        let events = self.events(index);
        let slot = &mut self.slots[index];
        let r = outputs.result();
        assert_eq!(r.timestamp_us, picture.frame.timestamp_us);
        check_change(slot, &r, outputs);
        check_events(slot.state, &r, &events);
        if r.state == POSEWISE_TRACKING {
            if self.is_trained {
                check_place(&r, picture);
            }
            slot.fitted_us = r.timestamp_us;
        }
        let seen = check_watched(slot, &r);
        self.tally.changes[slot.state as usize][r.state as usize] += 1;
        slot.state = r.state;
        slot.last_us = Some(r.timestamp_us);
        slot.landmarks = outputs.landmarks().to_vec();
        slot.face_box = r.face_box;
        self.tally.count("posewise_monitor_update");
        self.mix(format!("{seen:?}").as_bytes());
    }

    /// Takes all events out of the log.
    pub(super) fn events(&mut self, index: usize) -> Vec<posewise_event> {
        let mut events = vec![posewise_event::default(); POSEWISE_EVENTS as usize];
        let (mut count, mut lost) = (0, 0);
        let tracker = self.slots[index].tracker.ptr();
        // SAFETY: as long as the capacity says.
        let status = unsafe {
            let (out, capacity) = (events.as_mut_ptr(), events.len());
            posewise_events(tracker, out, capacity, &mut count, &mut lost)
        };
        assert_eq!((status, lost), (POSEWISE_OK, 0));
        self.tally.count("posewise_events");
        events.truncate(count);
        events.iter().for_each(|event| self.tally.event(event));
        events
    }

    pub(super) fn mix(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.hash = (self.hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }
}

/// A tracker with random settings that are valid.
pub(super) fn new_slot(random: &mut Random, model: &Exact, fill: u8) -> Slot {
    let camera = random.camera(4.0);
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy];
    let given = posewise_intrinsics { fx, fy, cx, cy };
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: [0, 24, 24 + random.below(200) as u32][random.below(3)],
        scan_budget: [0, 100, 1000 + random.below(30_000) as u32][random.below(3)],
        smoothing_hz: [0.0, 0.01 + random.unit()][random.below(2)],
        smoothing_beta: [0.0, 100.0 * random.unit()][random.below(2)],
        gaze: random.below(3) as u32,
        ..Default::default()
    };
    let with_camera = posewise_config {
        intrinsics: given,
        ..config
    };
    // A camera out of range is refused.
    let first = match random.once_in(2) {
        true => Tracker::new(model, Some(&with_camera), fill),
        false => Err(POSEWISE_E_INTRINSICS),
    };
    let has_camera = first.is_ok();
    let tracker = first.or_else(|status| {
        assert_eq!(status, POSEWISE_E_INTRINSICS);
        Tracker::new(model, Some(&config), fill)
    });
    Slot {
        tracker: tracker.expect("valid settings"),
        state: POSEWISE_SEARCHING,
        last_us: None,
        fitted_us: 0,
        landmarks: Vec::new(),
        face_box: [0.0; 4],
        roi: [0; 4],
        has_camera,
        watcher: Watcher::new(random.below(5) as u32, fill),
    }
}
