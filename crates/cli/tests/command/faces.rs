//! `posewise track --faces`: two people who pass each other and swap sides keep their numbers.
//!
//! The clip in tests/data/crossing is rendered with `posewise-lab crossings --seed 7` on a plain
//! background: frames 13 to 98 of the first one at half the size. Its truth has the box of each
//! face and the share of its landmarks that the person before it does not cover.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::{arg, posewise};
use ::posewise::is_same_face;

/// Faces of which less is seen are not counted.
const UNCOVERED: f32 = 0.5;

type Box = [f32; 4];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/crossing")
}

/// The rows of a table as maps from column to text.
fn table(text: &[u8]) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text);
    reader
        .deserialize()
        .map(|row| row.expect("a table"))
        .collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f32 {
    row[column].parse().expect("a number")
}

fn face_box(row: &BTreeMap<String, String>, columns: [&str; 4]) -> Box {
    columns.map(|column| number(row, column))
}

#[test]
fn two_people_who_cross_keep_their_numbers() {
    let run = posewise()
        .args(["track", arg(&folder()), "--fps", "25", "--min-face", "24"])
        .args(["--faces", "2", "--csv", "-", "--quiet"])
        .assert()
        .success();
    let mut tracked: BTreeMap<u32, Vec<(usize, Box)>> = BTreeMap::new();
    for row in table(&run.get_output().stdout) {
        if number(&row, "success") == 1.0 {
            let face = face_box(&row, ["box_x", "box_y", "box_w", "box_h"]);
            let id = number(&row, "face_id") as usize;
            let frame = number(&row, "frame") as u32;
            tracked.entry(frame).or_default().push((id, face));
        }
    }
    let truth = std::fs::read(folder().join("truth.csv")).expect("the truth");
    let (mut own, mut right, mut all) = ([None; 2], 0, 0);
    for row in table(&truth) {
        if number(&row, "uncovered") < UNCOVERED {
            continue;
        }
        let person = number(&row, "person") as usize;
        let face = face_box(&row, ["x", "y", "width", "height"]);
        let found = tracked.get(&(number(&row, "frame") as u32));
        let on_it: Vec<usize> = (found.into_iter().flatten())
            .filter(|(_, found)| is_same_face(found, &face))
            .map(|(id, _)| *id)
            .collect();
        own[person] = own[person].or(on_it.first().copied());
        all += 1;
        right += usize::from(on_it.len() == 1 && own[person] == on_it.first().copied());
    }
    assert_ne!(own[0], own[1]);
    println!("{right} of {all}");
    assert!(right as f32 >= 0.95 * all as f32, "{right} of {all}");
}

#[test]
fn a_frame_without_a_face_has_no_row_and_one_tracker_has_all_rows() {
    let clip = crate::common::gradient_clip(64, 48, 3);
    let rows = |faces: &str| {
        let run = posewise()
            .args(["track", "-", "--csv", "-", "--quiet", "--faces", faces])
            .write_stdin(clip.clone())
            .assert()
            .success();
        table(&run.get_output().stdout).len()
    };
    assert_eq!((rows("1"), rows("2")), (3, 0));
    for bad in ["0", "18", "two"] {
        let run = posewise().args(["track", "-", "--faces", bad]).assert();
        let output = run.get_output();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("--faces"), "{said}");
    }
}
