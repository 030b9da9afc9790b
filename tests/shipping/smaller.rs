//! Builds without what small boards can do without: each tracks the demo clip through the C ABI.

use crate::common::c::{cc, require};
use crate::common::scratch;

/// Frames of the demo clip, which shows one face all the time.
const FRAMES: usize = 100;
/// Frames of these that a build must track.
const LEAST: usize = 90;

#[test]
#[ignore = "builds the library once more: .ci/nightly"]
fn the_smallest_build_tracks() {
    check(&["refiners keyframes mesh"]);
}

#[test]
#[ignore = "builds the library three times: .ci/nightly"]
fn every_build_tracks() {
    check(&["refiners", "keyframes", "mesh"]);
}

/// Tracks the clip with builds without these parts, as `make WITHOUT=…` makes them.
fn check(builds: &[&str]) {
    if !require("make") || !require(&cc()) {
        return;
    }
    let folder = scratch("smaller");
    let clip = xtask::demo_clip(&folder).expect("tests/data/demo.y4m.gz");
    for without in builds {
        let library = xtask::Library {
            target: None,
            without: without.split(' ').map(String::from).collect(),
            target_dir: folder.clone(),
        };
        let replay = xtask::replay(&library, &clip, FRAMES, 0);
        let replay = replay.unwrap_or_else(|error| panic!("{error:#}"));
        println!("without {without}: {}{}", replay.line, replay.notes);
        assert!(replay.tracked() >= Some(LEAST), "{}", replay.line);
        assert_eq!(replay.figure("landmarks"), Some(posewise::LANDMARKS));
        // The sections that are not read are not there.
        let sections = [
            ("refiners", b"RFIN"),
            ("refiners", b"SREG"),
            ("mesh", b"MESH"),
        ];
        let unread: usize = sections
            .iter()
            .filter(|(part, _)| without.contains(part))
            .map(|(_, tag)| section_len(tag))
            .sum();
        let left = posewise::DEFAULT_MODEL.len() - unread;
        let apart = left.abs_diff(replay.figure("model").expect("its size"));
        assert!(apart < 256, "{apart} bytes more than padding");
    }
}

/// Bytes of a section of the default model.
fn section_len(tag: &[u8; 4]) -> usize {
    let blob = posewise_format::Blob::open(posewise::DEFAULT_MODEL).expect("it is valid");
    let section = blob.sections().find(|(found, _)| found == tag);
    section.map_or(0, |(_, content)| content.len())
}
