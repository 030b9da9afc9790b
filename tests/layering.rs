//! The rooms of `src/` use only rooms of lower layers, and the crate keeps its promises on `std`,
//! `unsafe` and documentation.

mod common;

use common::root;
use std::path::{Path, PathBuf};

/// Room, layer as the table in `src/lib.rs` prints it, rank. A room may use rooms of lower rank;
/// `monitor` shares a layer with `track`, which it reads.
const ROOMS: [(&str, &str, u32); 12] = [
    ("math", "0", 0),
    ("time", "0", 0),
    ("image", "1", 1),
    ("network", "2", 2),
    ("shape", "2", 2),
    ("detect", "3", 3),
    ("align", "3", 3),
    ("verifier", "3", 3),
    ("keyframe", "3", 3),
    ("track", "4", 4),
    ("monitor", "4", 5),
    ("ffi", "5", 6),
];

/// Where `unsafe` may be written: the C ABI, SIMD kernels.
const UNSAFE: [&str; 2] = ["src/ffi/", "src/network/kernel/"];

fn rank(room: &str) -> Option<u32> {
    let known = ROOMS.iter().find(|(name, _, _)| *name == room);
    known.map(|(_, _, rank)| *rank)
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The code of a file: comments and string contents blanked, line breaks kept.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("a source file");
    let mut out = String::new();
    let mut chars = text.chars().peekable();
    let mut in_string = false;
    while let Some(c) = chars.next() {
        match c {
            '\\' if in_string => drop(chars.next()),
            '"' => in_string = !in_string,
            // A quote as a character is no string.
            '\'' if !in_string && chars.peek() == Some(&'"') => drop(chars.next()),
            '/' if !in_string && chars.peek() == Some(&'/') => {
                chars.by_ref().find(|c| *c == '\n');
                out.push('\n');
            }
            _ if !in_string || c == '\n' => out.push(c),
            _ => {}
        }
    }
    out
}

/// The first path segments after each `prefix`, also of `prefix{a::…, b}`.
fn segments(code: &str, prefix: &str) -> Vec<String> {
    let word = |text: &str| -> String {
        let text = text.trim_start();
        text.chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let mut found = Vec::new();
    for (at, _) in code.match_indices(prefix) {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[at + prefix.len()..];
        let Some(group) = rest.trim_start().strip_prefix('{') else {
            found.push(word(rest));
            continue;
        };
        found.push(word(group));
        let mut depth = 1;
        for (i, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth == 1 => break,
                '}' => depth -= 1,
                ',' if depth == 1 => found.push(word(&group[i + 1..])),
                _ => {}
            }
        }
    }
    found.retain(|segment| !segment.is_empty());
    found
}

/// The room that a file below `src/` belongs to; `None` for `lib.rs`.
fn room(path: &Path) -> Option<String> {
    let inside = path.strip_prefix(root().join("src")).expect("below src/");
    let first = inside.components().next().expect("a name").as_os_str();
    let name = first.to_str().expect("UTF-8").trim_end_matches(".rs");
    (name != "lib").then(|| name.to_string())
}

#[test]
fn rooms_use_lower_layers_only() {
    let mut wrong = Vec::new();
    for path in rust_files(&root().join("src")) {
        let Some(own) = room(&path) else { continue };
        let own_rank = rank(&own).unwrap_or_else(|| panic!("{own} is not a room of the table"));
        let code = code(&path);
        for other in segments(&code, "crate::") {
            // A capitalised or unknown name is an item of lib.rs itself.
            if other != own && rank(&other).is_some_and(|rank| rank >= own_rank) {
                wrong.push(format!("{} uses crate::{other}", path.display()));
            }
        }
        // `super` must not be a way around: it stays inside the room.
        if path.ends_with("mod.rs") && path.parent() == Some(&root().join("src").join(&own)) {
            for other in segments(&code, "super::") {
                if other != own && rank(&other).is_some() {
                    wrong.push(format!("{} uses super::{other}", path.display()));
                }
            }
        }
        for other in segments(&code, "super::super::") {
            if rank(&other).is_some() {
                wrong.push(format!("{} uses super::super::{other}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_table_in_lib_rs_is_this_one() {
    let lib = std::fs::read_to_string(root().join("src/lib.rs")).expect("lib.rs");
    let rows = lib.lines().filter_map(|line| line.strip_prefix("//! | "));
    let mut documented = Vec::new();
    for row in rows.filter(|row| row.starts_with(|c: char| c.is_ascii_digit())) {
        let mut cells = row.split('|').map(str::trim);
        let layer = cells.next().expect("a layer");
        let name = cells.next().expect("a room").trim_matches(['[', ']', '`']);
        let known = ROOMS.iter().find(|(room, _, _)| *room == name);
        assert_eq!(known.map(|(_, l, _)| *l), Some(layer), "layer of {name}");
        documented.push(name.to_string());
    }
    documented.sort();
    let mut present: Vec<_> = rust_files(&root().join("src"))
        .iter()
        .filter_map(|p| room(p))
        .collect();
    present.dedup();
    present.sort();
    assert_eq!(documented, present, "rooms in the table, rooms in src/");
}

#[test]
fn the_core_promises_hold() {
    let lib = std::fs::read_to_string(root().join("src/lib.rs")).expect("lib.rs");
    for promise in [
        "#![no_std]",
        "#![deny(missing_docs)]",
        "#![deny(unsafe_code)]",
    ] {
        assert!(lib.lines().any(|line| line == promise), "{promise}");
    }
    for path in rust_files(&root().join("src")) {
        let name = path
            .strip_prefix(root())
            .expect("below the root")
            .display()
            .to_string();
        let text = std::fs::read_to_string(&path).expect("a source file");
        let code = code(&path);
        for other_world in ["std::", "extern crate"] {
            assert!(
                segments(&code, other_world).is_empty(),
                "{name}: {other_world}"
            );
        }
        if UNSAFE.iter().any(|place| name.starts_with(place)) {
            let reasons = text.matches("SAFETY:").count();
            assert!(
                reasons > 0 || !code.contains("unsafe {"),
                "{name}: unsafe without SAFETY"
            );
        } else {
            let code = code.replace("#![deny(unsafe_code)]", "");
            assert!(!code.contains("unsafe"), "{name} has unsafe code");
        }
    }
}

#[test]
fn uses_are_found() {
    let code =
        "use crate::{image::{Frame, Crop}, math, track::Model}; a(crate::shape::X); $crate::y!()";
    assert_eq!(
        segments(code, "crate::"),
        ["image", "math", "track", "shape"]
    );
}
