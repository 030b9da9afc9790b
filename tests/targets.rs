//! Other machines, emulated: the static library, built as the Makefile builds it for them, gives the
//! same answers there to the last bit, and its structs lie the same.
//!
//! Skipped where compilers or emulators are missing, unless `POSEWISE_REQUIRE_TARGETS` is set.

mod common;

use common::c::{STRICT, cc, cxx, exists, library, require, succeed};
use common::{root, scratch};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Frames of the demo clip that each machine tracks: enough to search, find, track and lose.
const FRAMES: usize = 100;

fn make(goal: &str) -> Command {
    let mut make = Command::new("make");
    make.arg("-s").arg("-C").arg(root()).arg(goal);
    // The folder that `library` uses too; cargo shares what is the same.
    make.arg(format!("TARGET_DIR={}", scratch("dist").display()));
    make
}

/// What every machine must print, as this one does.
fn expected() -> &'static str {
    static EXPECTED: OnceLock<String> = OnceLock::new();
    EXPECTED.get_or_init(|| {
        library();
        let line = run_replay(None).0;
        let tracked = line.split(' ').rev().nth(1).and_then(|n| n.parse().ok());
        assert!(tracked > Some(FRAMES / 2), "{line}");
        line
    })
}

/// The demo clip, unpacked once.
fn clip() -> &'static Path {
    static CLIP: OnceLock<PathBuf> = OnceLock::new();
    CLIP.get_or_init(|| {
        let clip = scratch("targets").join("demo.y4m");
        let demo = common::demo().expect("tests/data/demo.y4m.gz");
        std::fs::write(&clip, demo.y4m).expect("target/ is writable");
        clip
    })
}

/// Builds and runs tests/c/replay.c on a machine; gives what it prints and what it says besides.
fn run_replay(target: Option<&str>) -> (String, String) {
    let mut make = make("replay");
    make.arg(format!("CLIP={}", clip().display()))
        .arg(format!("FRAMES={FRAMES}"));
    if let Some(target) = target {
        make.arg(format!("TARGET={target}"));
    }
    let output = make.output().expect("make runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let (line, said) = (text(output.stdout), text(output.stderr));
    assert!(output.status.success(), "{make:?}\n{line}{said}");
    print!("{}: {line}", target.unwrap_or("this machine"));
    (line, said)
}

/// Whether a library can be built for a machine, and programs compiled and run.
fn possible(target: &str, programs: &[&str]) -> bool {
    if !programs.iter().all(|program| require(program)) {
        return false;
    }
    let mut dry = make("lib");
    let dry = dry.arg("--dry-run").arg(format!("TARGET={target}"));
    let rust = dry.output().is_ok_and(|output| output.status.success());
    rust || require(&format!("Rust for {target}"))
}

/// Runs the clip on a machine, if that is possible, and gives what was said besides the answer.
fn answers_alike(target: &str, programs: &[&str]) -> Option<String> {
    if !require("make") || !possible(target, programs) {
        return None;
    }
    let (line, said) = run_replay(Some(target));
    assert_eq!(line, expected(), "this machine at the right");
    Some(said)
}

#[test]
fn aarch64_answers_alike() {
    let programs = ["aarch64-linux-gnu-gcc", "qemu-aarch64-static"];
    answers_alike("aarch64-unknown-linux-gnu", &programs);
}

#[test]
fn armv7_answers_alike() {
    let programs = ["arm-linux-gnueabihf-gcc", "qemu-arm-static"];
    answers_alike("armv7-unknown-linux-gnueabihf", &programs);
}

/// What the header promises of a call; here the program around it must fit in, too \[bytes\].
const STACK_LIMIT: usize = 32 * 1024;

#[test]
fn cortex_m_answers_alike() {
    let programs = ["arm-none-eabi-gcc", "qemu-system-arm"];
    let Some(said) = answers_alike("thumbv7em-none-eabihf", &programs) else {
        return;
    };
    let stack = said.lines().find_map(|line| line.strip_prefix("stack: "));
    let bytes = stack.and_then(|s| s.split(' ').next()?.parse::<usize>().ok());
    let bytes = bytes.expect("start.c tells it");
    println!("stack of the whole program: {bytes}");
    assert!(bytes <= STACK_LIMIT);
    common::check_documented("stack of a whole program, Cortex-M4", bytes, 0.1);
}

/// Code and constants that a program gets at most, the model not counted \[bytes\].
const CODE_LIMIT: usize = 256 * 1024;

#[test]
fn code_is_small() {
    let target = "aarch64-unknown-linux-gnu";
    if !require("make") || !possible(target, &["aarch64-linux-gnu-gcc", "aarch64-linux-gnu-size"]) {
        return;
    }
    let table = succeed(make("size").arg(format!("TARGET={target}")));
    println!("{table}");
    let sizes = table.lines().nth(1).expect("a line below the head");
    let text = sizes.split_whitespace().next().and_then(|n| n.parse().ok());
    let text: usize = text.expect("a number");
    assert!(text <= CODE_LIMIT, "{text} bytes of code");
    common::check_documented("code and constants without model, AArch64", text, 0.03);
}

#[test]
fn structs_lie_alike() {
    let check = |compiler: &str, flags: &[&str]| {
        let mut command = Command::new(compiler);
        command.args(flags).args(STRICT).arg("-Wpadded");
        command
            .args(["-fsyntax-only", "-I"])
            .arg(root().join("include"));
        succeed(command.arg(root().join("tests/c/abi.c")));
    };
    check(&cc(), &["-std=c99"]);
    if let Some(cxx) = cxx() {
        check(&cxx, &["-x", "c++", "-std=c++11"]);
    }
    let cortex_m = ["-std=c99", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard"];
    let cross: [(&str, &[&str]); 3] = [
        ("aarch64-linux-gnu-gcc", &["-std=c99"]),
        // Short enums, as some ARM compilers have them, must not matter.
        ("arm-linux-gnueabihf-gcc", &["-std=c99", "-fshort-enums"]),
        ("arm-none-eabi-gcc", &cortex_m),
    ];
    for (compiler, flags) in cross {
        if exists(compiler) || require(compiler) {
            check(compiler, flags);
        }
    }
}
