//! `posewise track` from the outside: inputs, outputs, bad inputs.

use crate::common::{arg, csv, fails_with, gradient_clip, has_program, posewise};
use std::io::Write;

#[test]
fn y4m_file_gzip_and_pipe_agree() {
    let dir = tempfile::tempdir().unwrap();
    let clip = gradient_clip(64, 48, 5);
    let plain = dir.path().join("clip.y4m");
    std::fs::write(&plain, &clip).unwrap();
    let zipped = dir.path().join("clip.y4m.gz");
    let file = std::fs::File::create(&zipped).unwrap();
    let mut gz = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    gz.write_all(&clip).unwrap();
    gz.finish().unwrap();

    let table = csv(arg(&plain), b"");
    assert_eq!(table.lines().count(), 6);
    let row: Vec<&str> = table.lines().nth(2).unwrap().split(',').collect();
    assert_eq!(row[..3], ["2", "0", "0.040000"]);
    assert_eq!(csv(arg(&zipped), b""), table);
    assert_eq!(csv("-", &clip), table);
    assert_eq!(csv("-", &std::fs::read(&zipped).unwrap()), table);
}

#[test]
fn a_picture_alone_is_a_frame_however_often_it_is_searched() {
    let dir = tempfile::tempdir().unwrap();
    let (picture, csv) = ("a.png", "t.csv");
    let path = |name: &str| dir.path().join(name);
    image::RgbImage::from_pixel(40, 30, image::Rgb([90; 3]))
        .save(path(picture))
        .unwrap();
    let run = posewise()
        .args(["track", arg(&path(picture)), "--csv", arg(&path(csv))])
        .assert()
        .success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    assert!(said.contains("frames   1"), "{said}");
    let table = std::fs::read_to_string(path(csv)).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 1, "{table}");
    assert!(rows[0].starts_with("1,0,0.000000,"), "{table}");
}

#[test]
fn pictures_in_order_of_name_and_all_outputs() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["b.png", "a.jpg", "c.ppm"] {
        image::RgbImage::from_pixel(40, 30, image::Rgb([90; 3]))
            .save(dir.path().join(name))
            .unwrap();
    }
    std::fs::write(dir.path().join("notes.txt"), "no picture").unwrap();
    let out = |name: &str| dir.path().join("out").join(name);
    std::fs::create_dir(dir.path().join("out")).unwrap();
    let run = posewise()
        .args(["track", arg(dir.path()), "--fps", "10", "--rotate", "90"])
        .args(["--csv", arg(&out("t.csv")), "--jsonl", arg(&out("t.jsonl"))])
        .args(["--overlay", arg(&out("png")), "--plot", arg(&out("t.svg"))])
        .assert()
        .success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    assert!(said.contains("frames   3"), "{said}");
    let lines = std::fs::read_to_string(out("t.jsonl")).unwrap();
    let last: serde_json::Value = serde_json::from_str(lines.lines().last().unwrap()).unwrap();
    assert_eq!(
        (&last["frame"], &last["timestamp_us"]),
        (&3.into(), &200_000.into())
    );
    assert_eq!(last["landmarks"].as_array().unwrap().len(), 68);
    let overlay = image::open(out("png").join("000003.png")).unwrap();
    assert_eq!(
        (overlay.width(), overlay.height()),
        (30, 40),
        "turned upright"
    );
    assert!(
        std::fs::read_to_string(out("t.svg"))
            .unwrap()
            .contains("<svg")
    );

    let pattern = format!("{}/[ab].*", arg(dir.path()));
    let run = posewise().args(["track", &pattern]).assert().success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    assert!(said.contains("frames   2"), "{said}");
}

#[test]
fn bad_inputs_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = dir.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_string()
    };
    let none = Vec::new;
    fails_with(
        &["track", "nowhere.mp4"],
        none(),
        &["no such file", "nowhere.mp4"],
    );
    fails_with(
        &["track", "-"],
        b"not a video".to_vec(),
        &["standard input", "not a y4m"],
    );
    fails_with(&["track", "-"], none(), &["standard input", "empty"]);
    let clip = gradient_clip(32, 32, 2);
    fails_with(
        &["track", "-"],
        clip[..clip.len() - 9].to_vec(),
        &["ends inside frame 2"],
    );
    fails_with(
        &["track", &file("empty.mp4", b"")],
        none(),
        &["empty.mp4", "is empty"],
    );
    fails_with(
        &["track", &file("bad.y4m", b"RIFF")],
        none(),
        &["bad.y4m", "not a y4m"],
    );
    fails_with(
        &["track", &file("bad.gz.y4m", b"\x1f\x8bjunk")],
        none(),
        &["bad.gz.y4m"],
    );
    fails_with(
        &["track", &file("bad.png", b"no picture")],
        none(),
        &["decode", "bad.png"],
    );
    let empty = dir.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    fails_with(&["track", arg(&empty)], none(), &["has no pictures"]);
    fails_with(
        &["track", &format!("{}/*.png", arg(&empty))],
        none(),
        &["has no pictures"],
    );
    if cfg!(target_os = "linux") {
        fails_with(
            &["track", "/dev/video999"],
            none(),
            &["camera", "/dev/video999"],
        );
    }
    let good = file("good.y4m", &clip);
    fails_with(
        &["track", &good, "--plot", "x.gif"],
        none(),
        &[".svg or .png"],
    );
    fails_with(
        &["track", &good, "--csv", "/no/such/dir/x.csv"],
        none(),
        &["cannot write"],
    );
    fails_with(
        &["track", &good, "--overlay", "/no/such/dir/x.y4m"],
        none(),
        &["cannot write"],
    );
    posewise()
        .args(["track", &good, "--rotate", "45"])
        .assert()
        .code(2);
    posewise().args(["track"]).assert().code(2);
}

#[test]
fn what_was_tracked_before_the_input_broke_is_kept() {
    let dir = tempfile::tempdir().unwrap();
    let csv = dir.path().join("t.csv");
    let clip = gradient_clip(32, 32, 4);
    let cut = clip[..clip.len() - 100].to_vec();
    fails_with(
        &["track", "-", "--csv", arg(&csv)],
        cut,
        &["ends inside frame 4"],
    );
    assert_eq!(std::fs::read_to_string(csv).unwrap().lines().count(), 4);
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("posewise"))
        .args(["track", "-", "--csv", "-", "--quiet"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut stdin = child.stdin.take().unwrap();
    // The command may end before it has read everything.
    let _ = stdin.write_all(&gradient_clip(32, 32, 300));
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(!said.contains("panicked"), "{said}");
}

#[test]
fn videos_go_through_ffmpeg_both_ways() {
    if !has_program("ffmpeg") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let clip = dir.path().join("clip.y4m");
    std::fs::write(&clip, gradient_clip(65, 49, 10)).unwrap();
    let video = dir.path().join("overlay.mp4");
    posewise()
        .args(["track", arg(&clip), "--overlay", arg(&video)])
        .assert()
        .success();
    let run = posewise().args(["track", arg(&video)]).assert().success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    assert!(said.contains("frames   10"), "{said}");

    let bytes = std::fs::read(&video).unwrap();
    let cut = dir.path().join("cut.mp4");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    fails_with(&["track", arg(&cut)], Vec::new(), &["cut.mp4"]);
    let foreign = dir.path().join("foreign.mp4");
    std::fs::write(&foreign, b"this is no video").unwrap();
    fails_with(
        &["track", arg(&foreign)],
        Vec::new(),
        &["cannot decode", "foreign.mp4"],
    );
    let unknown = dir.path().join("overlay.nonsense");
    let args = ["track", arg(&clip), "--overlay", arg(&unknown)];
    fails_with(&args, Vec::new(), &["overlay.nonsense", "ffmpeg"]);
}

#[test]
fn a_missing_ffmpeg_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let video = dir.path().join("clip.mp4");
    std::fs::write(&video, b"whatever").unwrap();
    let run = posewise()
        .args(["track", arg(&video)])
        .env("PATH", dir.path())
        .assert()
        .code(1);
    let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(said.contains("`ffmpeg` is needed"), "{said}");
}

#[test]
fn a_region_of_interest_is_checked_and_used() {
    let clip = gradient_clip(64, 48, 2);
    let run = |roi: &str| {
        let run = posewise()
            .args(["track", "-", "--quiet", "--roi", roi])
            .write_stdin(clip.clone())
            .assert();
        let output = run.get_output();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said)
    };
    assert_eq!(run("0,0,64,48"), (Some(0), String::new()));
    for (roi, status, word) in [
        ("1,0,64,48", 1, "64×48 px"),
        ("0,0,0,48", 2, "at least 1 px"),
        ("0,0,9", 2, "X,Y,W,H"),
        ("-1,0,9,9", 2, "X,Y,W,H"),
    ] {
        let (code, said) = run(roi);
        assert_eq!(code, Some(status), "{roi}: {said}");
        assert!(
            said.contains("--roi") && said.contains(word),
            "{roi}: {said}"
        );
    }
}

#[test]
fn the_log_has_what_happens_to_the_face() {
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz");
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("log.txt");
    let log = |option: &str| {
        let run = posewise()
            .args(["track", demo, "--frames", "5", option])
            .assert()
            .success();
        String::from_utf8_lossy(&run.get_output().stderr).into_owned()
    };
    let on_stderr = log("--log");
    assert_eq!(on_stderr.lines().count(), 1, "{on_stderr}");
    assert!(
        on_stderr.contains(" s  acquired  confidence "),
        "{on_stderr}"
    );
    assert_eq!(log(&format!("--log={}", arg(&file))), "");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), on_stderr);
}

#[test]
fn a_calibration_is_read_and_checked() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("camera.yml");
    let k = "%YAML:1.0\n---\nK: [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]\n";
    let run = |text: &str, more: &[&str]| {
        std::fs::write(&file, text).unwrap();
        let run = posewise()
            .args(["track", "-", "--quiet", "--calibration", arg(&file)])
            .args(more)
            .write_stdin(gradient_clip(64, 48, 2))
            .assert();
        let output = run.get_output();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said)
    };
    let lens = format!("{k}D: [-0.2, 0.05, 0.001, 0, 0]\n");
    let sized = format!("{k}image_width: 64\nimage_height: 64\n");
    assert_eq!(run(&lens, &[]), (Some(0), String::new()));
    assert_eq!(run(&lens, &["--fisheye"]).0, Some(1));
    for (text, more, status, word) in [
        (&lens[..], &["--rotate", "90"][..], 1, "upright"),
        (&lens, &["--focal", "60"], 2, "--focal"),
        (&sized, &[], 1, "64×64 px"),
        ("D: [0]", &[], 1, "camera_matrix"),
    ] {
        let (code, said) = run(text, more);
        assert_eq!(code, Some(status), "{said}");
        assert!(said.contains(word), "{said}");
    }
}

/// A wrong value is a wrong command line: exit code 2, and the option is named.
#[test]
fn wrong_values_exit_with_2_and_name_the_option() {
    for (option, value) in [
        ("--focal", "0.5"),
        ("--focal", "nan"),
        ("--focal", "0"),
        ("--min-face", "2"),
        ("--min-face", "5000"),
        ("--scan-budget", "0"),
        ("--scan-budget", "1"),
        ("--fps", "0"),
        ("--fps", "1000001"),
        ("--rotate", "45"),
        ("--overlay-style", "points,lines"),
    ] {
        let run = posewise().args(["track", "-", option, value]).assert();
        let output = run.get_output();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{option} {value}: {said}");
        assert!(said.contains(option) && !said.contains("..="), "{said}");
    }
}

/// The header of a PNG of 100,000 × 100,000 px, and nothing else.
#[test]
fn a_picture_of_absurd_size_is_refused_before_it_is_decoded() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("huge.png");
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    let header = [100_000u32.to_be_bytes(), 100_000u32.to_be_bytes()].concat();
    bytes.extend(&header);
    bytes.extend([8, 0, 0, 0, 0]);
    let mut crc = flate2::Crc::new();
    crc.update(&bytes[12..]);
    bytes.extend(crc.sum().to_be_bytes());
    bytes.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    std::fs::write(&path, bytes).unwrap();
    let words = ["huge.png", "100000×100000", "128000000"];
    fails_with(&["track", arg(&path)], Vec::new(), &words);
}

/// A chunk of a PNG: its length, name, content and checksum.
fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut crc = flate2::Crc::new();
    crc.update(name);
    crc.update(content);
    let length = (content.len() as u32).to_be_bytes();
    [&length[..], name, content, &crc.sum().to_be_bytes()].concat()
}

/// What describes the colours takes no more memory than the picture may.
#[cfg(unix)]
#[test]
fn a_colour_profile_that_unpacks_to_much_is_refused() {
    use std::io::Write;
    let packed = |bytes: &mut dyn std::io::Read| {
        let mut out = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::copy(bytes, &mut out).unwrap();
        out.flush().unwrap();
        out.finish().unwrap()
    };
    let zeros = |count| std::io::Read::take(std::io::repeat(0), count);
    let header = [0, 0, 0, 8, 0, 0, 0, 8, 8, 0, 0, 0, 0];
    let profile = [b"x\0\0", &packed(&mut zeros(256 << 20))[..]].concat();
    let png = [
        &b"\x89PNG\r\n\x1a\n"[..],
        &chunk(b"IHDR", &header),
        &chunk(b"iCCP", &profile),
        &chunk(b"IDAT", &packed(&mut zeros(8 * 9))),
        &chunk(b"IEND", &[]),
    ];
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("bomb.png");
    std::fs::write(&path, png.concat()).unwrap();
    // 380 MB of addresses; unpacked, the profile is copied and takes more.
    let run = crate::common::limited("-v 380000")
        .args(["track", arg(&path), "--csv", "-"])
        .assert();
    let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(
        matches!(run.get_output().status.code(), Some(0 | 1)),
        "{said}"
    );
}
