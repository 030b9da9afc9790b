//! Frames: every field of `posewise_frame`, over memory of the stated length. A frame is rejected
//! if and only if it violates a rule of `posewise.h`; else the result is that of the same image as
//! plain grey.
//!
//! ```text
//! u8 format        0..18: a known one; above: the next four bytes
//! u16 width, u16 height (u8 each unless bit 0 of the shape is set)
//! u8 shape         see below
//! u8 rotation      0..=3: multiples of 90 degrees; above: the value in degrees
//! u8 flags, u8 reserved, u8 up to 240: struct_size is right; above: so much too large
//! the rest: pixels, repeated
//! ```

use super::input::Input;
use super::memory::Exact;
use super::outputs::Tracker;
use super::tiny;
use crate::ffi::types::*;

/// Longest memory of a frame \[bytes\].
const LONGEST: usize = 1 << 20;
/// Largest image that is compared with plain grey \[px\].
const COMPARED: usize = 1 << 14;

/// Format, bytes per pixel, position of the luma.
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
    /// A little-endian word, shifted right by some bits.
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

/// Largest byte that leaves `struct_size` right.
const SIZE_IS_RIGHT: u32 = 240;

const FRAME: usize = size_of::<posewise_frame>();

pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    let case = Case::read(&mut input);
    if case.valid && case.data_len > LONGEST {
        return; // more memory than there is
    }
    let pixels = input.rest();
    let mut memory = Exact::new(case.data_len.clamp(1, LONGEST), 1, 0);
    for (i, byte) in memory.get_mut().iter_mut().enumerate() {
        *byte = pixels.get(i % pixels.len().max(1)).copied().unwrap_or(7);
    }
    let before = memory.get().to_vec();
    case.check(&memory);
    assert!(memory.get() == before, "the frame was written to");
}

/// The fields of a frame, and whether they obey the rules of the header.
struct Case {
    format: u32,
    width: u32,
    height: u32,
    stride: u32,
    data_len: usize,
    rotation_deg: u32,
    flags: u32,
    reserved: u32,
    struct_size: u32,
    no_data: bool,
    valid: bool,
}

impl Case {
    fn read(input: &mut Input<'_>) -> Case {
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
        let row = width as u64 * known.map_or(1, |f| f.1) as u64;
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
        let mut case = Case {
            format,
            width,
            height,
            stride,
            data_len,
            rotation_deg: if quarter < 4 { quarter * 90 } else { quarter },
            flags: input.u8() as u32,
            reserved: input.u8() as u32,
            struct_size: FRAME as u32 + (input.u8() as u32).saturating_sub(SIZE_IS_RIGHT),
            no_data: has(NO_DATA),
            valid: known.is_some() && stride as u64 >= row && data_len >= needed,
        };
        case.valid &= case.obeys_ranges();
        case
    }

    /// Whether each field by itself has a value that the header allows.
    fn obeys_ranges(&self) -> bool {
        !self.no_data
            && (1..=16_384).contains(&self.width)
            && (1..=16_384).contains(&self.height)
            && self.data_len <= isize::MAX as usize
            && self.rotation_deg.is_multiple_of(90)
            && self.rotation_deg < 360
            && self.flags & !POSEWISE_FRAME_MIRRORED == 0
            && self.reserved == 0
            && self.struct_size as usize == FRAME
    }

    fn frame(&self, memory: &Exact) -> posewise_frame {
        posewise_frame {
            struct_size: self.struct_size,
            format: self.format,
            timestamp_us: 1,
            width: self.width,
            height: self.height,
            stride: self.stride,
            rotation_deg: self.rotation_deg,
            flags: self.flags,
            reserved: self.reserved,
            data_len: self.data_len,
            data: match self.no_data {
                true => std::ptr::null(),
                false => memory.ptr(),
            },
        }
    }

    /// The image as plain grey, where the frame is valid and small enough.
    fn upright(&self, memory: &Exact) -> Option<Exact> {
        let format = FORMATS.iter().find(|f| f.0 == self.format);
        let image = Image {
            width: self.width as usize,
            height: self.height as usize,
            stride: self.stride as usize,
            pixel: format.map_or(1, |f| f.1),
            luma: format.map_or(Luma::Byte(0), |f| f.2),
            quarter: self.rotation_deg as usize / 90,
            mirrored: self.flags == POSEWISE_FRAME_MIRRORED,
        };
        let small = self.valid && image.width * image.height <= COMPARED;
        small.then(|| image.upright(memory.get()))
    }

    /// Some steps over the frame, compared with the same steps over the image as plain grey.
    fn check(&self, memory: &Exact) {
        let frame = self.frame(memory);
        let given = Exact::new(FRAME, 8, 0);
        // SAFETY: as long as the struct.
        unsafe { given.ptr().cast::<posewise_frame>().write(frame) };
        let upright = self.upright(memory);
        let (width, height) = match (self.rotation_deg / 90) % 2 {
            1 => (self.height, self.width),
            _ => (self.width, self.height),
        };
        let mut tracker = new_tracker();
        let mut reference = new_tracker();
        for step in 1..=3 {
            // SAFETY: as above.
            unsafe { (*given.ptr().cast::<posewise_frame>()).timestamp_us = step };
            // SAFETY: a frame whose memory is as long as stated, or one that must not be read.
            let outputs = unsafe { tracker.step(given.ptr().cast()) };
            assert_eq!(outputs.is_ok(), self.valid, "{frame:?}");
            // SAFETY: as above.
            let faces = unsafe { tracker.detect(given.ptr().cast()) };
            assert_eq!(faces.is_ok(), self.valid, "{frame:?}");
            let (Ok(outputs), Some(grey)) = (outputs, &upright) else {
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
                data_len: grey.get().len(),
                data: grey.ptr(),
            };
            // SAFETY: a whole frame.
            let expected = unsafe { (reference.step(&grey), reference.detect(&grey)) };
            assert!(expected == (Ok(outputs), faces), "{frame:?}");
        }
    }
}

fn new_tracker() -> Tracker {
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: 24,
        ..Default::default()
    };
    Tracker::new(tiny::model(), Some(&config), 0).expect("a valid model")
}

/// Layout of an image in memory.
struct Image {
    width: usize,
    height: usize,
    stride: usize,
    pixel: usize,
    luma: Luma,
    quarter: usize,
    mirrored: bool,
}

impl Image {
    /// The image as plain grey: mirroring is undone, then it is rotated clockwise.
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
