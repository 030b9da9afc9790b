//! Replays the inputs of the fuzz targets (`fuzz/seeds.tar.gz`) without a fuzzer.

mod common;
#[path = "../fuzz/src/targets/mod.rs"]
mod targets;

// The targets use `crate::ffi`.
use posewise::ffi;

use flate2::read::GzDecoder;
use std::fs::File;
use std::io::Read;

/// Runs every input of a target, in the order of their names.
fn replay(target: &str, run: fn(&[u8])) {
    let archive = File::open(common::root().join("fuzz/seeds.tar.gz")).expect("the inputs");
    let mut archive = tar::Archive::new(GzDecoder::new(archive));
    let mut count = 0;
    for entry in archive.entries().expect("a tar archive") {
        let mut entry = entry.expect("an entry");
        let path = entry.path().expect("a path").into_owned();
        if !path.starts_with(target) || !entry.header().entry_type().is_file() {
            continue;
        }
        println!("{}", path.display()); // shown when the input panics
        let mut input = Vec::new();
        entry.read_to_end(&mut input).expect("a whole archive");
        run(&input);
        count += 1;
    }
    assert!(count > 0, "no input of {target}");
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

/// Calls on images without a face: all of the unsafe code, fast enough for Miri.
#[test]
fn calls_without_a_face() {
    targets::calls::run(include_bytes!("data/calls-without-a-face"));
}

/// The other tests need a tiny model that is accepted and detects faces.
#[test]
fn tiny_model_tracks() {
    let images = [0x00, 0x10, 0x20, 0x30].map(|mode| targets::model::tracked(&[mode]));
    println!("{images:?}");
    assert!(images.iter().all(Option::is_some));
    assert!(images.iter().flatten().any(|tracked| *tracked > 2));
}
