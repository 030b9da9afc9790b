//! Writes the model that the crate embeds: models/default.posewise, in smaller builds without the
//! sections that they do not read.

// The rooms' own reader, so that there is one description of the format.
#[allow(unused)]
#[path = "src/model/mod.rs"]
mod model;

use model::{ALIGN, Blob, HEADER_LEN, Tag, crc32};
use std::path::Path;

const MODEL: &str = "models/default.posewise";

/// Sections that only one feature reads, by the name that cargo gives it here.
const READ_BY: [(&str, Tag); 3] = [
    ("CARGO_FEATURE_REFINERS", *b"RFIN"),
    ("CARGO_FEATURE_REFINERS", *b"SREG"),
    ("CARGO_FEATURE_VERIFIER", *b"VRFY"),
];

fn main() {
    println!("cargo:rerun-if-changed={MODEL}");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/model");
    let on = |feature: &str| std::env::var_os(feature).is_some();
    if !on("CARGO_FEATURE_DEFAULT_MODEL") {
        return;
    }
    let whole = std::fs::read(MODEL).expect(MODEL);
    let unread = READ_BY.iter().filter(|(feature, _)| !on(feature));
    let unread: Vec<Tag> = unread.map(|(_, tag)| *tag).collect();
    let embedded = match unread.is_empty() {
        true => whole,
        false => without(&whole, &unread),
    };
    let out = std::env::var_os("OUT_DIR").expect("cargo sets it");
    std::fs::write(Path::new(&out).join("default.posewise"), embedded)
        .expect("OUT_DIR is writable");
}

/// A model's file without these sections.
fn without(whole: &[u8], unread: &[Tag]) -> Vec<u8> {
    let mut aligned = vec![0; whole.len() + ALIGN];
    let start = aligned.as_ptr().align_offset(ALIGN);
    let aligned = &mut aligned[start..start + whole.len()];
    aligned.copy_from_slice(whole);
    let blob = Blob::open(aligned).expect("the default model is valid");
    let kept: Vec<_> = blob
        .sections()
        .filter(|(tag, _)| !unread.contains(tag))
        .collect();

    let first = (HEADER_LEN + 16 * kept.len()).next_multiple_of(ALIGN);
    let mut table = Vec::new();
    let mut out = whole[..HEADER_LEN].to_vec();
    out.resize(first, 0);
    for (tag, content) in &kept {
        out.resize(out.len().next_multiple_of(ALIGN), 0);
        table.extend_from_slice(tag);
        for word in [out.len(), content.len(), 0] {
            table.extend_from_slice(&(word as u32).to_le_bytes());
        }
        out.extend_from_slice(content);
    }
    out[HEADER_LEN..HEADER_LEN + table.len()].copy_from_slice(&table);
    // The header: total length, checksum of what follows it, number of sections.
    let head = [
        out.len() as u32,
        crc32(&out[HEADER_LEN..]),
        kept.len() as u32,
    ];
    for (to, word) in out[12..24].chunks_exact_mut(4).zip(head) {
        to.copy_from_slice(&word.to_le_bytes());
    }
    out
}
