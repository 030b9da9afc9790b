//! Sequences of calls with right and wrong arguments on three trackers that share a model. A shadow
//! of each tracker says what every call must answer; what fails must change nothing. The sequence
//! runs twice, on memory that was filled with other bytes, and must answer the same.
//!
//! ```text
//! u8 fill of the memory, then calls: u8 function, u8 tracker and wrong pointers, arguments
//! ```

use super::answer::Answer;
use super::input::{Input, scramble};
use super::memory::{Exact, Guarded};
use super::tiny;
use crate::ffi::{api::*, types::*};
use std::ffi::{CStr, c_char};
use std::ptr::null;

const SLOTS: usize = 3;
const MOST_CALLS: usize = 48;
/// Longest struct that the library takes.
const LONGEST_STRUCT: u32 = 4096;
/// Of the structs that state their size, the shortest that there ever was.
const FIRST: u32 = 32;
const CONFIG: u32 = size_of::<posewise_config>() as u32;
const FRAME: u32 = size_of::<posewise_frame>() as u32;
const RESULT: u32 = size_of::<posewise_result>() as u32;

pub fn run(data: &[u8]) {
    let fill = Input::new(data).u8();
    let first = play(data, fill);
    let second = play(data, !fill);
    assert!(first == second, "old content of the memory shows");
    assert!(tiny::is_whole(), "the model was written to");
}

/// All statuses and answers of one run.
fn play(data: &[u8], fill: u8) -> Vec<u8> {
    let mut input = Input::new(data);
    input.u8();
    let mut world = World {
        slots: std::array::from_fn(|_| Slot {
            memory: Guarded::new(size(), fill),
            live: None,
        }),
        log: Vec::new(),
    };
    for _ in 0..MOST_CALLS {
        if input.is_empty() {
            break;
        }
        world.call(&mut input, fill);
        world.slots.iter().for_each(|slot| slot.memory.check());
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

/// What a tracker must know.
#[derive(Clone, Default)]
struct Live {
    last_us: Option<i64>,
    answer: Option<Answer>,
}

struct World {
    slots: [Slot; SLOTS],
    log: Vec<u8>,
}

/// A pointer that may be wrong: the memory, NULL, or off by one.
fn spoilt(pointer: *mut u8, how: u8) -> *mut u8 {
    match how & 7 {
        6 => std::ptr::null_mut(),
        7 => pointer.wrapping_add(1),
        _ => pointer,
    }
}

fn is_good(how: u8) -> bool {
    how & 7 < 6
}

/// The size that a struct states: mostly its own.
fn stated(input: &mut Input<'_>, own: u32) -> u32 {
    match input.u8() {
        0..192 => own,
        192..208 => own + 16,
        208..224 => FIRST - 4,
        224..232 => LONGEST_STRUCT,
        232..240 => LONGEST_STRUCT + 1,
        240..248 => 0,
        // Sizes of an older header would be answered in part.
        _ => match input.u32() {
            FIRST.. => own + 4,
            shorter => shorter,
        },
    }
}

fn is_size(size: u32, own: u32) -> bool {
    (own..=LONGEST_STRUCT).contains(&size)
}

/// A struct in memory as long as it says; behind it, bytes of `tail`. Where the size is wrong, only
/// the size itself is there.
fn lay_out<T: Copy>(value: T, size: u32, tail: u8) -> Exact {
    let own = size_of::<T>();
    let mut memory = match is_size(size, own as u32) {
        true => Exact::new(size as usize, 8, tail),
        false => Exact::new(4, 8, 0),
    };
    if memory.get().len() >= own {
        // SAFETY: as long as the struct, as just checked.
        unsafe { memory.ptr().cast::<T>().write(value) };
    }
    memory.get_mut()[..4].copy_from_slice(&size.to_ne_bytes());
    memory
}

fn number(input: &mut Input<'_>) -> f32 {
    match input.u8() {
        0 => 0.0,
        1 => f32::NAN,
        2 => f32::INFINITY,
        3 => f32::MAX,
        4 => f32::MIN_POSITIVE,
        5 => -1.0,
        6 => f32::from_bits(1),
        7 => input.f32(),
        other => other as f32 * 4.0,
    }
}

fn intrinsics(input: &mut Input<'_>) -> (posewise_intrinsics, bool) {
    let mut next = || number(input);
    let [fx, fy, cx, cy] = [next(), next(), next(), next()];
    let all = [fx, fy, cx, cy];
    let default = all.iter().all(|v| *v == 0.0);
    let sound = all.iter().all(|v| v.is_finite()) && fx > 0.0 && fy > 0.0;
    (posewise_intrinsics { fx, fy, cx, cy }, default || sound)
}

/// A config in memory, and whether it is good.
fn config(input: &mut Input<'_>) -> (Exact, bool) {
    let struct_size = stated(input, CONFIG);
    let bits = input.u8();
    let flags = (bits == 255) as u32;
    let (min_face_px, scan_budget) = match bits & 3 {
        0 => (0, 0),
        1 => (24, 100 + input.u16() as u32 % 8000),
        2 => (input.u16() as u32, input.u16() as u32 % 8000),
        _ => (4096, 10_000_001),
    };
    let (intrinsics, camera) = match bits & 4 {
        0 => (posewise_intrinsics::default(), true),
        _ => intrinsics(input),
    };
    let (smoothing_hz, smoothing_beta) = match bits & 0xF0 {
        0x10 => (0.01, 1000.0),
        0x20 => (2.5, 0.0),
        0x30 => (f32::NAN, 1.0),
        0x40 => (1.0, -1.0),
        _ => (0.0, 0.0),
    };
    let tail = (bits & 8) / 8;
    let sound = is_size(struct_size, CONFIG)
        && flags == 0
        && (min_face_px == 0 || (24..=4096).contains(&min_face_px))
        && (scan_budget == 0 || (100..=10_000_000).contains(&scan_budget))
        && camera
        && !matches!(bits & 0xF0, 0x30 | 0x40)
        && (tail == 0 || struct_size == CONFIG);
    let config = posewise_config {
        struct_size,
        flags,
        min_face_px,
        scan_budget,
        intrinsics,
        smoothing_hz,
        smoothing_beta,
    };
    (lay_out(config, struct_size, tail), sound)
}

impl World {
    fn call(&mut self, input: &mut Input<'_>, fill: u8) {
        let function = input.u8() % 20;
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
            5 => self.init_plainly(slot),
            6 => self.outputs(input, slot, pointer),
            7 => self.reset(slot, pointer),
            8 => self.forget(slot, pointer),
            9 => self.set_intrinsics(input, slot, pointer),
            10 => self.copy(input, slot),
            11 => {
                self.slots[slot].memory.get_mut().fill(fill);
                self.slots[slot].live = None;
            }
            _ => self.step(input, slot, pointer),
        }
    }

    /// Checks a status that concerns one tracker: what failed must have changed nothing.
    fn answered(&mut self, slot: usize, status: posewise_status, good: bool, before: &[u8]) {
        assert_eq!(status == POSEWISE_OK, good, "status {status}");
        assert!((-11..=0).contains(&status));
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

    /// Whether the tracker's bytes are those of a snapshot. Padding is among them, which Miri does
    /// not let anybody read.
    fn is_as(&self, slot: usize, before: &[u8]) -> bool {
        cfg!(miri) || self.slots[slot].memory.get() == before
    }

    fn config_default(&mut self, input: &mut Input<'_>, pointer: u8) {
        let size = stated(input, CONFIG);
        let good = is_good(pointer) && is_size(size, CONFIG);
        let len = if is_size(size, CONFIG) { size } else { 4 };
        let mut out = Guarded::new(len as usize, 0xEE);
        out.get_mut()[..4].copy_from_slice(&size.to_ne_bytes());
        let before = out.get().to_vec();
        // SAFETY: as long as it says.
        let status = unsafe { posewise_config_default(spoilt(out.ptr(), pointer).cast()) };
        out.check();
        assert_eq!(status == POSEWISE_OK, good);
        if good {
            assert!(out.get()[CONFIG as usize..].iter().all(|b| *b == 0));
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
        // SAFETY: as long as it says.
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
        // The last byte is not there for a pointer that is off by one.
        let claimed = (len - cut).saturating_sub((pointer == 7) as usize);
        // SAFETY: as long as it says.
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

    fn init_plainly(&mut self, slot: usize) {
        let model = tiny::model();
        let memory = &self.slots[slot].memory;
        let mut out = std::ptr::null_mut();
        // SAFETY: as long as it says.
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
        // Each argument is wrong in its turn, or none is.
        let how = |turn: u8| if which % 8 == turn { wrong } else { 0 };
        let before = self.snapshot(slot);
        let memory = &self.slots[slot].memory;
        let mut out = Exact::new(size_of::<*mut posewise_tracker>(), 8, 0x11);
        let untouched = out.get().to_vec();
        let start = spoilt(memory.ptr(), pointer);
        let short = how(1) & 1;
        let len = memory.len() - short as usize - (pointer == 7) as usize;
        let (model_ptr, model_len) = match how(2) & 15 {
            8 => (memory.ptr(), memory.len()), // upon itself
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
        // SAFETY: as long as they say.
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
        self.answered(slot, status, good, &before);
    }

    fn step(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let last_us = self.slots[slot].live.as_ref().and_then(|live| live.last_us);
        let wrong = input.u8();
        let now = last_us.unwrap_or(0);
        let timestamp_us = match input.u8() {
            0..200 => now.saturating_add(33_333),
            200..210 => now.saturating_add(input.u32() as i64),
            210..220 => now,
            220..230 => now.saturating_sub(input.u16() as i64),
            230..240 => i64::MAX - input.u8() as i64,
            240..250 => i64::MIN + input.u8() as i64,
            _ => input.u64() as i64,
        };
        let picture = Picture::new(input);
        let mut frame = picture.frame(timestamp_us);
        let mut frame_size = FRAME;
        let mut result_size = RESULT;
        let (mut frame_how, mut result_how, mut tail) = (0, 0, 0);
        let mut good = live && last_us.is_none_or(|last| timestamp_us > last);
        match wrong {
            0..200 => {}
            200..206 => (result_size, frame_size) = (RESULT + 16, FRAME + 16),
            206..210 => frame_size = stated(input, FRAME),
            210..214 => result_size = stated(input, RESULT),
            214..218 => (frame_how, tail) = (6 + wrong % 2, 0),
            218..222 => result_how = 6 + wrong % 2,
            222..225 => (frame_size, tail) = (FRAME + 8, 1),
            _ => {
                good = false;
                match wrong % 8 {
                    0 => frame.width = 0,
                    1 => frame.height = u32::MAX,
                    2 => frame.stride = frame.width - 1,
                    3 => frame.data_len -= 1,
                    4 => frame.rotation_deg = 45,
                    5 => frame.flags = 2,
                    6 => frame.reserved = 1,
                    _ => frame.format = input.u32() | 0x80,
                }
            }
        }
        good = good
            && is_good(frame_how)
            && is_good(result_how)
            && is_size(frame_size, FRAME)
            && is_size(result_size, RESULT)
            && (tail == 0 || frame_size == FRAME);
        frame.struct_size = frame_size;
        let given = lay_out(frame, frame_size, tail);
        let len = if is_size(result_size, RESULT) {
            result_size
        } else {
            4
        };
        let mut out = Guarded::new(len as usize, 0x77);
        out.get_mut()[..4].copy_from_slice(&result_size.to_ne_bytes());
        let untouched = out.get().to_vec();
        let before = self.snapshot(slot);
        // SAFETY: everything is as long as it says.
        let status = unsafe {
            let frame = spoilt(given.ptr(), frame_how).cast::<posewise_frame>();
            posewise_step(tracker, frame, spoilt(out.ptr(), result_how).cast())
        };
        out.check();
        picture.check();
        if status == POSEWISE_OK {
            assert!(out.get()[RESULT as usize..].iter().all(|b| *b == 0));
            // A longer struct is answered the same.
            out.get_mut()[..4].copy_from_slice(&RESULT.to_ne_bytes());
            let answer = Answer::of(tracker, out.get());
            assert_eq!(answer.timestamp_us(), timestamp_us);
            self.log.extend(answer.bytes());
            self.slots[slot].live = Some(Live {
                last_us: Some(timestamp_us),
                answer: Some(answer),
            });
        } else {
            assert!(out.get() == untouched, "a step that failed has answered");
        }
        self.answered(slot, status, good, &before);
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
            self.answered(slot, status, good, &before);
        }
        assert!(self.is_as(slot, &before));
        let live = self.slots[slot].live.as_ref().filter(|_| good);
        let answer = live.and_then(|live| live.answer.as_ref());
        let untouched = |bytes: &[u8]| bytes.iter().all(|b| *b == 0x33);
        let told = |out: &[u8], all: Option<&[u8]>, most: usize| {
            let (head, tail) = out.split_at(out.len().min(most));
            match (good, all) {
                (false, _) => untouched(out),
                // Nothing was seen yet.
                (true, None) => head.iter().all(|b| *b == 0) && untouched(tail),
                (true, Some(all)) => *head == all[..head.len()] && untouched(tail),
            }
        };
        let most = POSEWISE_LANDMARKS as usize * landmark;
        assert!(told(landmarks.get(), answer.map(Answer::landmarks), most));
        let most = POSEWISE_ANIMATIONS as usize * 4;
        assert!(told(weights.get(), answer.map(Answer::animation), most));
    }

    fn reset(&mut self, slot: usize, pointer: u8) {
        let (tracker, good) = self.tracker(slot, pointer);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_reset(tracker) };
        if good {
            self.slots[slot].live = Some(Live::default());
        }
        self.answered(slot, status, good, &before);
    }

    fn forget(&mut self, slot: usize, pointer: u8) {
        let (tracker, good) = self.tracker(slot, pointer);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_forget_identity(tracker) };
        self.answered(slot, status, good, &before);
    }

    fn set_intrinsics(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let how = input.u8();
        let (camera, sound) = intrinsics(input);
        let bytes = Exact::new(size_of::<posewise_intrinsics>(), 4, 0);
        // SAFETY: as long as the struct.
        unsafe { bytes.ptr().cast::<posewise_intrinsics>().write(camera) };
        let good = live && (how & 7 == 6 || is_good(how) && sound);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_set_intrinsics(tracker, spoilt(bytes.ptr(), how).cast()) };
        self.answered(slot, status, good, &before);
    }

    /// A copy of a tracker's memory is a second tracker that goes on the same.
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

/// A small grey picture.
struct Picture {
    width: u32,
    height: u32,
    data: Exact,
    before: Vec<u8>,
}

impl Picture {
    fn new(input: &mut Input<'_>) -> Self {
        let (kind, mut seed) = (input.u8(), input.u8() as u32);
        let (width, height) = match kind >> 4 {
            0 => (1 + seed, 1 + 255 - seed),
            1 => (33, 70),
            2 => (1, 1),
            _ => (56, 48),
        };
        let mut data = Exact::new((width * height) as usize, 1, 0);
        for (i, luma) in data.get_mut().iter_mut().enumerate() {
            let (x, y) = (i as u32 % width, i as u32 / width);
            *luma = match kind & 7 {
                0 => (x * 4 + y + seed) as u8,
                1 => scramble(&mut seed),
                2 => ((x * seed / 8) ^ y) as u8,
                3 => seed as u8,
                4 => 255u32.wrapping_sub(x * 4) as u8,
                _ => 100 + ((x * x + y * y) / (1 + seed)) as u8 % 64,
            };
        }
        Picture {
            width,
            height,
            before: data.get().to_vec(),
            data,
        }
    }

    fn frame(&self, timestamp_us: i64) -> posewise_frame {
        posewise_frame {
            struct_size: FRAME,
            format: POSEWISE_FMT_GREY,
            timestamp_us,
            width: self.width,
            height: self.height,
            stride: self.width,
            rotation_deg: 0,
            flags: 0,
            reserved: 0,
            data_len: self.before.len(),
            data: self.data.ptr(),
        }
    }

    fn check(&self) {
        assert!(self.data.get() == self.before, "the frame was written to");
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
    text(posewise_strerror(-(status & 15)));
    let known = index < POSEWISE_ANIMATIONS;
    assert_eq!(posewise_animation_name(index).is_null(), !known);
    text(posewise_animation_name(index % POSEWISE_ANIMATIONS));
}
