//! The Rust examples run on the demo clip.

use crate::common::c::succeed;
use crate::common::{demo, scratch};
use std::path::PathBuf;
use std::process::Command;

/// An example. `cargo test` builds all of them, `cargo test --test shipping` none.
fn example(name: &str) -> Command {
    let test = std::env::current_exe().expect("the path of this test");
    let built = test.ancestors().nth(2).expect("a build folder");
    let path = built.join("examples").join(name);
    let path = path.with_extension(std::env::consts::EXE_EXTENSION);
    assert!(path.exists(), "first: cargo build --release --examples");
    Command::new(path)
}

fn write(name: &str, bytes: &[u8]) -> PathBuf {
    let path = scratch("examples").join(name);
    std::fs::write(&path, bytes).expect("target/ is writable");
    path
}

#[test]
fn picture_prints_pose_and_landmarks() {
    let clip = demo();
    let header = format!("P5 {} {} 255\n", clip.width, clip.height);
    let face = write("face.pgm", &[header.as_bytes(), &clip.luma[0]].concat());
    let printed = succeed(example("picture").arg(face));
    assert!(printed.starts_with("yaw "), "{printed}");
    assert_eq!(printed.matches("landmark ").count(), posewise::LANDMARKS);

    let grey = write("grey.pgm", &[header.as_bytes(), &[128; 320 * 240]].concat());
    let output = example("picture").arg(grey).output().expect("it runs");
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && printed.contains("no face found"));
}

#[test]
fn video_prints_a_line_per_frame() {
    let clip = demo();
    let video = write("demo.y4m", &clip.y4m);
    let from_file = succeed(example("video").arg(&video));
    assert_eq!(from_file.lines().count(), clip.luma.len());
    assert!(from_file.matches("yaw ").count() * 10 > clip.luma.len() * 9);

    let video = std::fs::File::open(video).expect("just written");
    let from_stdin = succeed(example("video").stdin(video));
    assert_eq!(from_stdin, from_file);
}
