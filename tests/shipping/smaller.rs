//! Builds without what small boards can do without: each tracks the demo clip through the C ABI.

use crate::common::c::{cc, exists, require};
use crate::common::scratch;

/// What `make WITHOUT=…` leaves out; landmarks of a result; frames of 100 that it must track.
const BUILDS: [(&str, usize, usize); 4] = [
    ("refiners", 68, 90),
    ("verifier", 68, 90),
    ("keyframes", 68, 90),
    ("refiners verifier keyframes", 68, 90),
];

/// Frames of the demo clip, which shows one face all the time.
const FRAMES: usize = 100;

#[test]
fn every_build_tracks() {
    if !require("make") || !exists(&cc()) {
        return;
    }
    let folder = scratch("smaller");
    let clip = xtask::demo_clip(&folder).expect("tests/data/demo.y4m.gz");
    for (without, landmarks, least) in BUILDS {
        let library = xtask::Library {
            target: None,
            without: without.split(' ').map(String::from).collect(),
            target_dir: folder.clone(),
        };
        let replay = xtask::replay(&library, &clip, FRAMES, 0);
        let replay = replay.unwrap_or_else(|error| panic!("{error:#}"));
        println!("without {without}: {}{}", replay.line, replay.notes);
        assert!(replay.tracked() >= Some(least), "{}", replay.line);
        assert_eq!(replay.figure("landmarks"), Some(landmarks));
        // The sections that are not read are not there.
        let sections = [
            ("refiners", b"RFIN"),
            ("refiners", b"SREG"),
            ("verifier", b"VRFY"),
            ("verifier", b"ROTN"),
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
