//! The examples for other languages: Java by JNI tracks the demo frames as Rust does; clang accepts
//! Swift's module map.

mod common;

use common::c::{STRICT, arguments, cc, clip, library, require, succeed};
use common::{root, scratch};
use posewise::{Config, Frame, FrameLayout, Model, Tracker};
use std::path::PathBuf;
use std::process::Command;

/// Where the JDK is that `javac` belongs to.
fn jdk() -> PathBuf {
    let asked = "java.home = ";
    let mut java = Command::new("java");
    let output = java
        .args(["-XshowSettings:properties", "-version"])
        .output();
    let said = String::from_utf8(output.expect("java runs").stderr).expect("UTF-8");
    let home = said
        .lines()
        .find_map(|line| line.trim().strip_prefix(asked));
    home.expect("java prints its home").into()
}

#[test]
fn java_tracks_the_demo() {
    if !require("javac") || !require("java") || !cfg!(target_os = "linux") {
        return;
    }
    let (source, out) = (root().join("ffi-examples/jni"), scratch("jni"));
    let mut compile = Command::new(cc());
    compile
        .args(["-std=c99", "-O2", "-shared", "-fPIC"])
        .args(STRICT);
    compile.arg("-I").arg(root().join("include"));
    compile.arg("-I").arg(jdk().join("include"));
    compile.arg("-I").arg(jdk().join("include/linux"));
    compile.arg(source.join("posewise_jni.c")).arg(library());
    compile.args(["-Wl,--gc-sections", "-Wl,--exclude-libs,ALL", "-o"]);
    succeed(compile.arg(out.join("libposewise_jni.so")));
    let mut javac = Command::new("javac");
    javac.args(["-Xlint:all", "-Werror", "-d"]).arg(&out);
    javac.arg(source.join("dev/posewise/Tracker.java"));
    succeed(javac.arg(source.join("TrackFile.java")));

    let [_, frames, width, height] = arguments();
    let mut java = Command::new("java");
    java.arg("-Xcheck:jni").arg("-cp").arg(&out);
    java.arg(format!("-Djava.library.path={}", out.display()));
    java.args(["TrackFile", frames, width, height]);
    let lines = succeed(java.arg(clip().frame_us.to_string()));

    let model = Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let mut tracker = Box::new(Tracker::new(&Config::default()).expect("defaults"));
    let layout = FrameLayout::grey(clip().width as u32, clip().height as u32);
    let mut lines = lines.lines();
    for (i, luma) in clip().luma.iter().take(60).enumerate() {
        let frame = Frame::new(&layout, luma).expect("a frame");
        let time_us = (i as f64 * clip().frame_us) as i64;
        let result = tracker.step(&model, &frame, time_us).expect("in order");
        let line = lines.next().expect("a line per frame");
        let numbers: Vec<f32> = line
            .split(' ')
            .map(|word| word.parse().expect("a number"))
            .collect();
        let expected = [
            i as f32,
            result.state as u8 as f32,
            result.yaw_deg,
            result.pitch_deg,
            result.roll_deg,
            result.landmarks[30].x,
            result.landmarks[30].y,
        ];
        assert_eq!(numbers, expected, "frame {i}");
    }
    assert_eq!(lines.next(), None);
}

#[test]
fn swift_can_import_it() {
    if !require("clang") {
        return;
    }
    let source = scratch("swift").join("import.m");
    let text = "@import posewise;\nint main(void) { return posewise_abi() != POSEWISE_ABI; }\n";
    std::fs::write(&source, text).expect("target/ is writable");
    let map = root().join("ffi-examples/swift/module.modulemap");
    let mut clang = Command::new("clang");
    clang.args(["-fmodules", "-fsyntax-only", "-Wall", "-Werror"]);
    clang.arg(format!("-fmodule-map-file={}", map.display()));
    clang.arg(format!(
        "-fmodules-cache-path={}",
        scratch("swift/cache").display()
    ));
    succeed(clang.arg(source));
}
