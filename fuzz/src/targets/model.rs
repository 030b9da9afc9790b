//! Models: arbitrary bytes, and valid models with changes. Every model that is accepted must be
//! safe to use.
//!
//! ```text
//! u8 mode   bit 0: the other bytes are the model; else they change a valid one
//!           bit 1: the checksum is left unchanged; else it is corrected
//!           bit 2: the length that the model states is left unchanged; else it is corrected
//!           bit 3: the valid model is the default model; else the tiny one
//!           bits 4..: content of the images
//! then changes: u8 bits 0..=1 kind, 2..=4 count, 5.. section (header and table come last);
//!               u16 offset in it; the new content
//! ```

use super::input::{Input, scramble};
use super::memory::Exact;
use super::outputs::Tracker;
use super::tiny;
use crate::ffi::{api::*, types::*};
use posewise_format::{ALIGN, HEADER_LEN};

const RAW: u8 = 1;
const KEEP_CHECKSUM: u8 = 2;
const KEEP_LENGTH: u8 = 4;
const TRAINED: u8 = 8;

/// Numbers at the limits of checks.
const EDGES: [u32; 16] = [
    0,
    1,
    2,
    127,
    128,
    255,
    1 << 15,
    1 << 16,
    (1 << 24) + 1,
    i32::MAX as u32,
    1 << 31,
    u32::MAX,
    0x7F7F_FFFF, // f32::MAX
    0x0000_0001, // the smallest f32 above 0
    0x7F80_0000, // infinity
    0x7FC0_0000, // not a number
];

const WIDTH: usize = 56;
const HEIGHT: usize = 48;

pub fn run(data: &[u8]) {
    tracked(data);
}

/// Number of frames in which a face was tracked; `None` when the model was rejected.
pub fn tracked(data: &[u8]) -> Option<usize> {
    let mut input = Input::new(data);
    let mode = input.u8();
    let mut blob = match mode & (RAW | TRAINED) {
        TRAINED => posewise::DEFAULT_MODEL.to_vec(),
        0 => tiny::model().get().to_vec(),
        _ => Vec::new(),
    };
    if blob.is_empty() {
        blob = input.rest().to_vec();
        blob.push(0); // so that no block is empty
    } else {
        while !input.is_empty() {
            change(&mut blob, &mut input);
        }
    }
    if mode & KEEP_CHECKSUM == 0 {
        tiny::repair(&mut blob, mode & KEEP_LENGTH == 0);
    }
    tracked_with(&blob, mode >> 4)
}

/// As [`tracked`], with these bytes as the model and this content of the images.
pub(super) fn tracked_with(blob: &[u8], content: u8) -> Option<usize> {
    let model = Exact::of(blob, ALIGN);
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: 24,
        scan_budget: 2000,
        ..Default::default()
    };
    // SAFETY: as many bytes as stated.
    let status = unsafe { posewise_model_check(model.ptr().cast(), blob.len()) };
    check_info(&model, blob.len(), status);
    let frames = match Tracker::new(&model, Some(&config), 0xA5) {
        Ok(mut tracker) => {
            assert_eq!(status, POSEWISE_OK);
            Some(track(&mut tracker, content))
        }
        Err(rejected) => {
            assert_eq!(status, rejected);
            None
        }
    };
    assert!(model.get() == blob, "the model was written to");
    frames
}

/// What a model says of itself can be read of any bytes; a fault is named where there is one.
fn check_info(model: &Exact, len: usize, status: i32) {
    // SAFETY: plain numbers, and pointers that are not followed.
    let mut info: posewise_model_details = unsafe { std::mem::zeroed() };
    info.struct_size = size_of::<posewise_model_details>() as u32;
    // SAFETY: as many bytes as stated.
    let read = unsafe { posewise_model_info(model.ptr().cast(), len, &mut info) };
    assert_eq!(read, POSEWISE_OK);
    assert_eq!(info.check_len == 0, status == POSEWISE_OK);
    assert!(info.wrong_section == 0 || status == POSEWISE_E_MODEL);
    assert!(info.section_count as usize <= info.sections.len() && info.length as usize <= len);
    assert!(info.name_len <= info.sheet_len && info.sheet_len <= len);
}

/// Start and length of a section, or of header and table.
fn section(blob: &[u8], index: usize) -> (usize, usize) {
    let word = |at: usize| {
        let bytes = blob.get(at..at + 4).unwrap_or(&[0; 4]);
        u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize
    };
    let whole = (0, blob.len().min(HEADER_LEN + 16 * (tiny::SECTIONS + 1)));
    if index >= tiny::SECTIONS {
        return whole;
    }
    let entry = HEADER_LEN + 16 * index;
    let (start, len) = (word(entry + 4), word(entry + 8));
    // An earlier change may have moved it out of the blob.
    if len > 0 && start < blob.len() && len <= blob.len() - start {
        (start, len)
    } else {
        whole
    }
}

fn change(blob: &mut Vec<u8>, input: &mut Input<'_>) {
    let head = input.u8();
    let (start, len) = section(blob, head as usize >> 5);
    let at = start + input.u16() as usize % len.max(1);
    let word = at & !3;
    let count = 1 + (head as usize >> 2 & 7);
    match head & 3 {
        0 => {
            for byte in blob.iter_mut().skip(at).take(count) {
                *byte = input.u8();
            }
        }
        1 => {
            let value = EDGES[input.u8() as usize % EDGES.len()].to_le_bytes();
            for word in blob[word..].as_chunks_mut::<4>().0.iter_mut().take(count) {
                *word = value;
            }
        }
        2 => {
            let value = input.u32().to_le_bytes();
            if let Some(word) = blob[word..].first_chunk_mut::<4>() {
                *word = value;
            }
        }
        _ if count == 8 => blob.truncate(at.max(1)),
        // Offsets beyond 64 KB, for long sections.
        _ => {
            let at = start + (at - start + (count << 16)) % len.max(1);
            blob[at] = input.u8();
        }
    }
}

/// A few steps over images that differ slightly; returns the number that end in state tracking.
fn track(tracker: &mut Tracker, content: u8) -> usize {
    let mut tracked = 0;
    let mut data = Exact::new(WIDTH * HEIGHT, 1, 0);
    let mut seed = content as u32;
    for step in 0..5 {
        for (i, luma) in data.get_mut().iter_mut().enumerate() {
            let (x, y) = (i % WIDTH, i / WIDTH);
            *luma = match content & 3 {
                0 => (x * 4 + y + step) as u8,
                1 => scramble(&mut seed),
                2 => (x ^ y) as u8 * 3 + step as u8,
                _ => 90 + (x * x + y * y + 9 * step) as u8 % 32,
            };
        }
        let frame = posewise_frame {
            struct_size: size_of::<posewise_frame>() as u32,
            format: POSEWISE_FMT_GREY,
            timestamp_us: 33_333 * (step as i64 + 1),
            width: WIDTH as u32,
            height: HEIGHT as u32,
            stride: WIDTH as u32,
            rotation_deg: 0,
            flags: 0,
            reserved: 0,
            data_len: WIDTH * HEIGHT,
            data: data.ptr(),
        };
        // SAFETY: a whole frame.
        let outputs = unsafe { tracker.step(&frame) };
        tracked += usize::from(outputs.expect("a valid frame").is_tracking());
        // SAFETY: as above.
        unsafe { tracker.detect(&frame) }.expect("a valid frame");
    }
    tracked
}
