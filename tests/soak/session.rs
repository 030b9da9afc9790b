//! A session: some trackers, some scenes, calls in between, and what must hold on each step.

use crate::common::random::Random;
use crate::ffi::{api::*, types::*};
use crate::tally::Tally;
use crate::targets::memory::Exact;
use crate::targets::outputs::{Outputs, Tracker};
use crate::video::{Library, Picture, Scene};
use posewise::Distortion;
use std::ptr::null;
use std::time::Instant;

/// Video of a session \[µs\].
const SESSION_US: i64 = 60_000_000;
/// How long a face that is lost is repeated at most \[µs\], as in `track/policy.rs`.
const COAST_US: i64 = 500_000;

/// A tracker, and what is expected of it.
struct Slot {
    tracker: Tracker,
    state: u32,
    last_us: Option<i64>,
    /// When the face was fitted last \[µs\].
    fitted_us: i64,
    /// Landmarks of the last step.
    landmarks: Vec<u8>,
    face_box: [f32; 4],
    /// Region of interest: x, y, width, height; all 0 for the whole frame.
    roi: [u32; 4],
    has_camera: bool,
}

pub struct Session<'a> {
    random: Random,
    model: &'a Exact,
    /// Whether it was trained: a face is then where the picture is.
    is_trained: bool,
    fill: u8,
    slots: Vec<Slot>,
    /// Another tracker, which is overwritten with copies.
    spare: Tracker,
    now_us: i64,
    tally: &'a mut Tally,
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
        self.tally.changes[slot.state as usize][r.state as usize] += 1;
        slot.state = r.state;
        slot.last_us = Some(r.timestamp_us);
        slot.landmarks = outputs.landmarks().to_vec();
        slot.face_box = r.face_box;
    }

    /// Takes all events out of the log.
    fn events(&mut self, index: usize) -> Vec<posewise_event> {
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

    fn mix(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.hash = (self.hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    // --- Calls between two frames ----------------------------------------------------------------

    fn call_something(&mut self, index: usize, picture: &Picture) {
        match self.random.below(600) {
            0..4 => self.set_intrinsics(index),
            4..8 => self.set_lens(index),
            8..14 => self.set_roi(index, picture),
            14..20 => self.set_excluded(index),
            20..22 => self.forget(index),
            22..24 => self.reset(index),
            24..34 => self.detect(index, picture),
            34..38 => self.call_wrongly(index, picture),
            38..40 => self.slots[index] = new_slot(&mut self.random, self.model, self.fill),
            _ => return,
        }
        self.events(index);
    }

    /// Counts a call; one that failed must have changed nothing.
    fn done(&mut self, index: usize, call: &'static str, status: i32, before: &[u8]) -> bool {
        let same = self.slots[index].tracker.memory().get() == before;
        assert!(status == POSEWISE_OK || same, "{call} changed the tracker");
        self.slots[index].tracker.memory().check();
        self.mix(&status.to_le_bytes());
        self.tally.count(match status {
            POSEWISE_OK => call,
            _ => "other calls refused",
        });
        status == POSEWISE_OK
    }

    fn snapshot(&mut self, index: usize) -> Vec<u8> {
        self.slots[index].tracker.memory().get().to_vec()
    }

    fn set_intrinsics(&mut self, index: usize) {
        let camera = match self.random.once_in(4) {
            true => posewise_intrinsics::default(),
            false => self.camera(),
        };
        let before = self.snapshot(index);
        // SAFETY: a whole struct.
        let status = unsafe { posewise_set_intrinsics(self.slots[index].tracker.ptr(), &camera) };
        if self.done(index, "posewise_set_intrinsics", status, &before) {
            self.slots[index].has_camera = camera.fx != 0.0;
        }
    }

    fn camera(&mut self) -> posewise_intrinsics {
        let camera = self.random.camera(4.0);
        let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy];
        posewise_intrinsics { fx, fy, cx, cy }
    }

    fn set_lens(&mut self, index: usize) {
        let lens = match self.random.lens() {
            Distortion::BrownConrady { k1, k2, p1, p2, k3 } => posewise_lens {
                model: POSEWISE_LENS_BROWN,
                coefficients: [k1, k2, p1, p2, k3],
            },
            Distortion::KannalaBrandt { k1, k2, k3, k4 } => posewise_lens {
                model: POSEWISE_LENS_FISHEYE,
                coefficients: [k1, k2, k3, k4, 0.0],
            },
            _ => posewise_lens::default(),
        };
        let before = self.snapshot(index);
        // SAFETY: a whole struct.
        let status = unsafe { posewise_set_lens(self.slots[index].tracker.ptr(), &lens) };
        let set = self.done(index, "posewise_set_lens", status, &before);
        assert!(self.slots[index].has_camera || !set);
    }

    fn set_roi(&mut self, index: usize, picture: &Picture) {
        let [width, height] = picture.upright();
        let mut part = |whole: u32| self.random.below(whole as usize) as u32;
        let (x, y) = (part(width), part(height));
        let roi = [x, y, 1 + part(width - x), 1 + part(height - y)];
        let [x, y, width, height] = roi;
        let given = posewise_roi {
            x,
            y,
            width,
            height,
        };
        let before = self.snapshot(index);
        // SAFETY: a whole struct.
        let status = unsafe { posewise_set_roi(self.slots[index].tracker.ptr(), &given) };
        assert!(self.done(index, "posewise_set_roi", status, &before));
        self.slots[index].roi = roi;
    }

    /// The boxes of other trackers, and of anything.
    fn set_excluded(&mut self, index: usize) {
        let others = self.slots.iter().enumerate().filter(|(k, _)| *k != index);
        let mut boxes: Vec<[f32; 4]> = others
            .map(|(_, other)| other.face_box)
            .filter(|face_box| face_box[2] >= 1.0)
            .collect();
        if self.random.once_in(3) {
            boxes.push(self.slots[index].face_box); // may be all zero, which is refused
        }
        let before = self.snapshot(index);
        let (tracker, first) = (self.slots[index].tracker.ptr(), boxes.as_ptr().cast());
        // SAFETY: so many boxes.
        let status = unsafe { posewise_set_excluded(tracker, first, boxes.len()) };
        self.done(index, "posewise_set_excluded", status, &before);
    }

    fn forget(&mut self, index: usize) {
        let before = self.snapshot(index);
        // SAFETY: a live tracker.
        let status = unsafe { posewise_forget_identity(self.slots[index].tracker.ptr()) };
        assert!(self.done(index, "posewise_forget_identity", status, &before));
    }

    fn reset(&mut self, index: usize) {
        let before = self.snapshot(index);
        // SAFETY: a live tracker.
        let status = unsafe { posewise_reset(self.slots[index].tracker.ptr()) };
        assert!(self.done(index, "posewise_reset", status, &before));
        let slot = &mut self.slots[index];
        slot.state = POSEWISE_SEARCHING;
        slot.last_us = None;
        slot.face_box = [0.0; 4];
        self.events(index);
    }

    fn detect(&mut self, index: usize, picture: &Picture) {
        let before = self.snapshot(index);
        let slot = &mut self.slots[index];
        let fits = is_in(slot.roi, picture.upright());
        // SAFETY: a whole frame.
        let outputs = unsafe { slot.tracker.detect(&picture.frame) };
        let status = outputs.as_ref().err().copied().unwrap_or(POSEWISE_OK);
        let expected = if fits { POSEWISE_OK } else { POSEWISE_E_ROI };
        assert_eq!(status, expected);
        if self.done(index, "posewise_detect", status, &before) {
            let outputs = outputs.expect("as just seen");
            outputs.iter().for_each(|bytes| self.mix(bytes));
            let count = usize::from_ne_bytes(*outputs[1].first_chunk().expect("a length"));
            self.tally.faces += count as u64;
        }
    }

    /// A call that must fail.
    fn call_wrongly(&mut self, index: usize, picture: &Picture) {
        let before = self.snapshot(index);
        let mut frame = picture.frame;
        let expected = match self.random.below(6) {
            0 => {
                frame.width = 0;
                POSEWISE_E_FRAME
            }
            1 => {
                frame.data_len -= 1;
                POSEWISE_E_FRAME
            }
            2 => {
                frame.format ^= 1 << 31;
                POSEWISE_E_FORMAT
            }
            3 => {
                frame.struct_size += 8;
                POSEWISE_E_STRUCT_SIZE
            }
            4 => {
                frame.data = null();
                POSEWISE_E_NULL
            }
            _ => {
                frame.flags = 2;
                POSEWISE_E_FLAGS
            }
        };
        let slot = &mut self.slots[index];
        // SAFETY: the frame is whole, or must not be read.
        let statuses = unsafe {
            let stepped = slot.tracker.step(&frame).map(drop);
            [stepped, slot.tracker.detect(&frame).map(drop)]
        };
        assert_eq!(statuses, [Err(expected); 2]);
        self.done(index, "", expected, &before);
    }
}

/// A tracker with random settings that are valid.
fn new_slot(random: &mut Random, model: &Exact, fill: u8) -> Slot {
    let camera = random.camera(4.0);
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy];
    let given = posewise_intrinsics { fx, fy, cx, cy };
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: [0, 24, 24 + random.below(200) as u32][random.below(3)],
        scan_budget: [0, 100, 1000 + random.below(30_000) as u32][random.below(3)],
        smoothing_hz: [0.0, 0.01 + random.unit()][random.below(2)],
        smoothing_beta: [0.0, 100.0 * random.unit()][random.below(2)],
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
    }
}

/// Whether a region of interest lies in a picture.
fn is_in([x, y, width, height]: [u32; 4], [all_x, all_y]: [u32; 2]) -> bool {
    x + width <= all_x && y + height <= all_y
}

fn expected_status(slot: &Slot, picture: &Picture) -> posewise_status {
    let in_order = (slot.last_us).is_none_or(|last| picture.frame.timestamp_us > last);
    match (is_in(slot.roi, picture.upright()), in_order) {
        (false, _) => POSEWISE_E_ROI,
        (true, false) => POSEWISE_E_TIME,
        (true, true) => POSEWISE_OK,
    }
}

/// The change of state is an allowed one. A face that coasts repeats the last fit.
fn check_change(slot: &Slot, r: &posewise_result, outputs: &Outputs) {
    let from = slot.state;
    match r.state {
        POSEWISE_COASTING => {
            assert!(from != POSEWISE_SEARCHING, "coasting without a face: {r:?}");
            assert_eq!(r.age_us, r.timestamp_us.saturating_sub(slot.fitted_us));
            assert!((1..=COAST_US).contains(&r.age_us), "{r:?}");
            assert!(outputs.landmarks() == slot.landmarks, "no repetition");
            assert!(r.loss != POSEWISE_LOSS_NONE, "{r:?}");
        }
        POSEWISE_SEARCHING => {
            let is_lost = from != POSEWISE_SEARCHING;
            assert!(!is_lost || r.loss != POSEWISE_LOSS_NONE, "{r:?}");
        }
        _ => assert_eq!(r.loss, POSEWISE_LOSS_NONE),
    }
}

/// Each change of state is an event, and nothing else is.
fn check_events(from: u32, r: &posewise_result, events: &[posewise_event]) {
    let has = |kind| events.iter().any(|event| event.kind == kind);
    assert!(
        events
            .iter()
            .all(|event| event.timestamp_us == r.timestamp_us)
    );
    let coasts = (from, r.state) == (POSEWISE_TRACKING, POSEWISE_COASTING);
    assert_eq!(has(POSEWISE_EVENT_COASTING), coasts, "{events:?}");
    let is_lost = from != POSEWISE_SEARCHING && r.state == POSEWISE_SEARCHING;
    assert_eq!(has(POSEWISE_EVENT_LOST), is_lost, "{events:?}");
    let found = [POSEWISE_EVENT_ACQUIRED, POSEWISE_EVENT_REACQUIRED].map(has);
    match (from, r.state) {
        (POSEWISE_TRACKING, POSEWISE_TRACKING) => {}
        (_, POSEWISE_TRACKING) => assert!(found[0] ^ found[1], "{events:?}"),
        _ => assert_eq!(found, [false; 2], "{events:?}"),
    }
}

/// A tracked face is centred in or near the frame, and not much larger.
fn check_place(r: &posewise_result, picture: &Picture) {
    let [x, y, width, height] = r.face_box;
    let size = width.max(height);
    let [all_x, all_y] = picture.upright().map(|side| side as f32);
    let near = |at: f32, end: f32| (-0.5 * size..=end + 0.5 * size).contains(&at);
    assert!(width > 0.0 && height > 0.0, "{r:?}");
    assert!(
        near(x + width / 2.0, all_x) && near(y + height / 2.0, all_y),
        "{r:?}"
    );
    assert!(size <= 8.0 * all_x.max(all_y), "{r:?}");
}
