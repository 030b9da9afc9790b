//! The modules of `src/` use only modules of lower layers, and the crate keeps its promises on
//! `std`, `unsafe` and documentation.

mod common;

use common::root;
use std::path::{Path, PathBuf};

/// Modules and their layers, as the table in `src/lib.rs` has them. A module may use modules of
/// lower layers.
const MODULES: [(&str, u32); 11] = [
    ("math", 0),
    ("image", 1),
    ("network", 2),
    ("shape", 2),
    ("detect", 3),
    ("align", 3),
    ("verifier", 3),
    ("keyframe", 3),
    ("track", 4),
    ("monitor", 5),
    ("ffi", 6),
];

/// Where `unsafe` may be written: the C ABI, SIMD kernels.
const UNSAFE: [&str; 2] = ["src/ffi/", "src/network/kernel/"];

fn layer(module: &str) -> Option<u32> {
    let known = MODULES.iter().find(|(name, _)| *name == module);
    known.map(|(_, layer)| *layer)
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

/// The module that a file below `src/` belongs to; `None` for `lib.rs`.
fn module(path: &Path) -> Option<String> {
    let inside = path.strip_prefix(root().join("src")).expect("below src/");
    let first = inside.components().next().expect("a name").as_os_str();
    let name = first.to_str().expect("UTF-8").trim_end_matches(".rs");
    (name != "lib").then(|| name.to_string())
}

#[test]
fn modules_use_lower_layers_only() {
    let mut wrong = Vec::new();
    for path in rust_files(&root().join("src")) {
        let Some(own) = module(&path) else { continue };
        let own_layer = layer(&own).unwrap_or_else(|| panic!("{own} is not in the table"));
        let code = code(&path);
        for other in segments(&code, "crate::") {
            // A capitalised or unknown name is an item of lib.rs itself.
            if other != own && layer(&other).is_some_and(|layer| layer >= own_layer) {
                wrong.push(format!("{} uses crate::{other}", path.display()));
            }
        }
        // `super` must not be a way around: it stays inside the module.
        if path.ends_with("mod.rs") && path.parent() == Some(&root().join("src").join(&own)) {
            for other in segments(&code, "super::") {
                if other != own && layer(&other).is_some() {
                    wrong.push(format!("{} uses super::{other}", path.display()));
                }
            }
        }
        for other in segments(&code, "super::super::") {
            if layer(&other).is_some() {
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
        let stated = cells.next().and_then(|cell| cell.parse().ok());
        let name = cells.next().expect("a module").trim_matches('`');
        assert_eq!(layer(name), stated, "layer of {name}");
        documented.push(name.to_string());
    }
    documented.sort();
    let mut present: Vec<_> = rust_files(&root().join("src"))
        .iter()
        .filter_map(|p| module(p))
        .collect();
    present.dedup();
    present.sort();
    assert_eq!(documented, present, "modules in the table, modules in src/");
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
