//! `posewise eval` from the outside.

mod common;

use common::{arg, fails_with, posewise};
use std::fmt::Write;

fn columns(prefixes: &[&str]) -> String {
    let mut out = String::new();
    for prefix in prefixes {
        (0..68).for_each(|i| write!(out, ",{prefix}{i}").unwrap());
    }
    out
}

/// A truth of three frames and a table that tracked the first two, with known errors.
fn pose_files(dir: &std::path::Path) -> (String, String) {
    let mut truth = String::from("frame,yaw,pitch,roll,eye_mid_x,eye_mid_y,eye_mid_z,in_frame");
    truth += &columns(&["x", "y", "v", "o"]);
    let mut csv = String::from("frame,success,yaw_deg,pitch_deg,roll_deg,pose_Tx,pose_Ty,pose_Tz");
    csv += &columns(&["x_", "y_"]);
    for (frame, yaw) in [(0, 10), (1, -45), (2, 70)] {
        write!(truth, "\n{frame},{yaw},0,0,0,0,600,1").unwrap();
        // Box 67 wide, 67 high: its size is 67.
        (0..68).for_each(|i| write!(truth, ",{i}").unwrap());
        (0..68).for_each(|i| write!(truth, ",{i}").unwrap());
        truth += &",1".repeat(68);
        truth += &",0".repeat(68);
        let success = i32::from(frame < 2);
        write!(csv, "\n{},{success},{},1,-2,0,0,610", frame + 1, yaw + 3).unwrap();
        (0..68).for_each(|i| write!(csv, ",{}", f64::from(i) + 6.7).unwrap());
        (0..68).for_each(|i| write!(csv, ",{i}").unwrap());
    }
    let (t, c) = (dir.join("truth.csv"), dir.join("tracked.csv"));
    std::fs::write(&t, truth).unwrap();
    std::fs::write(&c, csv).unwrap();
    (arg(&t).to_string(), arg(&c).to_string())
}

#[test]
fn pose_numbers_by_hand() {
    let dir = tempfile::tempdir().unwrap();
    let (truth, csv) = pose_files(dir.path());
    let json = dir.path().join("pose.json");
    posewise()
        .args(["eval", "pose", "--truth", &truth, "--csv", &csv])
        .args(["--truth", &truth, "--csv", &csv, "--json", arg(&json)])
        .assert()
        .success();
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    let near = |key: &str, value: f64| {
        let found = json[key].as_f64().unwrap();
        assert!((found - value).abs() < 1e-9, "{key} is {found}");
    };
    near("frames", 6.0);
    near("p_s", 2.0 / 3.0);
    near("e_yaw_deg", 3.0);
    near("e_pitch_deg", 1.0);
    near("e_roll_deg", 2.0);
    near("e_m_deg", 2.0);
    near("translation_mm", 10.0);
    near("landmarks", 0.1);
    near("lost_within_60", 0.0);
    assert_eq!(json["yaw_bands"]["45-90"]["p_s"].as_f64(), Some(0.5));
    assert_eq!(json["yaw_bands"]["0-45"]["p_s"].as_f64(), Some(1.0));
}

#[test]
fn landmarks_of_a_picture_without_a_face() {
    let dir = tempfile::tempdir().unwrap();
    image::RgbImage::from_pixel(120, 120, image::Rgb([90; 3]))
        .save(dir.path().join("grey.png"))
        .unwrap();
    let mut labels = String::from("image");
    (0..68).for_each(|i| write!(labels, ",x{i},y{i}").unwrap());
    labels += "\ngrey.png";
    (0..68).for_each(|i| write!(labels, ",{},{}", 30 + i, 40 + i % 9).unwrap());
    let csv = dir.path().join("labels.csv");
    std::fs::write(&csv, &labels).unwrap();
    let (json, rows) = (dir.path().join("l.json"), dir.path().join("rows.csv"));
    let common = ["eval", "landmarks", "--csv", arg(&csv), "--images"];
    posewise()
        .args(common)
        .args([arg(dir.path()), "--json", arg(&json)])
        .args(["--per-image", arg(&rows)])
        .assert()
        .success();
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(json["found"].as_f64(), Some(0.0));
    assert_eq!(json["failure"].as_f64(), Some(1.0));
    assert!(json["nme68_mean"].is_null() && json["nme51_mean"].is_null());
    assert!(std::fs::read_to_string(rows).unwrap().contains("grey.png"));

    let with = |images: &str| [&common[..], &[images]].concat().join("\n");
    let run = |args: String, words: &[&str]| {
        fails_with(&args.split('\n').collect::<Vec<_>>(), Vec::new(), words);
    };
    run(with("/no/such/folder"), &["no such folder"]);
    std::fs::write(&csv, labels.replace("grey.png", "gone.png")).unwrap();
    run(with(arg(dir.path())), &["gone.png"]);
    std::fs::write(&csv, labels.replace(",33,", ",nan,")).unwrap();
    run(with(arg(dir.path())), &["line 2", "not a number"]);
    std::fs::write(&csv, labels.replace("x67", "z67")).unwrap();
    run(with(arg(dir.path())), &["no column x67"]);
    std::fs::write(&csv, labels.lines().next().unwrap()).unwrap();
    run(with(arg(dir.path())), &["no rows"]);
}

#[test]
fn bad_pose_tables_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let (truth, csv) = pose_files(dir.path());
    let pose = |args: &[&str], words: &[&str]| {
        fails_with(&[&["eval", "pose"], args].concat(), Vec::new(), words);
    };
    pose(
        &["--truth", "none.csv", "--csv", &csv],
        &["cannot open none.csv"],
    );
    pose(
        &["--truth", &truth, "--csv", "none.csv"],
        &["cannot open none.csv"],
    );
    pose(
        &["--truth", &csv, "--csv", &truth],
        &["truth.csv has no column success"],
    );
    pose(
        &["--truth", &truth, "--truth", &truth, "--csv", &csv],
        &["2 --truth files but 1 --csv files"],
    );
    let junk = dir.path().join("junk.csv");
    std::fs::write(&junk, b"\xff\xfe\x00,a\n1\n").unwrap();
    pose(
        &["--truth", arg(&junk), "--csv", &csv],
        &["junk.csv", "not a CSV table"],
    );
    posewise().args(["eval", "pose"]).assert().code(2);
}
