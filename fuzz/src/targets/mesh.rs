//! Forged meshes: section `MESH` of a model that takes anything for a face is changed at any place.
//! A model that is accepted must give valid meshes.
//!
//! ```text
//! u8 content of the images
//! then changes: u8 bits 0..=1 kind, 2.. length; u32 place in the section; the new content
//! ```

use super::input::Input;
use super::model;
use super::tiny;
use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

/// Most changes of a section.
const MOST_CHANGES: usize = 8;

/// Words at the limits of floats, of indices and of counts.
const WORDS: [u32; 12] = [
    0,
    1,
    0x7F7F_FFFF, // f32::MAX
    0xFF7F_FFFF,
    0x7F80_0000, // infinity
    0x7FC0_0000, // not a number
    0x4974_2400, // 1e6
    0xC974_2400,
    0x0053_0054, // the last index, and the one after it
    0xFFFF_FFFF,
    0x4343_4444, // the last landmark, and the one after it
    0x8080_7F7F,
];

pub fn run(data: &[u8]) {
    tracked(data);
}

/// As [`model::tracked`].
pub fn tracked(data: &[u8]) -> Option<usize> {
    let mut input = Input::new(data);
    let content = input.u8();
    let mut section = tiny::mesh().bytes().to_vec();
    for _ in 0..MOST_CHANGES {
        if input.is_empty() {
            break;
        }
        change(&mut section, &mut input);
    }
    model::tracked_with(&with_mesh(section), content)
}

/// The tiny model with a section `MESH`.
fn with_mesh(section: Vec<u8>) -> Vec<u8> {
    let bytes = AlignedBytes::new(tiny::model().get());
    let others = Blob::open(&bytes).expect("the tiny model is valid");
    let mut all = SectionWriter::all_but(&[], &others);
    all.push(SectionWriter::of_bytes(*b"MESH", section));
    blob(&all)
}

/// Changes some words, or cuts the section off.
fn change(section: &mut Vec<u8>, input: &mut Input<'_>) {
    let head = input.u8();
    let at = input.u32() as usize % section.len().max(1);
    let value = match head & 3 {
        0 => return section.truncate(at),
        1 => WORDS[usize::from(input.u8()) % WORDS.len()],
        _ => input.u32(),
    };
    let words = section[at / 4 * 4..].as_chunks_mut::<4>().0;
    for word in words.iter_mut().take(1 + usize::from(head >> 2)) {
        *word = value.to_le_bytes();
    }
}
