//! The modules of `src/` import only modules of lower layers, and the crate keeps its promises on
//! `std`, `unsafe` and documentation. The command sees what every user of the crate sees.

use super::imports::{imports, modules};
use crate::common::root;
use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};

/// Where `unsafe` may be written: the C ABI, SIMD kernels.
const UNSAFE: [&str; 2] = ["src/ffi/", "src/network/kernel/"];

/// Modules and their layers, of the table in `src/lib.rs`. A module may use modules of lower
/// layers.
fn layers() -> BTreeMap<String, u32> {
    let lib = std::fs::read_to_string(root().join("src/lib.rs")).expect("lib.rs");
    let rows = lib.lines().filter_map(|line| line.strip_prefix("//! | "));
    let layer = |row: &str| {
        let (layer, rest) = row.split_once(" | ")?;
        let name = rest.split_once(" | ")?.0.trim().trim_matches('`');
        Some((name.to_owned(), layer.trim().parse().ok()?))
    };
    rows.filter_map(layer).collect()
}

#[test]
fn modules_use_lower_layers_only() {
    let layers = layers();
    let imports = imports(&root().join("src"));
    let named: BTreeSet<&String> = imports.keys().filter_map(|module| module.first()).collect();
    assert_eq!(
        named,
        layers.keys().collect(),
        "modules, and those in the table"
    );
    let mut wrong = Vec::new();
    for (module, used) in imports.iter().filter(|(module, _)| !module.is_empty()) {
        let own = &module[0];
        let others = used.iter().filter_map(|other| other.first());
        for other in others.filter(|other| *other != own && layers[*other] >= layers[own]) {
            wrong.push(format!("{} uses {other}", module.join("::")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Modules that every user of the crate sees.
const PUBLIC: [&str; 2] = ["ffi", "monitor"];

/// Only programs that make and measure models see the other modules; the command uses neither of
/// them.
#[test]
fn product_and_laboratory_are_apart() {
    let manifest = |name: &str| {
        let path = root().join("crates").join(name).join("Cargo.toml");
        std::fs::read_to_string(path).expect("a manifest")
    };
    let crates = std::fs::read_dir(root().join("crates")).expect("a folder");
    for entry in crates {
        let name = entry.expect("an entry").file_name();
        let name = name.to_string_lossy().into_owned();
        let inner = manifest(&name).contains("unstable-internals");
        assert_eq!(inner, ["lab", "trainer"].contains(&&*name), "{name}");
    }
    let command = manifest("cli");
    for other in ["posewise-lab", "posewise-train"] {
        assert!(!command.contains(other), "the command uses {other}");
    }
    let layers = layers();
    for path in modules(&root().join("crates/cli/src")).values() {
        let text = std::fs::read_to_string(path).expect("a source file");
        let mut inner = layers.keys().filter(|m| !PUBLIC.contains(&m.as_str()));
        let named = inner.find(|m| text.contains(&format!("posewise::{m}::")));
        assert_eq!(named, None, "{}", path.display());
    }
}

/// The words of some code, those of inner groups too.
fn words(tokens: TokenStream, found: &mut Vec<String>) {
    for token in tokens {
        match token {
            TokenTree::Ident(word) => found.push(word.to_string()),
            TokenTree::Group(group) => words(group.stream(), found),
            _ => {}
        }
    }
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
    for path in modules(&root().join("src")).values() {
        let name = path.strip_prefix(root()).expect("below the root");
        let name = name.display().to_string();
        let text = std::fs::read_to_string(path).expect("a source file");
        let mut found = Vec::new();
        words(text.parse().expect("Rust code"), &mut found);
        let has = |word: &str| found.iter().any(|f| f == word);
        let links = found.windows(2).any(|pair| pair == ["extern", "crate"]);
        assert!(!has("std") && !links, "{name}: std");
        let may = UNSAFE.iter().any(|place| name.starts_with(place));
        assert!(may || !has("unsafe"), "{name} has unsafe code");
        let says_why = text.contains("SAFETY:") || !text.contains("unsafe {");
        assert!(says_why, "{name}: unsafe without SAFETY");
    }
}
