//! Builds without what small boards can do without: each tracks the demo clip through the C ABI.

mod common;

use common::c::{cc, exists, require};
use common::{root, scratch};
use std::process::Command;

/// What `make WITHOUT=…` leaves out; landmarks of an answer; frames in a hundred that it must track.
const BUILDS: [(&str, usize, usize); 5] = [
    ("refiners", 68, 95),
    ("verifier adaptation", 68, 90),
    ("adaptation", 68, 95),
    ("keyframes", 68, 95),
    ("refiners verifier adaptation keyframes", 68, 90),
];

/// Frames of the demo clip, which shows one face all the time.
const FRAMES: usize = 100;

#[test]
fn every_build_tracks() {
    if !require("make") || !exists(&cc()) {
        return;
    }
    let Some(demo) = common::demo() else {
        eprintln!("skipped: there is no tests/data/demo.y4m.gz");
        return;
    };
    let folder = scratch("smaller");
    let clip = folder.join("demo.y4m");
    std::fs::write(&clip, demo.y4m).expect("target/ is writable");
    for (without, landmarks, least) in BUILDS {
        let mut make = Command::new("make");
        make.args(["-s", "-C"]).arg(root()).arg("replay");
        make.arg(format!("TARGET_DIR={}", folder.display()));
        make.arg(format!("CLIP={}", clip.display()));
        make.arg(format!("FRAMES={FRAMES}"));
        let output = make.arg(format!("WITHOUT={without}")).output();
        let output = output.expect("make runs");
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        let (line, said) = (text(output.stdout), text(output.stderr));
        assert!(output.status.success(), "{make:?}\n{line}{said}");
        println!("without {without}: {line}{said}");
        let tracked = line.split(' ').rev().nth(1).and_then(|n| n.parse().ok());
        assert!(tracked >= Some(least), "{line}");

        let figure = |name: &str| -> usize {
            let line = said.lines().find_map(|line| line.strip_prefix(name));
            let figure = line.and_then(|rest| rest.split(' ').next()?.parse().ok());
            figure.unwrap_or_else(|| panic!("no {name}in {said}"))
        };
        assert_eq!(figure("landmarks: "), landmarks);
        // The sections that are not read are not there.
        let sections = [
            ("refiners", b"RFIN"),
            ("refiners", b"SREG"),
            ("verifier", b"VRFY"),
        ];
        let unread: usize = sections
            .iter()
            .filter(|(part, _)| without.contains(part))
            .map(|(_, tag)| section_len(tag))
            .sum();
        let left = posewise::DEFAULT_MODEL.len() - unread;
        let apart = left.abs_diff(figure("model: "));
        assert!(apart < 256, "{apart} bytes more than padding");
    }
}

/// Bytes of a section of the default model.
fn section_len(tag: &[u8; 4]) -> usize {
    let blob = posewise_format::Blob::open(posewise::DEFAULT_MODEL).expect("it is valid");
    let section = blob.sections().find(|(found, _)| found == tag);
    section.map_or(0, |(_, content)| content.len())
}
