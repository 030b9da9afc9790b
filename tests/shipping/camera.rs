//! What the examples do with cameras. ffi-examples/v4l2.c and driver.c run on a real V4L2 device:
//! vivid, the kernel's virtual camera, in an emulated machine. It shows a test pattern, on which
//! the capture is checked, and then the demo clip.
//!
//! `POSEWISE_KERNEL` names the folder of an unpacked Linux image that has vivid.
#![cfg(target_os = "linux")]

use crate::common::c::{
    STRICT, arguments, cxx, exists, library, make_examples, program, require, succeed,
};
use crate::common::skip::need;
use crate::common::{demo, grey, model, root, scratch, tracker};
use posewise::{Config, State};
use std::path::Path;
use std::process::Command;

/// What one run of the example printed: its frames' lines, what it said, and its exit status.
struct Run {
    /// Timestamp \[µs\] and size.
    frames: Vec<(i64, String)>,
    /// Of the frames, those with a face.
    tracking: usize,
    said: Vec<String>,
    status: i32,
}

/// Cuts the emulated machine's console into runs, by their command lines.
fn runs(console: &str) -> Vec<(String, Run)> {
    let mut runs = Vec::new();
    let mut command = None;
    let (mut frames, mut tracking, mut said) = (Vec::new(), 0, Vec::new());
    for line in console.lines().map(str::trim_end) {
        if let Some(status) = line.strip_prefix("== status ") {
            let run = Run {
                frames: std::mem::take(&mut frames),
                tracking: std::mem::take(&mut tracking),
                said: std::mem::take(&mut said),
                status: status.parse().expect("a status"),
            };
            runs.push((command.take().expect("a command before its status"), run));
        } else if let Some((_, line)) = line.split_once("== ") {
            command = Some(line.to_string());
        } else if let Some(words) = line.strip_prefix("v4l2: ") {
            said.push(words.to_string());
        } else if line.starts_with("driver: ") || line.contains(" frames, ") {
            said.push(line.to_string());
        } else if let [index, time_us, "us", size, state, ..] =
            line.split(' ').collect::<Vec<_>>()[..]
        {
            tracking += usize::from(state == "tracking");
            assert_eq!(index, frames.len().to_string(), "{line}");
            frames.push((time_us.parse().expect("a time"), size.to_string()));
        }
    }
    runs
}

#[test]
#[ignore = "boots an emulated machine: .ci/nightly"]
fn captures_from_a_device() {
    let Some(kernel) = std::env::var_os("POSEWISE_KERNEL") else {
        require("POSEWISE_KERNEL");
        return;
    };
    let programs = ["qemu-system-x86_64", "busybox", "cpio", "sh"];
    if !programs.iter().all(|program| require(program)) {
        return;
    }
    let v4l2 = program("ffi-examples/v4l2.c", "v4l2-static", &["-O2", "-static"]);
    let driver = program(
        "ffi-examples/driver.c",
        "driver-static",
        &["-O2", "-static"],
    );
    let control = program("tests/c/control.c", "control-static", &["-static"]);
    let feed = program("tests/c/feed.c", "feed-static", &["-static"]);
    let face = scratch("camera").join("demo.y4m");
    std::fs::write(&face, &demo().y4m).expect("target/ is writable");
    let mut machine = Command::new(root().join("tests/camera.sh"));
    machine.arg(kernel).arg(v4l2).arg(driver).arg(control);
    machine.arg(feed).arg(face);
    let console = succeed(machine.arg(scratch("camera").join("disk")));
    println!("{console}");
    let runs = runs(&console);
    let run = |command: &str| {
        let found = runs.iter().find(|(line, _)| line == command);
        &found.unwrap_or_else(|| panic!("no run of '{command}'")).1
    };
    for (_, run) in &runs {
        assert!(run.frames.is_sorted_by(|a, b| a.0 < b.0), "times increase");
        assert!(run.frames.iter().all(|(_, size)| size == "640x480"));
    }
    for format in ["GREY", "NV12", "YUYV"] {
        let run = run(&format!("v4l2 /dev/video0 5 {format}"));
        let said = [format!("{format} 640x480"), "5 frames".into()];
        assert_eq!((run.status, run.frames.len()), (0, 5));
        assert_eq!(run.said, said);
    }
    let chosen = run("v4l2 /dev/video0 3");
    assert_eq!((chosen.status, chosen.frames.len()), (0, 3));
    assert_eq!(chosen.said[0], "GREY 640x480", "the cheapest comes first");
    // vivid has no exposure to set; tests/c/exposure.c has the rest.
    let exposed = run("v4l2 /dev/video0 3 - face");
    assert_eq!((exposed.status, exposed.frames.len()), (0, 3));
    assert_eq!(exposed.said[1], "the camera keeps its own exposure");
    for (command, why) in [
        ("v4l2 /dev/video0 3 H264", "no format"),
        ("v4l2 /dev/video9 3", "/dev/video9: No such file"),
    ] {
        let run = run(command);
        assert_eq!(run.status, 1);
        assert!(run.said[0].starts_with(why), "{:?}", run.said);
    }
    let watched = run("driver 0 /dev/video0 5");
    assert_eq!(watched.status, 0);
    assert!(
        watched.said[0].starts_with("5 frames, 0 blinks"),
        "{:?}",
        watched.said
    );
    let missing = run("driver 0 /dev/video9 5");
    assert_eq!(missing.status, 1);
    assert!(missing.said[0].contains("no camera"), "{:?}", missing.said);
    let interrupted = run("interrupt");
    assert_eq!(interrupted.status, 0, "Ctrl-C is a clean end");
    assert!(interrupted.frames.len() >= 3);
    // A buffer that the driver calls spoilt is left out; the next ones are not.
    let spoilt = run("spoil");
    let gaps = spoilt.frames.windows(2).map(|pair| pair[1].0 - pair[0].0);
    let (shortest, longest) = (gaps.clone().min(), gaps.max());
    assert_eq!(spoilt.status, 0);
    assert!(
        longest > shortest.map(|us| us * 3 / 2),
        "a frame is missing"
    );
    let unplugged = run("unplug");
    assert_eq!(unplugged.status, 1);
    assert!(unplugged.frames.len() >= 3);
    assert_eq!(unplugged.said[1], "the camera is gone: No such device");
    // The clip through an output, a scaler and an input: few frames come in time in an emulator,
    // but the face is there.
    let face = run("v4l2 /dev/video1 100 GREY");
    assert_eq!((face.status, face.frames.len()), (0, 100));
    assert!(
        face.tracking >= 50,
        "{} of 100 frames tracked",
        face.tracking
    );
}

#[test]
fn exposes_for_the_face() {
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let test = program("tests/c/exposure.c", "exposure", &flags);
    succeed(Command::new(test).env("ASAN_OPTIONS", "detect_leaks=0"));
}

/// Where Debian has the headers of OpenCV's core.
const OPENCV: &str = "/usr/include/opencv4";

#[test]
#[ignore = "needs OpenCV: .ci/nightly"]
fn a_mat_of_opencv_is_a_frame() {
    let core = Path::new(OPENCV).join("opencv2/core.hpp");
    if !core.exists() {
        require(&core.display().to_string());
        return;
    }
    let Some(cxx) = cxx() else { return };
    let program = scratch("camera").join("cv_mat");
    let mut compile = Command::new(cxx);
    compile.args(["-std=c++17", "-O1"]).args(STRICT);
    compile.arg("-I").arg(root().join("include"));
    compile.args(["-isystem", OPENCV]);
    compile
        .arg(root().join("tests/c/cv_mat.cpp"))
        .arg(library());
    compile.args(["-Wl,--gc-sections", "-lopencv_core", "-o"]);
    succeed(compile.arg(&program));
    let [_, frames, width, height] = arguments();
    print!(
        "{}",
        succeed(Command::new(program).args([frames, width, height]))
    );
}

#[test]
#[ignore = "needs GStreamer: .ci/nightly"]
fn gstreamer_delivers_frames() {
    let mut packages = Command::new("pkg-config");
    packages.args(["--exists", "gstreamer-app-1.0", "gstreamer-video-1.0"]);
    if !packages.status().is_ok_and(|status| status.success()) {
        require("gstreamer-app-1.0");
        return;
    }
    library();
    let target = make_examples(&["gstreamer"]);
    let program = target.join("ffi-examples/gstreamer");
    let [_, frames, width, height] = arguments();
    let parse = format!("rawvideoparse width={width} height={height} format=gray8 framerate=20/1");
    let run = |source: &str| {
        // A pipeline that never ends would stop the tests.
        let mut run = Command::new("timeout");
        run.arg("120").arg(&program).arg(source);
        run.env("GST_REGISTRY", scratch("camera").join("registry"));
        run.output().expect("timeout is there")
    };
    let output = run(&format!("filesrc location={frames} ! {parse}"));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    // The elements are in a package of their own.
    if !need("element of GStreamer", !said.contains("no element")) {
        return;
    }
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}");
    assert_eq!(lines.lines().count(), 60, "{lines}");
    assert!(lines.matches(" tracking yaw").count() >= 50, "{lines}");
    assert_eq!(
        lines
            .lines()
            .nth(1)
            .map(|line| line.starts_with("50000 us ")),
        Some(true)
    );
    for (source, why) in [
        ("none", "no element"),
        ("filesrc location=/none", "not found"),
    ] {
        let output = run(&format!("{source} ! {parse}"));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(why), "{said}");
    }
}

/// Yaw of the frames, as the Rust library tracks them; `None` where there is no face.
fn yaw_of_frames(frames: &Path, width: &str, height: &str) -> Vec<Option<f32>> {
    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let [width, height] = [width, height].map(|text| text.parse::<usize>().expect("a number"));
    let bytes = std::fs::read(frames).expect("the frames");
    let frames = bytes.chunks_exact(width * height);
    let steps = frames.enumerate().map(|(i, luma)| {
        let frame = grey(width, height, luma);
        let time_us = 50_000 * i as i64;
        let result = tracker.step(&model, &frame, time_us).expect("in order");
        (result.state != State::Searching).then_some(result.yaw_deg)
    });
    steps.collect()
}

/// The element's messages have the library's numbers, and frames pass unchanged.
#[test]
#[ignore = "needs GStreamer: .ci/nightly"]
fn gstreamer_element_posts_results() {
    if !require("pkg-config") || !require("gst-launch-1.0") {
        return;
    }
    let mut packages = Command::new("pkg-config");
    packages.args(["--exists", "gstreamer-video-1.0"]);
    if !packages.status().is_ok_and(|status| status.success()) {
        require("gstreamer-video-1.0");
        return;
    }
    library();
    let target = make_examples(&["gst-plugin"]);
    let [_, frames, width, height] = arguments();
    let out = scratch("camera").join("passed.raw");
    let run = |element: &str| {
        let line = format!(
            "filesrc location={frames} ! rawvideoparse width={width} height={height} format=gray8 \
             framerate=20/1 ! {element} ! filesink location={}",
            out.display()
        );
        // A pipeline that never ends would stop the tests.
        let mut run = Command::new("timeout");
        run.args(["120", "gst-launch-1.0", "-m"]);
        run.args(line.split(' ').filter(|word| !word.is_empty()));
        run.env("GST_PLUGIN_PATH", target.join("ffi-examples"));
        run.env("GST_REGISTRY", scratch("camera").join("registry"));
        let output = run.output().expect("timeout is there");
        let [stdout, stderr] = [output.stdout, output.stderr]
            .map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        (output.status.success(), stdout, stderr)
    };
    let (is_well, printed, said) = run("posewise");
    if said.contains("no element \"rawvideoparse") {
        require("rawvideoparse");
        return;
    }
    assert!(is_well, "{said}");
    let messages = printed.lines().filter(|line| line.contains("posewise, "));
    let yaw = messages.map(|line| {
        let value = line.split("yaw=(float)").nth(1)?.split(',').next()?;
        value.parse::<f32>().ok()
    });
    let yaw: Vec<Option<f32>> = yaw.collect();
    assert_eq!(yaw, yaw_of_frames(Path::new(frames), width, height));
    assert!(yaw.iter().flatten().count() >= 50, "{printed}");
    let [before, after] = [Path::new(frames), &out].map(|path| std::fs::read(path).unwrap());
    assert!(before == after, "frames pass unchanged");

    let research = root().join("models/research.posewise");
    let nv12 = "videoconvert ! video/x-raw,format=NV12 ! posewise model";
    let (is_well, printed, said) = run(&format!("{nv12}={}", research.display()));
    assert!(is_well, "{said}");
    assert!(
        printed.matches("state=(string)tracking").count() >= 50,
        "{printed}"
    );
    let (is_well, _, said) = run("posewise model=/none");
    assert!(!is_well && said.contains("/none"), "{said}");
}

#[test]
fn decodes_motion_jpeg() {
    if !require("ffmpeg") {
        return;
    }
    let [_, frames, width, height] = arguments();
    let jpeg = scratch("camera").join("x.jpg");
    let mut encode = Command::new("ffmpeg");
    encode.args([
        "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "gray", "-s",
    ]);
    encode.arg(format!("{width}x{height}")).args(["-i", frames]);
    encode.args(["-frames:v", "1", "-q:v", "2", "-pix_fmt", "yuvj422p"]);
    succeed(encode.arg(&jpeg));
    if !exists("pkg-config")
        || !Command::new("pkg-config")
            .arg("libjpeg")
            .status()
            .is_ok_and(|s| s.success())
    {
        require("libjpeg");
        return;
    }
    let flags = [
        "-DWITH_JPEG",
        "-ljpeg",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ];
    let test = program("tests/c/mjpg.c", "mjpg", &flags);
    let mut test = Command::new(test);
    test.env("ASAN_OPTIONS", "detect_leaks=0").arg(jpeg);
    print!("{}", succeed(test.args([frames, width, height])));
    program(
        "ffi-examples/v4l2.c",
        "v4l2-jpeg",
        &["-DWITH_JPEG", "-ljpeg"],
    );
}
