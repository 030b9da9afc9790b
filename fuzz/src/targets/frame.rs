//! Frames: every field of `posewise_frame`, over memory that ends where it says. A frame is refused
//! exactly when a rule of `posewise.h` is broken; else its result is that of the same picture as
//! plain grey.
//!
//! ```text
//! u8 format        0..18: one of those known; above: the next four bytes
//! u16 width, u16 height (u8 each unless bit 0 of the shape is set)
//! u8 shape         see below
//! u8 rotation      0..=3: that many quarter turns; above: itself, in degrees
//! u8 flags, u8 reserved, u8 size of the struct less its real size
//! the rest: pixels, repeated
//! ```

use super::answer::Tracker;
use super::input::Input;
use super::memory::Exact;
use super::tiny;
use crate::ffi::types::*;

/// The longest memory that a frame is given.
const LONGEST: usize = 1 << 20;
/// The largest picture that is compared with plain grey [px].
const COMPARED: usize = 1 << 14;

/// Format, bytes per pixel, bytes that hold the luma.
const FORMATS: [(u32, usize, Luma); 18] = [
    (POSEWISE_FMT_GREY, 1, Luma::Byte(0)),
    (POSEWISE_FMT_Y10, 2, Luma::Word(2)),
    (POSEWISE_FMT_Y16, 2, Luma::Word(8)),
    (POSEWISE_FMT_YUYV, 2, Luma::Byte(0)),
    (POSEWISE_FMT_UYVY, 2, Luma::Byte(1)),
    (POSEWISE_FMT_NV12, 1, Luma::Byte(0)),
    (POSEWISE_FMT_NV21, 1, Luma::Byte(0)),
    (POSEWISE_FMT_YU12, 1, Luma::Byte(0)),
    (POSEWISE_FMT_RGB3, 3, Luma::Rgb(0, 1, 2)),
    (POSEWISE_FMT_BGR3, 3, Luma::Rgb(2, 1, 0)),
    (POSEWISE_FMT_XB24, 4, Luma::Rgb(0, 1, 2)),
    (POSEWISE_FMT_AB24, 4, Luma::Rgb(0, 1, 2)),
    (POSEWISE_FMT_XR24, 4, Luma::Rgb(2, 1, 0)),
    (POSEWISE_FMT_AR24, 4, Luma::Rgb(2, 1, 0)),
    (POSEWISE_FMT_BX24, 4, Luma::Rgb(1, 2, 3)),
    (POSEWISE_FMT_BA24, 4, Luma::Rgb(1, 2, 3)),
    (POSEWISE_FMT_RX24, 4, Luma::Rgb(3, 2, 1)),
    (POSEWISE_FMT_RA24, 4, Luma::Rgb(3, 2, 1)),
];

#[derive(Clone, Copy)]
enum Luma {
    Byte(usize),
    /// Shifted right by so many bits.
    Word(u32),
    Rgb(usize, usize, usize),
}

impl Luma {
    fn read(self, pixel: &[u8]) -> u8 {
        let at = |i: usize| pixel[i] as u32;
        match self {
            Luma::Byte(i) => pixel[i],
            Luma::Word(shift) => ((at(0) + 256 * at(1)) >> shift).min(255) as u8,
            Luma::Rgb(r, g, b) => ((77 * at(r) + 150 * at(g) + 29 * at(b) + 128) / 256) as u8,
        }
    }
}

// Bits of the shape.
const WIDE: u8 = 1;
const OTHER_STRIDE: u8 = 2;
const PADDED: u8 = 4;
const OTHER_LEN: u8 = 8;
const SHORT: u8 = 16;
const NO_DATA: u8 = 32;
const TAIL: u8 = 64;

const FRAME: usize = size_of::<posewise_frame>();

pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    let index = input.u8() as usize;
    let known = FORMATS.get(index % 24);
    let format = known.map_or_else(|| input.u32(), |f| f.0);
    let shape = input.u8();
    let has = |bit: u8| shape & bit != 0;
    let mut side = || match has(WIDE) {
        true => input.u16() as u32,
        false => input.u8() as u32,
    };
    let (width, height) = (side(), side());
    let known = FORMATS.iter().find(|f| f.0 == format);
    let pixel = known.map_or(1, |f| f.1);
    let row = width as u64 * pixel as u64;
    let stride = match (has(OTHER_STRIDE), has(PADDED)) {
        (true, _) => input.u32(),
        (false, true) => row as u32 + input.u8() as u32,
        (false, false) => row as u32,
    };
    let needed = (stride as u64 * (height as u64).saturating_sub(1) + row) as usize;
    let data_len = match (has(OTHER_LEN), has(SHORT)) {
        (true, _) => input.u64() as usize,
        (false, true) => needed.wrapping_sub(1 + input.u8() as usize),
        (false, false) => needed,
    };
    let quarter = input.u8() as u32;
    let rotation_deg = if quarter < 4 { quarter * 90 } else { quarter };
    let (flags, reserved) = (input.u8() as u32, input.u8() as u32);
    let struct_size = FRAME as u32 + input.u8() as u32;
    let tail = if has(TAIL) { input.u8() } else { 0 };

    let sound = known.is_some()
        && !has(NO_DATA)
        && (1..=16_384).contains(&width)
        && (1..=16_384).contains(&height)
        && stride as u64 >= row
        && data_len >= needed
        && data_len <= isize::MAX as usize
        && rotation_deg.is_multiple_of(90)
        && rotation_deg < 360
        && flags & !POSEWISE_FRAME_MIRRORED == 0
        && reserved == 0
        && (tail == 0 || struct_size as usize == FRAME);
    if sound && data_len > LONGEST {
        return; // more memory than there is
    }
    let pixels = input.rest();
    let mut memory = Exact::new(data_len.clamp(1, LONGEST), 1, 0);
    for (i, byte) in memory.get_mut().iter_mut().enumerate() {
        *byte = pixels.get(i % pixels.len().max(1)).copied().unwrap_or(7);
    }
    let before = memory.get().to_vec();
    let frame = posewise_frame {
        struct_size,
        format,
        timestamp_us: 1,
        width,
        height,
        stride,
        rotation_deg,
        flags,
        reserved,
        data_len,
        data: if has(NO_DATA) {
            std::ptr::null()
        } else {
            memory.ptr()
        },
    };
    // A newer caller's frame has a tail.
    let given = Exact::new(struct_size as usize, 8, tail);
    // SAFETY: at least as long as the struct.
    unsafe { given.ptr().cast::<posewise_frame>().write(frame) };
    let view = Picture {
        width: width as usize,
        height: height as usize,
        stride: stride as usize,
        pixel,
        luma: known.map_or(Luma::Byte(0), |f| f.2),
        quarter: rotation_deg as usize / 90,
        mirrored: flags == POSEWISE_FRAME_MIRRORED,
    };
    let same = (sound && view.width * view.height <= COMPARED).then(|| view.upright(&before));
    let turned = view.quarter % 2 == 1;
    let (width, height) = if turned {
        (height, width)
    } else {
        (width, height)
    };

    let mut tracker = new_tracker();
    let mut plain = new_tracker();
    for step in 1..=3 {
        // SAFETY: as above.
        unsafe { (*given.ptr().cast::<posewise_frame>()).timestamp_us = step };
        // SAFETY: a frame whose memory is as long as it says, or one that must not be read.
        let answer = unsafe { tracker.step(given.ptr().cast()) };
        assert_eq!(answer.is_ok(), sound, "{frame:?}");
        let (Ok(answer), Some(same)) = (answer, &same) else {
            continue;
        };
        let grey = posewise_frame {
            struct_size: FRAME as u32,
            format: POSEWISE_FMT_GREY,
            timestamp_us: step,
            width,
            height,
            stride: width,
            rotation_deg: 0,
            flags: 0,
            reserved: 0,
            data_len: same.get().len(),
            data: same.ptr(),
        };
        // SAFETY: a whole frame.
        let expected = unsafe { plain.step(&grey) };
        assert!(expected == Ok(answer), "{frame:?}");
    }
    assert!(memory.get() == before, "the frame was written to");
}

fn new_tracker() -> Tracker {
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: 24,
        ..Default::default()
    };
    Tracker::new(tiny::model(), Some(&config), 0).expect("a good model")
}

/// How a picture lies in memory.
struct Picture {
    width: usize,
    height: usize,
    stride: usize,
    pixel: usize,
    luma: Luma,
    quarter: usize,
    mirrored: bool,
}

impl Picture {
    /// The picture as plain grey: mirroring is undone, then it is turned clockwise.
    fn upright(&self, data: &[u8]) -> Exact {
        let (w, h) = (self.width, self.height);
        let unmirrored = |x: usize, y: usize| {
            let x = if self.mirrored { w - 1 - x } else { x };
            let at = y * self.stride + x * self.pixel;
            self.luma.read(&data[at..at + self.pixel])
        };
        let (width, height) = if self.quarter % 2 == 1 {
            (h, w)
        } else {
            (w, h)
        };
        let mut upright = Exact::new(w * h, 1, 0);
        for (i, luma) in upright.get_mut().iter_mut().enumerate() {
            let (x, y) = (i % width, i / width);
            *luma = match self.quarter {
                0 => unmirrored(x, y),
                1 => unmirrored(y, width - 1 - x),
                2 => unmirrored(width - 1 - x, height - 1 - y),
                _ => unmirrored(height - 1 - y, x),
            };
        }
        upright
    }
}
