//! Forged models: sections of a valid model are changed at any place, with numbers at the limits
//! of their types, and the checksum is corrected. A model that is accepted must give valid results.
//!
//! ```text
//! u8 mode   bit 0: the valid model is the default model; else the tiny one
//!           bits 1..=2: content of the images
//! then changes: u8 bits 0..=1 kind, 2..=4 section, 5.. length; u32 place in it; the new content
//! ```

use super::input::Input;
use super::model;
use super::tiny;
use posewise_format::HEADER_LEN;

const TRAINED: u8 = 1;

/// Most changes of a model.
const MOST_CHANGES: usize = 8;

/// Floats that are finite but whose products or sums are not, and others at limits.
const FLOATS: [f32; 12] = [
    f32::MAX,
    -f32::MAX,
    1e30,
    -1e30,
    1e19,
    -1e19,
    1e9,
    f32::MIN_POSITIVE,
    1e-30,
    -1e-30,
    -0.0,
    f32::INFINITY,
];

/// Integers at limits, as the 32-bit words that they are or fill.
const INTEGERS: [u32; 12] = [
    0,
    1,
    0x7F7F_7F7F, // i8::MAX, four times
    0x8080_8080, // i8::MIN
    0x7FFF_7FFF, // i16::MAX, twice
    0x8000_8000, // i16::MIN
    i32::MAX as u32,
    i32::MIN as u32,
    i32::MIN as u32 + 1,
    1 << 24,
    1 << 30,
    u32::MAX,
];

pub fn run(data: &[u8]) {
    tracked(data);
}

/// As [`model::tracked`].
pub fn tracked(data: &[u8]) -> Option<usize> {
    let mut input = Input::new(data);
    let mode = input.u8();
    let mut blob = match mode & TRAINED {
        0 => tiny::model().get().to_vec(),
        _ => posewise::DEFAULT_MODEL.to_vec(),
    };
    for _ in 0..MOST_CHANGES {
        if input.is_empty() {
            break;
        }
        change(&mut blob, &mut input);
    }
    tiny::repair(&mut blob, true);
    model::tracked_with(&blob, mode >> 1)
}

/// Changes some words of a section.
fn change(blob: &mut [u8], input: &mut Input<'_>) {
    let head = input.u8();
    let index = usize::from((head >> 2) & 7) % tiny::SECTIONS;
    let entry = HEADER_LEN + 16 * index;
    let word = |at: usize| {
        let bytes = blob[at..at + 4].try_into().expect("four bytes");
        u32::from_le_bytes(bytes) as usize
    };
    let (start, len) = (word(entry + 4), word(entry + 8));
    let at = start + (input.u32() as usize % len / 4 * 4);
    let words = blob[at..start + len].as_chunks_mut::<4>().0;
    let value = match head & 3 {
        0 => FLOATS[usize::from(input.u8()) % FLOATS.len()].to_bits(),
        1 => INTEGERS[usize::from(input.u8()) % INTEGERS.len()],
        _ => input.u32(),
    };
    // One word, or up to 2,187: whole rows of constants.
    for word in words.iter_mut().take(3usize.pow((head >> 5).into())) {
        *word = value.to_le_bytes();
    }
}
