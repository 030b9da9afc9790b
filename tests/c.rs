//! The static library and the header as a C program meets them.
//!
//! Builds the library as it ships (`--profile dist`) in a folder of its own under target/, so that
//! the cargo that runs this test and the one that this test runs do not wait for each other.

mod common;
#[path = "../src/ffi/types.rs"]
#[allow(dead_code, missing_docs, non_camel_case_types)]
mod types;

use common::{Clip, root, scratch};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// Peak stack of one call \[bytes\]; twice what a Cortex-M board should spare, but no more.
const STACK_LIMIT: usize = 64 * 1024;

/// `POSEWISE_MEMORY_SIZE` may exceed the true need by this factor, no more: it is what a C program
/// sets aside. Below the floor it does not matter.
const MEMORY_SLACK: f64 = 1.15;
const MEMORY_FLOOR: usize = 64 * 1024;

const STRICT: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

fn cc() -> String {
    std::env::var("CC").unwrap_or("cc".into())
}

fn output(command: &mut Command) -> Output {
    command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

fn succeed(command: &mut Command) -> String {
    let output = output(command);
    let stdout = String::from_utf8_lossy(&output.stdout).into_owned();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{stdout}{stderr}");
    stdout
}

/// The C++ compiler, if there is one.
fn cxx() -> Option<String> {
    let cxx = std::env::var("CXX").unwrap_or("c++".into());
    if exists(&cxx) {
        return Some(cxx);
    }
    eprintln!("skipped for C++: no {cxx}");
    None
}

fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// The static library, built once.
fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let target = scratch("dist");
        let mut cargo = Command::new(env!("CARGO"));
        cargo.current_dir(root());
        cargo.args(["rustc", "--quiet", "--profile", "dist", "--lib"]);
        cargo.args([
            "--features",
            "ffi,panic-handler",
            "--crate-type",
            "staticlib",
        ]);
        succeed(cargo.arg("--target-dir").arg(&target));
        target.join("dist/libposewise.a")
    })
}

/// Compiles one C file against the library.
fn program(source: &str, name: &str, flags: &[&str]) -> PathBuf {
    let program = scratch("c").join(name);
    let mut command = Command::new(cc());
    command
        .args(["-std=c99", "-O1", "-g"])
        .args(STRICT)
        .args(flags);
    command.arg("-I").arg(root().join("include"));
    command.arg(root().join(source)).arg(library());
    command
        .args(["-Wl,--gc-sections", "-lm", "-o"])
        .arg(&program);
    succeed(&mut command);
    program
}

/// The demo clip, or the disc where it is not there yet.
fn clip() -> &'static Clip {
    static CLIP: OnceLock<Clip> = OnceLock::new();
    CLIP.get_or_init(|| common::demo().unwrap_or_else(common::disc))
}

/// Arguments of the C tests: model, raw frames, width, height.
fn arguments() -> &'static [String; 4] {
    static ARGUMENTS: OnceLock<[String; 4]> = OnceLock::new();
    ARGUMENTS.get_or_init(|| {
        let clip = clip();
        // Enough to find the face, track it and be done under sanitizers.
        let frames: Vec<u8> = clip.luma.iter().take(60).flatten().copied().collect();
        let path = scratch("c").join("frames.raw");
        std::fs::write(&path, frames).expect("target/ is writable");
        [
            root().join("models/default.posewise").display().to_string(),
            path.display().to_string(),
            clip.width.to_string(),
            clip.height.to_string(),
        ]
    })
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

#[test]
fn layouts_agree() {
    use types::*;
    let mut rust = String::new();
    macro_rules! layout {
        ($name:ident: $($field:ident)+) => {
            rust += &format!("{} {}\n", stringify!($name), size_of::<$name>());
            $(rust += &format!("{}.{} {}\n", stringify!($name), stringify!($field),
                std::mem::offset_of!($name, $field));)+
        };
    }
    layout!(posewise_intrinsics: fx fy cx cy);
    layout!(posewise_config: struct_size flags min_face_px scan_budget intrinsics);
    layout!(posewise_frame: struct_size format timestamp_us width height stride rotation_deg flags
        reserved data_len data);
    layout!(posewise_result: struct_size state timestamp_us age_us landmark_count score face_box
        rotation yaw_deg pitch_deg roll_deg translation_mm eye_open);
    layout!(posewise_landmark: x y confidence visibility x_mm y_mm z_mm);
    let c = succeed(&mut Command::new(program(
        "tests/c/layout.c",
        "layout",
        &["-Wpadded"],
    )));
    assert_eq!(c, rust, "C at the left");
}

#[test]
fn every_wrong_call_is_answered() {
    let api = program("tests/c/api.c", "api", &["-Wpadded"]);
    print!("{}", succeed(Command::new(api).args(arguments())));
}

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
    if !runs {
        eprintln!("skipped: {} has no sanitizers", cc());
        return;
    }
    let api = program("tests/c/api.c", "api-sanitized", &flags);
    // Some containers forbid the tracing that leak detection needs.
    let mut command = Command::new(api);
    succeed(
        command
            .args(arguments())
            .env("ASAN_OPTIONS", "detect_leaks=0"),
    );
}

#[test]
fn stack_and_memory_are_bounded() {
    let stack = program("tests/c/stack.c", "stack", &["-pthread"]);
    let printed = succeed(Command::new(stack).args(arguments()));
    println!("{printed}");
    let figure = |name: &str| -> usize {
        let line = printed.lines().find_map(|line| line.strip_prefix(name));
        line.and_then(|n| n.trim().parse().ok()).expect("a figure")
    };
    for call in ["init", "step"] {
        let used = figure(call);
        assert!(
            used <= STACK_LIMIT,
            "posewise_{call} uses {used} bytes of stack"
        );
    }
    let (need, stated) = (figure("memory"), types::POSEWISE_MEMORY_SIZE as usize);
    assert!(need <= stated);
    assert!(
        need < MEMORY_FLOOR || stated as f64 <= need as f64 * MEMORY_SLACK,
        "POSEWISE_MEMORY_SIZE is {stated}, a tracker needs {need}: lower it in ffi/types.rs"
    );
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

fn example() -> &'static Path {
    static EXAMPLE: OnceLock<PathBuf> = OnceLock::new();
    EXAMPLE.get_or_init(|| program("ffi-examples/y4m.c", "y4m", &[]))
}

#[test]
fn example_answers_as_the_rust_api() {
    use posewise::image::{Frame, FrameLayout};
    let bytes = posewise::DEFAULT_MODEL;
    let model = posewise::track::Model::load(bytes).expect("the default model is valid");
    let config = posewise::track::Config::default();
    let mut tracker = Box::new(posewise::track::Tracker::new(&config).expect("defaults"));
    let clip = clip();
    let path = root().join("models/default.posewise");
    let output = y4m(example(), &[&path], &clip.y4m);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let csv = String::from_utf8(output.stdout).expect("UTF-8");
    let mut rows = csv.lines().skip(1);
    let layout = FrameLayout::grey(clip.width as u32, clip.height as u32);
    for (i, luma) in clip.luma.iter().enumerate() {
        let frame = Frame::new(&layout, luma).expect("a frame");
        let timestamp_us = (i as f64 * clip.frame_us) as i64;
        let result = tracker
            .step(&model, &frame, timestamp_us)
            .expect("in order");
        let row: Vec<&str> = rows.next().expect("a row per frame").split(',').collect();
        assert_eq!(row[0], i.to_string());
        assert_eq!(row[2], format!("{:?}", result.state).to_lowercase());
        let angles = [result.yaw_deg, result.pitch_deg, result.roll_deg];
        let points = result.landmarks.iter();
        let numbers = (angles.into_iter().chain(result.translation_mm))
            .chain([result.score])
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

#[test]
fn example_explains_bad_input() {
    let model = root().join("models/default.posewise");
    let missing = root().join("models/missing.posewise");
    let foreign = root().join("Cargo.toml");
    let video = &clip().y4m;
    let cases: [(&Path, &[u8], &str); 6] = [
        (&missing, video, "cannot open"),
        (&foreign, video, "not a .posewise model"),
        (&model, b"", "not an 8-bit y4m video"),
        (&model, b"YUV4MPEG2 W0 H4\n", "not an 8-bit y4m video"),
        (&model, b"YUV4MPEG2 W4 H4 F30:1\n", "no frames"),
        (&model, &video[..video.len() - 1], "cut or corrupt"),
    ];
    for (model, video, expected) in cases {
        let output = y4m(example(), &[model], video);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains(expected), "{stderr}");
    }
}

#[test]
fn static_memory_is_enough() {
    let program = program("ffi-examples/static_memory.c", "static_memory", &[]);
    succeed(&mut Command::new(program));
}

#[test]
fn makefile_builds_the_examples() {
    if !exists("make") {
        eprintln!("skipped: no make");
        return;
    }
    let target = library().ancestors().nth(2).expect("the target folder");
    let mut make = Command::new("make");
    make.arg("-C").arg(root().join("ffi-examples"));
    make.arg(format!("TARGET_DIR={}", target.display()));
    succeed(make.arg("CFLAGS=-O2 -Werror"));
    for example in ["y4m", "static_memory"] {
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

/// Names in a linked program that belong to the panic machinery.
fn panics(program: &Path) -> Vec<String> {
    let names = succeed(Command::new("nm").arg(program));
    let names = names.lines().filter(|line| line.contains("panicking"));
    names.map(String::from).collect()
}

#[test]
fn nothing_panics() {
    if !exists("nm") {
        eprintln!("skipped: no nm");
        return;
    }
    // The control shows that a panic would be seen.
    let folder = scratch("control");
    let (rust, c) = (folder.join("control.rs"), folder.join("control.c"));
    let (library, program) = (folder.join("libcontrol.a"), folder.join("control"));
    std::fs::write(&rust, CONTROL_RUST).expect("target/ is writable");
    std::fs::write(&c, CONTROL_C).expect("target/ is writable");
    let mut rustc = Command::new(std::env::var("RUSTC").unwrap_or("rustc".into()));
    rustc.args(["--edition=2024", "--crate-type=staticlib", "-Cpanic=abort"]);
    rustc
        .args(["-Copt-level=3", "-Clto=fat", "-o"])
        .arg(&library);
    succeed(rustc.arg(&rust));
    let mut link = Command::new(cc());
    link.arg(&c).arg(&library).arg("-Wl,--gc-sections");
    succeed(link.arg("-o").arg(&program));
    assert!(!panics(&program).is_empty(), "the control panics");

    let panics = panics(example());
    assert!(
        panics.is_empty(),
        "the library can panic:\n{}",
        panics.join("\n")
    );
}

const CONTROL_RUST: &str = r#"#![no_std]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! { loop {} }
#[unsafe(no_mangle)]
pub extern "C" fn control(n: usize) -> u8 {
    static VALUES: [u8; 4] = [1, 2, 3, 4];
    VALUES[n]
}
"#;

const CONTROL_C: &str = "#include <stddef.h>
unsigned char control(size_t);
int main(int argc, char **argv) { return control((size_t)argc) + (argv == 0); }
";

#[test]
fn nothing_is_asked_of_the_system() {
    if !exists("nm") {
        eprintln!("skipped: no nm");
        return;
    }
    // One relocatable object of everything reachable from the header's functions.
    let whole = scratch("c").join("whole.o");
    let mut link = Command::new(cc());
    link.args(["-r", "-nostdlib", "-Wl,--gc-sections"]);
    for name in exported() {
        link.arg(format!("-Wl,-u,{name},--gc-keep-exported"));
    }
    succeed(link.arg(library()).arg("-o").arg(&whole));
    let undefined = succeed(Command::new("nm").arg("-u").arg(&whole));
    let names = undefined
        .lines()
        .map(|line| line.trim().trim_start_matches("U "));
    // What every C compiler, freestanding too, may ask for.
    let allowed = [
        "memcpy",
        "memmove",
        "memset",
        "memcmp",
        "bcmp",
        "_GLOBAL_OFFSET_TABLE_",
    ];
    let unexpected: Vec<_> = names.filter(|name| !allowed.contains(name)).collect();
    assert!(unexpected.is_empty(), "{unexpected:?}");
}

/// The functions that the header declares.
fn exported() -> Vec<String> {
    let header = std::fs::read_to_string(root().join("include/posewise.h")).expect("posewise.h");
    let lines = header.lines().filter(|line| !line.starts_with("//"));
    let names = lines.filter_map(|line| {
        let before = line.split_once('(')?.0;
        let name = before.rsplit([' ', '*']).next()?;
        (before.contains(' ') && name.starts_with("posewise_")).then(|| name.to_string())
    });
    names.collect()
}
