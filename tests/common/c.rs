//! Compiling C against the static library as `make` builds it, and the built command. The library
//! is built in its own folder under target/, so that the cargo that runs the tests and the one that
//! they run do not wait for each other.

use super::skip::{need, skipped};
use super::{demo, root, scratch};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// Warnings that must not come up.
pub const STRICT: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// The C compiler.
pub fn cc() -> String {
    std::env::var("CC").unwrap_or("cc".into())
}

fn output(command: &mut Command) -> Output {
    command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

/// Standard output of a command that must succeed.
pub fn succeed(command: &mut Command) -> String {
    let output = output(command);
    let stdout = String::from_utf8_lossy(&output.stdout).into_owned();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{stdout}{stderr}");
    stdout
}

/// The C++ compiler, if there is one.
pub fn cxx() -> Option<String> {
    let cxx = std::env::var("CXX").unwrap_or("c++".into());
    if exists(&cxx) {
        return Some(cxx);
    }
    skipped(&format!("C++ compiler {cxx}"));
    None
}

/// Whether a program can be started.
pub fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// Whether a program is there; without it the test is skipped.
pub fn require(program: &str) -> bool {
    need(program, exists(program))
}

/// Builds these targets of the examples' Makefile; cargo's build folder that they lie below.
pub fn make_examples(targets: &[&str]) -> PathBuf {
    let target = scratch("dist");
    let mut make = Command::new("make");
    make.arg("-C").arg(root().join("ffi-examples"));
    make.arg(format!("TARGET_DIR={}", target.display()));
    succeed(make.args(targets).arg("CFLAGS=-O2 -Werror"));
    target
}

/// The static library, built once: by make, or by cargo alone where there is no make.
pub fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let target = scratch("dist");
        if exists("make") {
            let mut make = Command::new("make");
            make.args(["--silent", "lib", "-C"]).arg(root());
            succeed(make.arg(format!("TARGET_DIR={}", target.display())));
            return target.join("dist/lib/libposewise.a");
        }
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

/// The `posewise` command, as the tests of the whole workspace have built it: a test among what is
/// asked for makes cargo choose the same features.
pub fn command() -> &'static Path {
    static COMMAND: OnceLock<PathBuf> = OnceLock::new();
    COMMAND.get_or_init(|| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--quiet", "--release", "--workspace"]);
        cargo.args(["--bin", "posewise", "--test", "skipped"]);
        succeed(cargo.current_dir(root()));
        let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
        tmp.with_file_name("release").join("posewise")
    })
}

/// Compiles one C file against the library; `-l…` among the flags are further libraries.
pub fn program(source: &str, name: &str, flags: &[&str]) -> PathBuf {
    let program = scratch("c").join(name);
    let mut command = Command::new(cc());
    let (libraries, flags): (Vec<&str>, Vec<&str>) =
        flags.iter().partition(|flag| flag.starts_with("-l"));
    command
        .args(["-std=c99", "-O1", "-g"])
        .args(STRICT)
        .args(flags);
    command.arg("-I").arg(root().join("include"));
    command.arg(root().join(source)).arg(library());
    command
        .args(libraries)
        .args(["-Wl,--gc-sections", "-lm", "-o"])
        .arg(&program);
    succeed(&mut command);
    program
}

/// Arguments of the C tests: model, raw frames, width, height.
pub fn arguments() -> &'static [String; 4] {
    static ARGUMENTS: OnceLock<[String; 4]> = OnceLock::new();
    ARGUMENTS.get_or_init(|| {
        let clip = demo();
        // Enough to find the face, track it and be done under sanitizers.
        let frames: Vec<u8> = clip.luma.iter().take(60).flatten().copied().collect();
        let path = scratch("c").join("frames.raw");
        std::fs::write(&path, frames).expect("target/ is writable");
        [
            root()
                .join("models/posewise.posewise")
                .display()
                .to_string(),
            path.display().to_string(),
            clip.width.to_string(),
            clip.height.to_string(),
        ]
    })
}

/// The y4m example.
pub fn example() -> &'static Path {
    static EXAMPLE: OnceLock<PathBuf> = OnceLock::new();
    EXAMPLE.get_or_init(|| program("ffi-examples/y4m.c", "y4m", &[]))
}
