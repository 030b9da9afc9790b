//! Calls of `posewise_step()` and `posewise_step_at()`.

use super::arguments::{FRAME, RESULT, hint, is_good, lay_out, spoilt, stated};
use super::{Live, World};
use crate::ffi::{api::*, types::*};
use crate::targets::input::{Input, scramble};
use crate::targets::memory::{Exact, Guarded};
use crate::targets::outputs::Outputs;

impl World {
    pub(super) fn step(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        self.step_with(input, slot, pointer, None);
    }

    /// A step with a hint, which may be wrong.
    pub(super) fn step_at(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let how = input.u8();
        let (hint, valid) = hint(input);
        let hint = Hint {
            pointer: spoilt(hint.ptr(), how).cast(),
            valid: valid && is_good(how),
            _memory: hint,
        };
        self.step_with(input, slot, pointer, Some(hint));
    }

    fn step_with(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8, hint: Option<Hint>) {
        let (tracker, live) = self.tracker(slot, pointer);
        let last_us = self.slots[slot].live.as_ref().and_then(|live| live.last_us);
        let wrong = input.u8();
        let timestamp_us = timestamp(input, last_us.unwrap_or(0));
        let image = Image::new(input);
        let arguments = Arguments::new(input, wrong, image.frame(timestamp_us));
        let in_order = last_us.is_none_or(|last| timestamp_us > last);
        let roi = self.roi(slot);
        let good = live
            && in_order
            && arguments.are_good()
            && image.holds(roi)
            && hint.as_ref().is_none_or(|hint| hint.valid);
        let given = lay_out(arguments.frame, arguments.frame_size);
        let out = arguments.result();
        let untouched = out.get().to_vec();
        let before = self.snapshot(slot);
        let frame = spoilt(given.ptr(), arguments.frame_how).cast();
        let result = spoilt(out.ptr(), arguments.result_how).cast();
        // SAFETY: everything is as long as stated.
        let status = unsafe {
            match &hint {
                Some(hint) => posewise_step_at(tracker, frame, hint.pointer, result),
                None => posewise_step(tracker, frame, result),
            }
        };
        out.check();
        image.check();
        if status == POSEWISE_OK {
            let outputs = Outputs::of(tracker, out.get());
            assert_eq!(outputs.timestamp_us(), timestamp_us);
            self.log.extend(outputs.bytes());
            self.slots[slot].live = Some(Live {
                last_us: Some(timestamp_us),
                outputs: Some(outputs),
                roi,
            });
        } else {
            assert!(out.get() == untouched, "a step that failed has written");
        }
        self.check_status(slot, status, good, &before);
    }

    /// Region of interest of a tracker.
    pub(super) fn roi(&self, slot: usize) -> [u32; 4] {
        let live = self.slots[slot].live.as_ref();
        live.map_or([0; 4], |live| live.roi)
    }
}

/// The hint of a step.
struct Hint {
    pointer: *const posewise_hint,
    valid: bool,
    /// What the pointer points to, or should.
    _memory: Exact,
}

/// A timestamp, mostly after the last one \[us\].
fn timestamp(input: &mut Input<'_>, last: i64) -> i64 {
    match input.u8() {
        0..200 => last.saturating_add(33_333),
        200..210 => last.saturating_add(input.u32() as i64),
        210..220 => last,
        220..230 => last.saturating_sub(input.u16() as i64),
        230..240 => i64::MAX - input.u8() as i64,
        240..250 => i64::MIN + input.u8() as i64,
        _ => input.u64() as i64,
    }
}

/// Arguments of a step, of which at most one is wrong.
pub(super) struct Arguments {
    pub(super) frame: posewise_frame,
    pub(super) frame_size: u32,
    result_size: u32,
    pub(super) frame_how: u8,
    result_how: u8,
    /// Whether the fields of the frame are valid.
    valid_frame: bool,
}

impl Arguments {
    pub(super) fn new(input: &mut Input<'_>, wrong: u8, frame: posewise_frame) -> Arguments {
        let mut a = Arguments {
            frame,
            frame_size: FRAME,
            result_size: RESULT,
            frame_how: 0,
            result_how: 0,
            valid_frame: true,
        };
        match wrong {
            0..200 => {}
            200..206 => (a.result_size, a.frame_size) = (FRAME, RESULT),
            206..210 => a.frame_size = stated(input, FRAME),
            210..214 => a.result_size = stated(input, RESULT),
            214..218 => a.frame_how = 6 + wrong % 2,
            218..222 => a.result_how = 6 + wrong % 2,
            222..225 => a.frame_size = FRAME + 8,
            _ => {
                a.valid_frame = false;
                match wrong % 8 {
                    0 => a.frame.width = 0,
                    1 => a.frame.height = u32::MAX,
                    2 => a.frame.stride = a.frame.width - 1,
                    3 => a.frame.data_len -= 1,
                    4 => a.frame.rotation_deg = 45,
                    5 => a.frame.flags = 2,
                    6 => a.frame.reserved = 1,
                    _ => a.frame.format = input.u32() | 0x80,
                }
            }
        }
        a.frame.struct_size = a.frame_size;
        a
    }

    /// Memory for a result of the stated size, or of its size alone where that is wrong.
    fn result(&self) -> Guarded {
        let len = match self.result_size == RESULT {
            true => RESULT,
            false => 4,
        };
        let mut out = Guarded::new(len as usize, 0x77);
        out.get_mut()[..4].copy_from_slice(&self.result_size.to_ne_bytes());
        out
    }

    pub(super) fn frame_is_good(&self) -> bool {
        self.valid_frame && is_good(self.frame_how) && self.frame_size == FRAME
    }

    fn are_good(&self) -> bool {
        self.frame_is_good() && is_good(self.result_how) && self.result_size == RESULT
    }
}

/// A small grey image.
pub(super) struct Image {
    width: u32,
    height: u32,
    data: Exact,
    before: Vec<u8>,
}

impl Image {
    pub(super) fn new(input: &mut Input<'_>) -> Self {
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
        Image {
            width,
            height,
            before: data.get().to_vec(),
            data,
        }
    }

    pub(super) fn frame(&self, timestamp_us: i64) -> posewise_frame {
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

    /// Whether a region of interest lies in it.
    pub(super) fn holds(&self, [x, y, width, height]: [u32; 4]) -> bool {
        x as u64 + width as u64 <= self.width as u64
            && y as u64 + height as u64 <= self.height as u64
    }

    pub(super) fn check(&self) {
        assert!(self.data.get() == self.before, "the frame was written to");
    }
}
