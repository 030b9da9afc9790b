//! Sequences of calls with valid and invalid arguments on three trackers that share a model, and on
//! a driver monitor beside each. A shadow state of each gives the expected status of every call; a
//! call that fails must change nothing. The sequence runs twice, on memory filled with different
//! bytes, and must give the same.
//!
//! ```text
//! u8 fill of the memory, then calls: u8 function, u8 tracker and wrong pointers, arguments
//! ```

mod arguments;
mod detect;
mod group;
mod monitor;
mod records;
mod settings;
mod step;

use super::input::Input;
use super::memory::{Exact, Guarded};
use super::outputs::Outputs;
use super::tiny;
use crate::ffi::{api::*, group::posewise_group_memory_size, names::*, types::*};
use arguments::{CONFIG, config, is_good, spoilt, stated};
use monitor::Watched;
use std::ffi::{CStr, c_char};
use std::ptr::null;

const SLOTS: usize = 3;
const MOST_CALLS: usize = 48;
const FIRST_OF_MONITOR: u8 = 220;

pub fn run(data: &[u8]) {
    let fill = Input::new(data).u8();
    let first = play(data, fill);
    let second = play(data, !fill);
    assert!(first == second, "old content of the memory shows");
    assert!(tiny::is_whole(), "the model was written to");
}

/// All statuses and outputs of one run.
fn play(data: &[u8], fill: u8) -> Vec<u8> {
    let mut input = Input::new(data);
    input.u8();
    let mut world = World {
        slots: std::array::from_fn(|_| Slot {
            memory: Guarded::new(size(), fill),
            live: None,
        }),
        monitors: std::array::from_fn(|_| Watched::new(fill)),
        group: Guarded::new(posewise_group_memory_size(), fill),
        has_group: false,
        log: Vec::new(),
    };
    for _ in 0..MOST_CALLS {
        if input.is_empty() {
            break;
        }
        world.call(&mut input, fill);
        world.slots.iter().for_each(|slot| slot.memory.check());
        world.monitors.iter().for_each(|of| of.memory.check());
        world.group.check();
    }
    world.log
}

fn size() -> usize {
    // SAFETY: NULL is a valid argument.
    unsafe { posewise_memory_size(null()) }
}

struct Slot {
    memory: Guarded,
    live: Option<Live>,
}

/// Expected state of a tracker.
#[derive(Clone, Default)]
struct Live {
    last_us: Option<i64>,
    outputs: Option<Outputs>,
    /// Region of interest: x, y, width, height; all 0 for the whole frame.
    roi: [u32; 4],
}

struct World {
    slots: [Slot; SLOTS],
    /// One beside each tracker.
    monitors: [Watched; SLOTS],
    /// One for all trackers, and whether it was made.
    group: Guarded,
    has_group: bool,
    log: Vec<u8>,
}

impl World {
    fn call(&mut self, input: &mut Input<'_>, fill: u8) {
        // The last bytes are functions of the monitor.
        let function = match input.u8() {
            monitor @ FIRST_OF_MONITOR.. => monitor,
            other => other % 22,
        };
        let head = input.u8();
        let slot = (head >> 3) as usize % SLOTS;
        let pointer = head & 7;
        self.log.push(function);
        match function {
            0 => constants(input),
            1 => self.config_default(input, pointer),
            2 => self.memory_size(input, pointer),
            3 => self.model_check(input, pointer),
            4 => self.init(input, slot, pointer),
            5 => self.init_valid(slot),
            6 => self.outputs(input, slot, pointer),
            7 => self.reset(slot, pointer),
            8 => self.forget(slot, pointer),
            9 => self.set_intrinsics(input, slot, pointer),
            10 => self.copy(input, slot),
            12 => self.set_roi(input, slot, pointer),
            14 => self.set_excluded(input, slot, pointer),
            11 => {
                self.slots[slot].memory.get_mut().fill(fill);
                self.slots[slot].live = None;
            }
            13 => self.events(input, slot, pointer),
            15 => self.set_lens(input, slot, pointer),
            16 => self.detect(input, slot, pointer),
            17 => self.step_at(input, slot, pointer),
            20 => self.init_group(input, pointer),
            21 => self.step_group(input, pointer),
            19 => self.records(input, slot, pointer),
            FIRST_OF_MONITOR.. => self.monitor(function, input, slot, pointer),
            _ => self.step(input, slot, pointer),
        }
    }

    /// Checks the status of a call on one tracker: a call that failed must have changed nothing.
    fn check_status(&mut self, slot: usize, status: posewise_status, good: bool, before: &[u8]) {
        assert_eq!(status == POSEWISE_OK, good, "status {status}");
        assert!((-38..=0).contains(&status) && status != POSEWISE_E_ARG);
        let same = good || self.is_as(slot, before);
        assert!(same, "a call that failed has changed the tracker");
        self.log.extend(status.to_le_bytes());
    }

    fn tracker(&self, slot: usize, pointer: u8) -> (*mut posewise_tracker, bool) {
        let good = is_good(pointer) && self.slots[slot].live.is_some();
        let start = self.slots[slot].memory.ptr();
        (spoilt(start, pointer).cast(), good)
    }

    fn snapshot(&self, slot: usize) -> Vec<u8> {
        self.slots[slot].memory.get().to_vec()
    }

    /// Whether the tracker's bytes are those of a snapshot. They include padding, whose reading
    /// Miri rejects.
    fn is_as(&self, slot: usize, before: &[u8]) -> bool {
        cfg!(miri) || self.slots[slot].memory.get() == before
    }

    fn config_default(&mut self, input: &mut Input<'_>, pointer: u8) {
        let size = stated(input, CONFIG);
        let good = is_good(pointer) && size == CONFIG;
        let len = if size == CONFIG { size } else { 4 };
        let mut out = Guarded::new(len as usize, 0xEE);
        out.get_mut()[..4].copy_from_slice(&size.to_ne_bytes());
        let before = out.get().to_vec();
        // SAFETY: as long as stated.
        let status = unsafe { posewise_config_default(spoilt(out.ptr(), pointer).cast()) };
        out.check();
        assert_eq!(status == POSEWISE_OK, good);
        if good {
            // SAFETY: as above.
            assert_eq!(
                unsafe { posewise_memory_size(out.ptr().cast()) },
                self::size()
            );
        } else {
            assert!(out.get() == before);
        }
    }

    fn memory_size(&mut self, input: &mut Input<'_>, pointer: u8) {
        let (config, sound) = config(input);
        // NULL is a valid argument.
        let good = pointer == 6 || is_good(pointer) && sound;
        // SAFETY: as long as stated.
        let size = unsafe { posewise_memory_size(spoilt(config.ptr(), pointer).cast()) };
        assert_eq!(size, if good { self::size() } else { 0 });
    }

    fn model_check(&mut self, input: &mut Input<'_>, pointer: u8) {
        let whole = tiny::model();
        let len = whole.get().len();
        let cut = match input.u8() {
            0..128 => 0,
            128..160 => 1,
            160..192 => len,
            _ => input.u16() as usize % len,
        };
        let model = Exact::of(&whole.get()[..(len - cut).max(1)], 64);
        let good = is_good(pointer) && cut == 0;
        // For a pointer that is off by one, the last byte is missing.
        let claimed = (len - cut).saturating_sub((pointer == 7) as usize);
        // SAFETY: as long as stated.
        let status = unsafe { posewise_model_check(spoilt(model.ptr(), pointer).cast(), claimed) };
        assert_eq!(status == POSEWISE_OK, good);
        let mut default_len = 1;
        // SAFETY: NULL, or a place for the length.
        unsafe {
            assert!(posewise_default_model(std::ptr::null_mut()).is_null());
            assert!(!posewise_default_model(&mut default_len).is_null());
        }
        assert_eq!(default_len, posewise::DEFAULT_MODEL.len());
        self.log.extend(status.to_le_bytes());
    }

    fn init_valid(&mut self, slot: usize) {
        let model = tiny::model();
        let memory = &self.slots[slot].memory;
        let mut out = std::ptr::null_mut();
        // SAFETY: as long as stated.
        let status = unsafe {
            let (start, len) = (memory.ptr().cast(), memory.len());
            posewise_init(
                &mut out,
                start,
                len,
                model.ptr().cast(),
                model.get().len(),
                null(),
            )
        };
        assert_eq!((status, out.cast::<u8>()), (POSEWISE_OK, memory.ptr()));
        self.slots[slot].live = Some(Live::default());
    }

    fn init(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let model = tiny::model();
        let (wrong, which) = (input.u8(), input.u8());
        let (config, sound) = config(input);
        // At most one argument is wrong.
        let how = |argument: u8| if which % 8 == argument { wrong } else { 0 };
        let before = self.snapshot(slot);
        let memory = &self.slots[slot].memory;
        let mut out = Exact::new(size_of::<*mut posewise_tracker>(), 8, 0x11);
        let untouched = out.get().to_vec();
        let start = spoilt(memory.ptr(), pointer);
        let short = how(1) & 1;
        let len = memory.len() - short as usize - (pointer == 7) as usize;
        let (model_ptr, model_len) = match how(2) & 15 {
            8 => (memory.ptr(), memory.len()), // the tracker's own memory
            9 => (memory.ptr().wrapping_add(64), 64),
            10 => (model.ptr(), model.get().len() - 64),
            _ => {
                let off = (how(2) & 7 == 7) as usize;
                (spoilt(model.ptr(), how(2)), model.get().len() - off)
            }
        };
        let model_good = model_ptr == model.ptr() && model_len == model.get().len();
        let config_ptr = spoilt(config.ptr(), how(3));
        let config_good = config_ptr.is_null() || is_good(how(3)) && sound;
        let good = is_good(pointer) && short == 0 && model_good && config_good && is_good(how(4));
        // SAFETY: as long as stated.
        let status = unsafe {
            posewise_init(
                spoilt(out.ptr(), how(4)).cast(),
                start.cast(),
                len,
                model_ptr.cast(),
                model_len,
                config_ptr.cast(),
            )
        };
        if good {
            let given = (memory.ptr() as usize).to_ne_bytes();
            assert!(out.get_mut() == given);
            self.slots[slot].live = Some(Live::default());
        } else {
            assert!(out.get() == untouched);
        }
        self.check_status(slot, status, good, &before);
    }

    fn outputs(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, good) = self.tracker(slot, pointer);
        let (wrong, capacity) = (input.u8(), input.u8() as usize % 80);
        let good = good && is_good(wrong);
        let before = self.snapshot(slot);
        let landmark = size_of::<posewise_landmark>();
        let landmarks = Guarded::new(capacity * landmark, 0x33);
        let weights = Guarded::new(capacity * 4, 0x33);
        // SAFETY: as long as the capacity says.
        let statuses = unsafe {
            [
                posewise_landmarks(tracker, spoilt(landmarks.ptr(), wrong).cast(), capacity),
                posewise_animation(tracker, spoilt(weights.ptr(), wrong).cast(), capacity),
            ]
        };
        let smooth_landmarks = Guarded::new(capacity * landmark, 0x33);
        let smooth_weights = Guarded::new(capacity * 4, 0x33);
        // SAFETY: likewise.
        let smoothed = unsafe {
            let (l, w) = (smooth_landmarks.ptr(), smooth_weights.ptr());
            [
                posewise_smoothed_landmarks(tracker, spoilt(l, wrong).cast(), capacity),
                posewise_smoothed_animation(tracker, spoilt(w, wrong).cast(), capacity),
            ]
        };
        smooth_landmarks.check();
        smooth_weights.check();
        assert_eq!(smoothed, statuses);
        landmarks.check();
        weights.check();
        for status in statuses {
            self.check_status(slot, status, good, &before);
        }
        assert!(self.is_as(slot, &before));
        let live = self.slots[slot].live.as_ref().filter(|_| good);
        let outputs = live.and_then(|live| live.outputs.as_ref());
        let untouched = |bytes: &[u8]| bytes.iter().all(|b| *b == 0x33);
        let expected = |out: &[u8], all: Option<&[u8]>, most: usize| {
            let (head, tail) = out.split_at(out.len().min(most));
            match (good, all) {
                (false, _) => untouched(out),
                // Before the first step.
                (true, None) => head.iter().all(|b| *b == 0) && untouched(tail),
                (true, Some(all)) => *head == all[..head.len()] && untouched(tail),
            }
        };
        let most = POSEWISE_LANDMARKS as usize * landmark;
        let all = outputs.map(Outputs::landmarks);
        assert!(expected(landmarks.get(), all, most));
        let most = POSEWISE_ANIMATIONS as usize * 4;
        let all = outputs.map(Outputs::animation);
        assert!(expected(weights.get(), all, most));
    }

    fn reset(&mut self, slot: usize, pointer: u8) {
        let (tracker, good) = self.tracker(slot, pointer);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_reset(tracker) };
        if let Some(live) = self.slots[slot].live.as_mut().filter(|_| good) {
            *live = Live {
                roi: live.roi,
                ..Live::default()
            };
        }
        self.check_status(slot, status, good, &before);
    }

    fn forget(&mut self, slot: usize, pointer: u8) {
        let (tracker, good) = self.tracker(slot, pointer);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_forget_identity(tracker) };
        self.check_status(slot, status, good, &before);
    }

    fn events(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, good) = self.tracker(slot, pointer);
        let (wrong, capacity) = (input.u8(), input.u8() as usize % 80);
        let good = good && is_good(wrong);
        let before = self.snapshot(slot);
        let out = Guarded::new(capacity * size_of::<posewise_event>(), 0x33);
        let (mut count, mut overwritten) = (usize::MAX, usize::MAX);
        // SAFETY: as long as the capacity says.
        let status = unsafe {
            let events = spoilt(out.ptr(), wrong).cast();
            posewise_events(tracker, events, capacity, &mut count, &mut overwritten)
        };
        out.check();
        let written = match good {
            true => count * size_of::<posewise_event>(),
            false => 0,
        };
        assert_eq!(good, count <= capacity.min(POSEWISE_EVENTS as usize));
        assert_eq!(good, overwritten <= 1 << 20);
        let (events, rest) = out.get().split_at(written);
        assert!(rest.iter().all(|b| *b == 0x33));
        self.log.extend(events);
        self.check_status(slot, status, good, &before);
    }

    /// A copy of a tracker's memory is a second tracker that gives the same results.
    fn copy(&mut self, input: &mut Input<'_>, from: usize) {
        let to = (from + 1 + input.u8() as usize % (SLOTS - 1)) % SLOTS;
        let bytes = self.snapshot(from);
        self.slots[to].memory.get_mut().copy_from_slice(&bytes);
        self.slots[to].live = self.slots[from].live.clone();
        let at = self.log.len();
        let mut again = Input::new(&[]);
        self.step(&mut again, from, 0);
        let middle = self.log.len();
        self.step(&mut again, to, 0);
        assert!(
            self.log[at..middle] == self.log[middle..],
            "the copy differs"
        );
    }
}

fn constants(input: &mut Input<'_>) {
    assert_eq!(posewise_version(), POSEWISE_VERSION);
    assert_eq!(posewise_abi(), POSEWISE_ABI);
    assert_eq!(posewise_memory_align(), POSEWISE_ALIGN as usize);
    let text = |pointer: *const c_char| {
        assert!(!pointer.is_null());
        // SAFETY: a static string.
        let len = unsafe { CStr::from_ptr(pointer) }.count_bytes();
        assert!((1..100).contains(&len));
    };
    let (status, index) = (input.u32() as i32, input.u32());
    text(posewise_strerror(status));
    text(posewise_strerror(-(status & 63)));
    let known = index < POSEWISE_ANIMATIONS;
    assert_eq!(posewise_animation_name(index).is_null(), !known);
    text(posewise_animation_name(index % POSEWISE_ANIMATIONS));
    let names = [
        (
            posewise_state_name as extern "C" fn(u32) -> _,
            POSEWISE_COASTING,
        ),
        (posewise_loss_name, POSEWISE_LOSS_EXCLUDED),
        (posewise_event_name, POSEWISE_EVENT_FORGOTTEN),
        (posewise_eye_status_name, POSEWISE_EYE_UNCERTAIN),
        (posewise_eye_look_name, POSEWISE_EYE_LOOKS - 1),
    ];
    for (name, last) in names {
        assert_eq!(name(index).is_null(), index > last);
        text(name(index % (last + 1)));
    }
}
