//! Replays the inputs of the fuzz targets (`fuzz/seeds.tar.gz`) without a fuzzer.

mod common;
#[path = "../fuzz/src/targets/mod.rs"]
#[allow(dead_code)] // the soak test uses more of them
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

/// Random calls, mostly of the driver monitor's functions.
#[test]
fn calls_of_the_monitor() {
    let mut seed = 3u32;
    for round in 0..200 {
        let mut input = vec![targets::input::scramble(&mut seed)];
        for call in 0..30 {
            let mut next = || targets::input::scramble(&mut seed);
            // A monitor first, whose memory is right.
            let head = match call {
                0 => [223, 0],
                _ => [220 + next() % 36, next() & 0x3F],
            };
            input.extend(head);
            input.extend((0..24).map(|_| next()));
        }
        println!("{round}: {input:?}"); // shown when the input panics
        targets::calls::run(&input);
    }
}

/// The kept inputs, then random ones: models with changes and the right checksum.
#[test]
fn forged_models() {
    replay("forged", targets::forged::run);
    let mut seed = 1u32;
    let mut accepted = 0;
    for round in 0..4000 {
        let mut input: Vec<u8> = (0..1 + 6 * (1 + round % 4))
            .map(|_| targets::input::scramble(&mut seed))
            .collect();
        // The tiny model takes anything for a face; the trained one is large.
        if round % 16 != 0 {
            input[0] &= !1;
        }
        println!("{round}: {input:?}"); // shown when the input panics
        accepted += usize::from(targets::forged::tracked(&input).is_some());
    }
    println!("{accepted} models accepted");
    assert!(accepted > 1000);
}

/// A whole mesh, then random changes of it.
#[test]
fn forged_meshes() {
    let whole = [0, 1, 2, 3].map(|content| targets::mesh::tracked(&[content]));
    println!("{whole:?}");
    assert!(whole.iter().all(Option::is_some) && whole.iter().flatten().any(|n| *n > 2));
    let mut seed = 4u32;
    let mut accepted = 0;
    for round in 0..1500 {
        let input: Vec<u8> = (0..1 + 7 * (1 + round % 4))
            .map(|_| targets::input::scramble(&mut seed))
            .collect();
        println!("{round}: {input:?}"); // shown when the input panics
        accepted += usize::from(targets::mesh::tracked(&input).is_some());
    }
    println!("{accepted} meshes accepted");
    assert!(accepted > 100);
}

/// The kept inputs, then random networks, with all kernels.
#[test]
fn whole_layers() {
    replay("kernels", targets::kernels::run);
    let mut seed = 2u32;
    let mut layers = 0;
    for round in 0..2000 {
        let input: Vec<u8> = (0..6 + 4 * (1 + round % 8))
            .map(|_| targets::input::scramble(&mut seed))
            .collect();
        println!("{round}: {input:?}"); // shown when the kernels differ
        layers += targets::kernels::compared(&input).unwrap_or(0);
    }
    println!("{layers} layers");
    assert!(layers > 2000);
}

/// The other tests need a tiny model that is accepted and detects faces.
#[test]
fn tiny_model_tracks() {
    let images = [0x00, 0x10, 0x20, 0x30].map(|mode| targets::model::tracked(&[mode]));
    println!("{images:?}");
    assert!(images.iter().all(Option::is_some));
    assert!(images.iter().flatten().any(|tracked| *tracked > 2));
}
