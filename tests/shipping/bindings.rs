//! The examples for other languages and for ROS 2: Java by JNI tracks the demo frames as Rust does;
//! clang accepts Swift's module map; poses come for images by DDS.

use crate::common::c::{STRICT, arguments, cc, library, make_examples, require, succeed};
use crate::common::java::jdk;
use crate::common::{demo, model, root, scratch, tracker};
use posewise::{Config, State};
use std::process::Command;

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
    succeed(&mut javac);
    crate::common::java::check_demo(&out, &out);
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

/// Head rotations of the demo frames, 20 a second, as the Rust library tracks them.
fn rotations() -> Vec<Option<[f32; 4]>> {
    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let steps = (0..demo().luma.len()).map(|i| {
        let result = tracker.step(&model, &demo().frame(i), 50_000 * i as i64);
        let result = result.expect("in order");
        (result.state != State::Searching).then_some(result.rotation)
    });
    steps.collect()
}

/// The example for ROS 2 gets the demo frames as images and gives their poses, over the loopback
/// interface. The other side is a program of this repository too, not ROS 2.
#[test]
#[ignore = "needs Cyclone DDS: .ci/nightly"]
fn ros2_topics_carry_the_pose() {
    if !require("make") || !require("idlc") {
        return;
    }
    library();
    let (target, out) = (make_examples(&["ros2"]), scratch("ros2"));
    let messages = target.join("ffi-examples/ros2-messages");
    let mut compile = Command::new(cc());
    compile.args(["-std=c99", "-O2"]).args(STRICT);
    compile.arg("-I").arg(&messages);
    compile.arg(root().join("tests/c/ros2.c"));
    compile.arg(messages.join("messages.c"));
    succeed(compile.args(["-lddsc", "-o"]).arg(out.join("feed")));

    let lo = "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces>\
              </General>";
    // A domain of its own; the protocol has 232.
    let domain = (100 + std::process::id() % 100).to_string();
    let at_home = |mut command: Command| {
        command
            .env("CYCLONEDDS_URI", lo)
            .env("ROS_DOMAIN_ID", &domain);
        command
    };
    let mut node = at_home(Command::new(target.join("ffi-examples/ros2")))
        .spawn()
        .expect("it was built");
    let mut feed = at_home(Command::new("timeout"));
    feed.arg("120")
        .arg(out.join("feed"))
        .args(&arguments()[1..]);
    let printed = succeed(&mut feed);
    succeed(Command::new("kill").arg(node.id().to_string()));
    assert!(node.wait().expect("it ends").success());

    let expected = rotations();
    for line in printed.lines() {
        let fields: Vec<&str> = line.split(' ').collect();
        let time_s: f64 = fields[0].parse().expect("a time");
        assert_eq!(fields[1], "camera");
        let rotation = fields[2..]
            .iter()
            .map(|x| x.parse::<f32>().expect("a number"));
        let known = expected[(time_s * 20.0).round() as usize].expect("a face");
        let cosine: f32 = rotation.zip(known).map(|(a, b)| a * b).sum();
        // Half of the angle; an image that was dropped changes the next results a little.
        assert!(cosine.abs() > 0.9999, "{line}: {known:?}");
    }
    assert!(printed.lines().count() >= 50, "{printed}");
}
