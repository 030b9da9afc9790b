//! The static library and the header as C and C++ programs meet them.

use crate::common::c::{
    STRICT, arguments, cc, cxx, example, library, make_examples, program, require, succeed,
};
use crate::common::skip::need;
use crate::common::{demo, model, root, scratch, tracker};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

/// A program that compiles where every struct is laid out as in Rust, whose compiler checks the
/// same sizes and offsets in `src/ffi/layout.rs`.
pub fn layouts() -> &'static Path {
    static FILE: LazyLock<PathBuf> = LazyLock::new(write_layouts);
    &FILE
}

fn write_layouts() -> PathBuf {
    let table = xtask::interface::Table::read().expect("src/ffi is read");
    let path = scratch("c").join("layouts.c");
    let text = xtask::interface::layout::c(&table).expect("no padding");
    assert!(text.lines().count() > 150, "all structs are checked");
    std::fs::write(&path, text).expect("target/ is writable");
    path
}

#[test]
fn header_stands_alone_in_c99_and_cpp11() {
    let check = |compiler: &str, language: &[&str]| {
        let mut command = Command::new(compiler);
        command
            .args(language)
            .args(STRICT)
            .args(["-Wpadded", "-fsyntax-only", "-I"]);
        command.arg(root().join("include"));
        succeed(command.arg(root().join("tests/c/alone.c")));
    };
    check(&cc(), &["-std=c99", "-Wstrict-prototypes"]);
    if let Some(cxx) = cxx() {
        check(&cxx, &["-x", "c++", "-std=c++11"]);
    }
}

/// As Microsoft's compiler reads it, in C and C++, with the structs laid out as on every machine.
#[test]
fn header_is_clean_for_windows() {
    if !require("clang") {
        return;
    }
    for file in [root().join("tests/c/alone.c"), layouts().to_path_buf()] {
        for language in [["-x", "c", "-std=c99"], ["-x", "c++", "-std=c++14"]] {
            let mut clang = Command::new("clang");
            clang.args(["--target=x86_64-pc-windows-msvc", "-fms-extensions"]);
            clang.args(["-fms-compatibility", "-ffreestanding", "-fsyntax-only"]);
            clang.args(language).args(STRICT).args(["-Wpadded", "-I"]);
            clang.arg(root().join("include"));
            succeed(clang.arg(&file));
        }
    }
}

#[test]
fn cpp_wrapper_does_what_the_header_says() {
    let Some(cxx) = cxx() else { return };
    for source in ["tests/c/wrapper.cpp", "ffi-examples/head_pose.cpp"] {
        let program = scratch("c").join(Path::new(source).file_stem().expect("a name"));
        let mut compile = Command::new(&cxx);
        compile
            .args(["-std=c++17", "-O1", "-Wconversion", "-fno-exceptions"])
            .args(STRICT);
        compile.arg("-I").arg(root().join("include"));
        compile
            .arg(root().join(source))
            .arg(library())
            .arg("-Wl,--gc-sections");
        succeed(compile.arg("-o").arg(&program));
        let [_, frames, width, height] = arguments();
        let mut run = Command::new(&program);
        if source.starts_with("tests") {
            run.arg(frames);
        } else {
            run.stdin(std::fs::File::open(frames).expect("written above"));
        }
        print!("{}", succeed(run.args([width, height])));
    }
}

/// Programs of tests/c that call every function with right and wrong arguments.
const CALLERS: [&str; 3] = ["api", "monitor", "search"];

/// Compiles one of them with more flags.
fn caller(name: &str, suffix: &str, flags: &[&str]) -> PathBuf {
    let source = format!("tests/c/{name}.c");
    program(&source, &format!("{name}{suffix}"), flags)
}

#[test]
fn every_wrong_call_is_answered() {
    for name in CALLERS {
        let program = caller(name, "", &["-Wpadded"]);
        print!("{}", succeed(Command::new(program).args(arguments())));
    }
}

/// What the programs do, and what the C library does for them: the static library itself is not
/// instrumented.
#[test]
fn every_wrong_call_is_answered_under_sanitizers() {
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let probe = scratch("c").join("probe.c");
    std::fs::write(&probe, "int main(void) { return 0; }\n").expect("target/ is writable");
    let mut compile = Command::new(cc());
    compile
        .args(flags)
        .arg(&probe)
        .arg("-o")
        .arg(scratch("c").join("probe"));
    let runs = compile.output().is_ok_and(|o| o.status.success())
        && Command::new(scratch("c").join("probe"))
            .output()
            .is_ok_and(|o| o.status.success());
    if !need("sanitizers of the C compiler", runs) {
        return;
    }
    for name in CALLERS {
        // Some containers forbid the tracing that leak detection needs.
        let mut command = Command::new(caller(name, "-sanitized", &flags));
        command.env("ASAN_OPTIONS", "detect_leaks=0");
        succeed(command.args(arguments()));
    }
}

/// What goes beyond a block of memory, also in the library, and what depends on memory that was
/// never written.
#[test]
#[ignore = "minutes under valgrind: .ci/nightly"]
fn every_wrong_call_is_answered_under_valgrind() {
    if !require("valgrind") {
        return;
    }
    for name in CALLERS {
        let mut command = Command::new("valgrind");
        command.args(["--quiet", "--error-exitcode=9"]);
        command.arg(caller(name, "-valgrind", &["-g"]));
        succeed(command.args(arguments()));
    }
}

/// Eight hours of three drivers, with drops, sun, passengers and stops.
#[test]
fn a_shift_is_counted_exactly_and_forgotten() {
    let shift = program("tests/c/shift.c", "shift", &[]);
    print!("{}", succeed(&mut Command::new(shift)));
}

/// Two faces, each tracked by its own tracker all the time.
#[test]
fn faces_example_tracks_two_faces() {
    use crate::common::watch::{LARGE, SMALL, picture};
    let program = program("ffi-examples/faces.c", "faces", &[]);
    let frames: Vec<u8> = (0..150)
        .flat_map(|n| picture(demo(), n, &[SMALL, LARGE]))
        .collect();
    let output = y4m(&program, &[Path::new("640"), Path::new("360")], &frames);
    let csv = String::from_utf8(output.stdout).expect("UTF-8");
    let mut seen = [0; 3];
    for row in csv.lines().skip(1) {
        let row: Vec<f32> = row
            .split(',')
            .map(|v| v.parse().expect("a number"))
            .collect();
        let (id, x) = (row[1] as usize, row[3] + row[5] / 2.0);
        // The larger one is found first.
        let expected = [LARGE.at[0], SMALL.at[0]];
        assert!((x - expected[id]).abs() < 30.0, "{row:?}");
        seen[id] += 1;
    }
    assert!(seen[0] > 135 && seen[1] > 75, "{seen:?}");
}

/// Feeds a video to the y4m example.
fn y4m(program: &Path, arguments: &[&Path], video: &[u8]) -> Output {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the example runs");
    let mut stdin = child.stdin.take().expect("a pipe");
    std::thread::scope(|scope| {
        // The program may stop reading early; that shows in its exit status.
        scope.spawn(move || stdin.write_all(video).ok());
        child.wait_with_output().expect("the example ends")
    })
}

#[test]
fn example_answers_as_the_rust_api() {
    let (model, mut tracker) = (model(), tracker(&posewise::Config::default()));
    let clip = demo();
    let path = root().join("models/posewise.posewise");
    let output = y4m(example(), &[&path], &clip.y4m);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let csv = String::from_utf8(output.stdout).expect("UTF-8");
    let mut rows = csv.lines().skip(1);
    for i in 0..clip.luma.len() {
        let result = tracker.step(&model, &clip.frame(i), clip.time_us(i));
        let result = result.expect("in order");
        let row: Vec<&str> = rows.next().expect("a row per frame").split(',').collect();
        assert_eq!(row[0], i.to_string());
        assert_eq!(row[2], format!("{:?}", result.state).to_lowercase());
        let angles = [result.yaw_deg, result.pitch_deg, result.roll_deg];
        let points = result.landmarks.iter();
        let numbers = (angles.into_iter().chain(result.translation_mm))
            .chain([result.confidence])
            .chain(points.clone().map(|p| p.x))
            .chain(points.map(|p| p.y));
        for (column, number) in numbers.enumerate() {
            let c: f32 = row[3 + column].parse().expect("a number");
            // The dist and the test build must not differ by a single bit.
            assert_eq!(
                c.to_bits(),
                number.to_bits(),
                "frame {i}, column {}",
                3 + column
            );
        }
    }
    assert_eq!(rows.next(), None);
}

/// The events of the demo clip, as the Rust API has them.
#[test]
fn driver_example_prints_events() {
    use posewise::Config;
    use posewise::monitor::{Monitor, MonitorConfig, Observation};
    let program = program("ffi-examples/driver.c", "driver", &[]);
    let clip = demo();
    let output = y4m(&program, &[], &clip.y4m);
    let printed = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(output.status.success(), "{printed}");
    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let mut monitor = Monitor::new(&MonitorConfig::default()).expect("defaults");
    let mut lines = printed.lines();
    for i in 0..clip.luma.len() {
        let timestamp_us = clip.time_us(i);
        let result = tracker.step(&model, &clip.frame(i), timestamp_us);
        let result = result.expect("in order");
        let seen = Observation::from(result);
        monitor.update(&seen, timestamp_us).expect("in order");
        while let Some(event) = monitor.events().pop() {
            let name = event.kind.name();
            let expected = format!(
                "{} {name} from {} us for {} us",
                event.timestamp_us, event.start_us, event.duration_us
            );
            let line = lines.next().unwrap_or_default();
            assert!(line.starts_with(&expected), "{line:?} is not {expected:?}");
        }
    }
    let summary = lines.next().unwrap_or_default();
    assert!(
        summary.starts_with(&format!("{} frames, ", clip.luma.len())),
        "{summary}"
    );
    let output = y4m(&program, &[], b"no video");
    assert!(!output.status.success());
}

#[test]
fn example_explains_bad_input() {
    let model = root().join("models/posewise.posewise");
    let missing = root().join("models/missing.posewise");
    let foreign = root().join("Cargo.toml");
    let video = &demo().y4m;
    let cases: [(&Path, &[u8], &str); 6] = [
        (&missing, video, "cannot open"),
        (&foreign, video, "not a .posewise model"),
        (&model, b"", "not an 8-bit y4m video"),
        (&model, b"YUV4MPEG2 W0 H4\n", "not an 8-bit y4m video"),
        (&model, b"YUV4MPEG2 W4 H4 F30:1\n", "no frames"),
        (&model, &video[..video.len() - 1], "truncated or corrupt"),
    ];
    for (model, video, expected) in cases {
        let output = y4m(example(), &[model], video);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains(expected), "{stderr}");
    }
}

#[test]
fn floating_point_environment_does_not_matter() {
    let program = program("tests/c/float_env.c", "float_env", &[]);
    print!("{}", succeed(Command::new(program).args(arguments())));
}

/// Instructions of a tracking step on a face 12 times as large, over those on the face as it is.
/// Only the crops cost more, by 16 reads a pixel: 1.9 times with AVX2, 1.3 times with the kernels
/// that a step of twice the instructions had.
const LARGE_FACE_COST: f64 = 2.0;

#[test]
fn large_faces_cost_little_more() {
    if !require("valgrind") {
        return;
    }
    let program = program("tests/c/large.c", "large", &[]);
    let instructions = |scale: &str| {
        let mut command = Command::new("valgrind");
        command.args(["--tool=callgrind", "--toggle-collect=tracking_step"]);
        command.arg("--callgrind-out-file=/dev/null").arg(&program);
        let output = command.args(arguments()).arg(scale).output();
        let output = output.expect("valgrind runs");
        let (out, notes) = [&output.stdout, &output.stderr]
            .map(|b| String::from_utf8_lossy(b))
            .into();
        assert!(output.status.success(), "{out}{notes}");
        let count = notes
            .lines()
            .find_map(|line| line.split_once("Collected : "));
        count
            .and_then(|(_, n)| n.trim().parse::<f64>().ok())
            .expect("a number")
    };
    let [small, large] = ["1", "12"].map(instructions);
    println!("{small:.0} instructions, {large:.0} with the large face");
    assert!(
        large < LARGE_FACE_COST * small,
        "{:.2} times as much",
        large / small
    );
}

#[test]
fn static_memory_is_enough() {
    let program = program("ffi-examples/static_memory.c", "static_memory", &[]);
    succeed(&mut Command::new(program));
}

#[test]
fn makefile_builds_the_examples() {
    if !require("make") {
        return;
    }
    let linux = cfg!(target_os = "linux").then_some("v4l2");
    let all: Vec<&str> = ["all"].into_iter().chain(linux).collect();
    let target = make_examples(&all);
    for example in ["y4m", "static_memory", "faces", "driver"]
        .into_iter()
        .chain(linux)
    {
        assert!(
            target.join("ffi-examples").join(example).exists(),
            "{example}"
        );
    }
}

#[test]
fn program_of_the_readme_runs() {
    let readme = std::fs::read_to_string(root().join("README.md")).expect("README.md");
    let code = readme
        .split("```c\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let (source, program) = (scratch("c").join("readme.c"), scratch("c").join("readme"));
    std::fs::write(&source, code.expect("a program in C")).expect("target/ is writable");
    let mut compile = Command::new(cc());
    compile
        .arg("-std=c11")
        .args(STRICT)
        .arg("-I")
        .arg(root().join("include"));
    compile.arg(&source).arg(library()).arg("-Wl,--gc-sections");
    succeed(compile.arg("-o").arg(&program));
    succeed(&mut Command::new(&program));
}
