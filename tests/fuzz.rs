//! Replays the inputs of the fuzz targets (`fuzz/seeds/`) without a fuzzer.

mod common;
// The C ABI is no part of the library as tests link it.
#[allow(dead_code)]
#[path = "../src/ffi/mod.rs"]
mod ffi;
#[path = "../fuzz/src/targets/mod.rs"]
mod targets;

// What `ffi` finds in the crate that it belongs to.
use posewise::{DEFAULT_MODEL, image, model, shape, track};

/// Every input of a target, in the order of their names.
fn replay(target: &str, run: fn(&[u8])) {
    let folder = common::root().join("fuzz/seeds").join(target);
    let entries = std::fs::read_dir(&folder).expect("a folder of inputs");
    let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in paths {
        println!("{}", path.display()); // shown when the input panics
        run(&std::fs::read(&path).expect("an input"));
    }
}

#[test]
fn models() {
    replay("model", targets::model::run);
}

#[test]
fn frames() {
    replay("frame", targets::frame::run);
}

#[test]
fn calls() {
    replay("calls", targets::calls::run);
}

/// Calls on pictures without a face: all of the unsafe code, and nothing that takes Miri minutes.
#[test]
fn calls_without_a_face() {
    targets::calls::run(include_bytes!("../fuzz/seeds/calls/flat"));
}

/// Were it refused, or blind, most of the inputs would test nothing.
#[test]
fn tiny_model_tracks() {
    let pictures = [0x00, 0x10, 0x20, 0x30].map(|mode| targets::model::tracked(&[mode]));
    println!("{pictures:?}");
    assert!(pictures.iter().all(Option::is_some));
    assert!(pictures.iter().flatten().any(|tracked| *tracked > 2));
}
