//! Java by JNI: the class of ffi-examples/jni tracks the demo frames as Rust does.

use super::c::{arguments, succeed};
use super::{demo, model, root, scratch, tracker};
use posewise::Config;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the JDK is that `javac` belongs to.
pub fn jdk() -> PathBuf {
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

/// Tracks the demo frames with the class among `classes`, a folder or a jar, and the shared library
/// that lies in `library`.
pub fn check_demo(library: &Path, classes: &Path) {
    let out = scratch("java");
    let mut javac = Command::new("javac");
    javac.args(["-Xlint:all", "-Werror", "-d"]).arg(&out);
    javac.arg("-cp").arg(classes);
    succeed(javac.arg(root().join("ffi-examples/jni/TrackFile.java")));
    let classpath = format!("{}:{}", out.display(), classes.display());

    let [_, frames, width, height] = arguments();
    let mut java = Command::new("java");
    java.arg("-Xcheck:jni").arg("-cp").arg(&classpath);
    java.arg(format!("-Djava.library.path={}", library.display()));
    java.args(["TrackFile", frames, width, height]);
    let lines = succeed(java.arg(demo().frame_us.to_string()));

    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let mut lines = lines.lines();
    for i in 0..60 {
        let result = tracker.step(&model, &demo().frame(i), demo().time_us(i));
        let result = result.expect("in order");
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
