//! `posewise-lab eval` from the outside.

use crate::common::{DEMO, arg, fails_with, program, track};
use std::fmt::Write;
use std::io::Read;

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
        // Half of the landmarks are covered in the second frame.
        let covered = if frame == 1 { 34 } else { 33 };
        truth += &",1".repeat(covered);
        truth += &",0".repeat(68 - covered);
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
    program()
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
    assert_eq!(json["covered"]["counted"].as_u64(), Some(2));
    assert_eq!(json["covered"]["p_s"].as_f64(), Some(1.0));
    assert_eq!(json["uncovered"]["counted"].as_u64(), Some(4));
    assert_eq!(json["uncovered"]["p_s"].as_f64(), Some(0.5));
}

/// Pictures without a face, and one that is listed as having one and cannot be read.
fn backgrounds(dir: &std::path::Path) -> String {
    let folder = dir.join("backgrounds");
    std::fs::create_dir(&folder).unwrap();
    for i in 0..5u32 {
        let pixel = |x: u32, y: u32| image::Rgb([(x * (i + 1) + y) as u8, (x ^ y) as u8, 90]);
        image::RgbImage::from_fn(120, 80 + 20 * i, pixel)
            .save(folder.join(format!("{i}.png")))
            .unwrap();
    }
    std::fs::write(folder.join("5.png"), "a person").unwrap();
    std::fs::write(folder.join("with-people.txt"), "5.png\n").unwrap();
    arg(&folder).to_string()
}

/// Runs a command that writes JSON; what it wrote.
fn json_of(args: &[&str]) -> serde_json::Value {
    let dir = tempfile::tempdir().unwrap();
    let json = dir.path().join("out.json");
    program()
        .args(args)
        .args(["--json", arg(&json)])
        .assert()
        .success();
    serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap()
}

#[test]
fn a_face_that_comes_back_is_found() {
    let dir = tempfile::tempdir().unwrap();
    let folder = backgrounds(dir.path());
    let recovery = |more: &[&str]| {
        let common = ["eval", "recovery", "--clip", DEMO[0], "--backgrounds"];
        [&common[..], &[&folder], more].concat().join("\n")
    };
    let args = recovery(&["--pieces", "2", "--length", "30"]);
    let args: Vec<&str> = args.split('\n').collect();
    let json = json_of(&args);
    let modes = [("half_mirrored", 1), ("not_mirrored", 0), ("first_seen", 0)];
    for (mode, mirrored) in modes {
        let mode = &json[mode];
        let pieces = mode["pieces"].as_array().unwrap();
        assert_eq!(pieces.len(), 2);
        let count = pieces.iter().filter(|p| p["mirrored"] == true).count();
        assert_eq!(count, mirrored);
        assert_ne!(pieces[0]["from_frame"], pieces[1]["from_frame"]);
        assert_eq!(mode["never"].as_u64(), Some(0), "{json:#}");
        assert_eq!(mode["false_tracks"].as_u64(), Some(0), "{json:#}");
        // Two seconds at 20 frames per second.
        assert_eq!(mode["faceless_frames"].as_u64(), Some(40));
        assert!(mode["worst_frames"].as_f64() >= mode["median_frames"].as_f64());
    }
    let only = json_of(&[&args[..], &["--no-mirror"]].concat());
    assert!(only["half_mirrored"].is_null());
    for mode in ["not_mirrored", "first_seen"] {
        assert_eq!(only[mode], json[mode], "same seed");
    }

    let fails = |more: &[&str], words: &[&str]| {
        let args = recovery(more);
        fails_with(&args.split('\n').collect::<Vec<_>>(), words);
    };
    fails(
        &["--pieces", "3"],
        &["demo.y4m.gz has 120 frames", "too few"],
    );
    fails(&["--pieces", "0"], &["at least 1"]);
    fails(
        &["--every", "9"],
        &["5 pictures without people", "--every 1"],
    );
    fails(
        &["--every", "2", "--offset", "2"],
        &["--offset must be less"],
    );
}

/// The first frame of [`DEMO`] as a picture, and its labels as `eval landmarks` takes them.
fn labelled_picture(dir: &std::path::Path) -> String {
    let mut y4m = Vec::new();
    let file = std::fs::File::open(DEMO[0]).unwrap();
    flate2::read::GzDecoder::new(file)
        .read_to_end(&mut y4m)
        .unwrap();
    let start = y4m.windows(6).position(|w| w == b"FRAME\n").unwrap() + 6;
    let luma = y4m[start..start + 320 * 240].to_vec();
    let picture = image::GrayImage::from_raw(320, 240, luma).unwrap();
    picture.save(dir.join("face.png")).unwrap();
    let truth = std::fs::read_to_string(DEMO[1]).unwrap();
    let mut rows = truth
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let (names, row) = (rows.next().unwrap(), rows.next().unwrap());
    let mut labels = String::from("image");
    let mut values = String::from("\nface.png");
    for axis in ["x", "y"] {
        for i in 0..68 {
            let name = format!("{axis}{i}");
            let at = names.iter().position(|n| *n == name).unwrap();
            write!(labels, ",{name}").unwrap();
            write!(values, ",{}", row[at]).unwrap();
        }
    }
    let csv = dir.join("labels.csv");
    std::fs::write(&csv, labels + &values).unwrap();
    arg(&csv).to_string()
}

#[test]
fn a_face_anywhere_is_found_in_some_frames() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, csv) = (backgrounds(dir.path()), labelled_picture(dir.path()));
    let common = [
        "eval",
        "latency",
        "--csv",
        &csv,
        "--images",
        arg(dir.path()),
    ];
    let common = [&common[..], &["--backgrounds", &folder]].concat();
    let json = json_of(&[&common[..], &["--frame", "320x240", "--faces", "3"]].concat());
    let found = &json["320x240"];
    assert_eq!(found["not_found"].as_u64(), Some(0), "{json:#}");
    assert_eq!(found["frames_until_tracked"].as_array().unwrap().len(), 3);
    assert!(found["worst_frames"].as_u64() <= Some(5), "{json:#}");

    let none = [&common[..], &["--faces", "0"]].concat();
    fails_with(&none, &["at least 1"]);
    for wrong in [["--frame", "640"], ["--face", "nan"]] {
        program().args(&common).args(wrong).assert().code(2);
    }
}

#[test]
fn nobody_is_tracked_in_pictures_without_people() {
    let dir = tempfile::tempdir().unwrap();
    let folder = backgrounds(dir.path());
    let common = ["eval", "faceless", "--backgrounds", &folder];
    let more = ["--scan-budget", "2000"];
    let json = json_of(&[&common[..], &more].concat());
    assert_eq!(json["pictures"].as_u64(), Some(1), "the held-out fifth");
    assert_eq!(json["frames"].as_u64(), Some(25));
    assert_eq!(json["tracked"].as_u64(), Some(0));
    assert!(json["tracked_before"].is_null());
    let after = ["--every", "3", "--offset", "0", "--after", DEMO[0]];
    let json = json_of(&[&common[..], &more, &after].concat());
    assert_eq!(json["frames"].as_u64(), Some(50));
    assert_eq!(json["tracked"].as_u64(), Some(0));
    assert_eq!(json["tracked_before"].as_u64(), Some(2));
    let damaged = dir.path().join("backgrounds/0.jpg");
    std::fs::write(damaged, "none").unwrap();
    let all = [&common[..], &more, &["--every", "1"]].concat();
    fails_with(&all, &["cannot decode picture", "0.jpg"]);
    fails_with(
        &["eval", "faceless", "--backgrounds", "/no/such/folder"],
        &["cannot list folder /no/such/folder"],
    );
}

#[test]
fn angles_of_the_demo_clip_do_not_drift() {
    let drift = |truth: &'static str| ["eval", "drift", "--clip", DEMO[0], "--truth", truth];
    let json = json_of(&[&drift(DEMO[1])[..], &["--minutes", "0.4"]].concat());
    // 0.4 minutes at 20 frames per second: forwards and backwards twice.
    assert_eq!(json["frames"].as_u64(), Some(480));
    assert_eq!(json["lost"].as_u64(), Some(0));
    let number = |key: &str| json[key].as_f64().unwrap();
    let ratio = number("last_over_first");
    assert!((number("e_m_deg_last") / number("e_m_deg_first") - ratio).abs() < 1e-9);
    assert!((0.5..1.5).contains(&ratio), "{ratio}");
    fails_with(&drift("none.csv"), &["cannot open none.csv"]);
    let dir = tempfile::tempdir().unwrap();
    let short = dir.path().join("short.csv");
    let truth = std::fs::read_to_string(DEMO[1]).unwrap();
    let lines: Vec<&str> = truth.lines().take(50).collect();
    std::fs::write(&short, lines.join("\n")).unwrap();
    let drift = ["eval", "drift", "--clip", DEMO[0], "--truth", arg(&short)];
    fails_with(&drift, &["short.csv has no row for frame 49"]);
    fails_with(
        &[&drift[..], &["--minutes=-1"]].concat(),
        &["--minutes must be positive"],
    );
}

#[test]
fn jitter_beside_the_picture_s_own_motion() {
    let dir = tempfile::tempdir().unwrap();
    let csv = dir.path().join("demo.csv");
    let clip = DEMO[0];
    track(&[clip, "--csv", arg(&csv)]);
    let csv = arg(&csv);
    let jitter = ["eval", "jitter", "--csv", csv];
    let json = json_of(&[&jitter[..], &["--clip", clip]].concat());
    let number = |key: &str| json["clips"][0][key].as_f64().unwrap();
    assert!(number("rest_px") < number("jitter_px"));
    // The head is rigid there, so landmarks with little jitter follow the picture.
    let ratio = number("picture_px") / number("jitter_px");
    assert!((0.3..1.5).contains(&ratio), "{json:#}");
    assert!(json_of(&jitter)["clips"][0]["picture_px"].is_null());

    let short = dir.path().join("short.csv");
    let text = std::fs::read_to_string(csv).unwrap();
    let rows: Vec<&str> = text.lines().take(31).collect();
    std::fs::write(&short, rows.join("\n")).unwrap();
    let args = ["eval", "jitter", "--csv", arg(&short), "--clip", clip];
    fails_with(&args, &["120 frames", "30 rows"]);
    let args = ["eval", "jitter", "--csv", csv, "--csv", csv, "--clip", clip];
    fails_with(&args, &["--clip once for every --csv"]);
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
    program()
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
        fails_with(&args.split('\n').collect::<Vec<_>>(), words);
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
        fails_with(&[&["eval", "pose"], args].concat(), words);
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
        &["tracked.csv has no column v0"],
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
    program().args(["eval", "pose"]).assert().code(2);
}

#[test]
fn a_driver_monitor_is_scored() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let (csv, json, events) = (path("t.csv"), path("s.json"), path("events.txt"));
    let monitor = format!("--monitor={}", arg(&events));
    let [clip, truth] = DEMO;
    let preset = ["--monitor-preset", "euro-ncap"];
    track(&[&[clip, &monitor, "--csv", arg(&csv)], &preset[..]].concat());
    let args = ["eval", "monitor", "--truth", truth, "--csv", arg(&csv)];
    let scored = program().args(args).args(["--json", arg(&json)]).assert();
    scored.success();
    let text = std::fs::read_to_string(&json).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["closures"]["false"], 0, "{text}");
    assert!(value["openness_correlation"].as_f64() > Some(0.8), "{text}");
    assert!(value["p80_error"].as_f64() < Some(0.05), "{text}");
    // At another rate, with frames left out.
    let fewer = program()
        .args(args)
        .args(["--fps", "10", "--drop", "0.2"])
        .assert();
    fewer.success();
}
