//! Other machines, emulated: the static library, built for them by the Makefile, gives the same
//! results there to the last bit, and its structs have the same layout.
//!
//! Skipped where compilers or emulators are missing, unless `POSEWISE_REQUIRE_TARGETS` is set.

use crate::common::c::{self, STRICT, cc, cxx, library, require, succeed};
use crate::common::{root, scratch};
use posewise::ffi::types::POSEWISE_CPU_DOTPROD;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use xtask::{Library, Replay};

/// Frames of the demo clip that each machine tracks: enough to search, find, track and lose.
const FRAMES: usize = 100;

/// The library as the Makefile builds it for a machine.
fn built_for(target: Option<&str>) -> Library {
    Library {
        target: target.map(String::from),
        without: Vec::new(),
        // The folder that `library` uses too; cargo shares what is the same.
        target_dir: scratch("dist"),
    }
}

/// What every machine must print, as this one does.
fn expected() -> &'static str {
    static EXPECTED: OnceLock<String> = OnceLock::new();
    EXPECTED.get_or_init(|| {
        library();
        let replay = replay(None, 0);
        assert!(replay.tracked() > Some(FRAMES / 2), "{}", replay.line);
        replay.line
    })
}

/// The demo clip, unpacked once.
fn clip() -> &'static Path {
    static CLIP: OnceLock<PathBuf> = OnceLock::new();
    CLIP.get_or_init(|| xtask::demo_clip(&scratch("targets")).expect("tests/data/demo.y4m.gz"))
}

/// Builds and runs tests/c/replay.c on a machine.
fn replay(target: Option<&str>, cpu: u32) -> Replay {
    let replay = xtask::replay(&built_for(target), clip(), FRAMES, cpu);
    let replay = replay.unwrap_or_else(|error| panic!("{error:#}"));
    print!("{}: {}", target.unwrap_or("this machine"), replay.line);
    replay
}

/// Minutes of the simulated drive.
const MINUTES: usize = 60;

/// Builds and runs tests/c/drive.c on a machine.
fn drive(target: Option<&str>) -> String {
    let output = xtask::run_c(&built_for(target), "drive", &[MINUTES.to_string()]);
    let output = output.unwrap_or_else(|error| panic!("{error:#}"));
    let line = String::from_utf8_lossy(&output.stdout).replace("\r\n", "\n");
    print!("{}: {line}", target.unwrap_or("this machine"));
    line
}

/// The drive as every machine must see it, as this one does.
fn expected_drive() -> &'static str {
    static EXPECTED: OnceLock<String> = OnceLock::new();
    EXPECTED.get_or_init(|| drive(None))
}

/// Whether a library can be built for a machine, and programs compiled and run.
fn possible(target: &str, programs: &[&str]) -> bool {
    if !programs.iter().all(|program| require(program)) {
        return false;
    }
    built_for(Some(target)).can_be_built() || require(&format!("Rust for {target}"))
}

/// Part of a figure in docs/memory.md by which a measured one may be off.
const TOLERANCE: f64 = 0.02;

/// What the header promises of the stack of a call \[bytes\].
const STACK_LIMIT: usize = 40 * 1024;

/// One of the figures that the replay printed.
fn figure(replay: &Replay, name: &str) -> usize {
    let figure = replay.figure(name);
    figure.unwrap_or_else(|| panic!("no '{name}' in {}", replay.notes))
}

/// Checks that each call keeps the promise of the header, and what docs/memory.md says of it.
fn check_stack(replay: &Replay, machine: &str) {
    let calls = ["init", "step", "step_at", "detect", "mesh"];
    let stacks = calls.map(|name| {
        let call = format!("posewise_{name}");
        let bytes = figure(replay, &format!("stack of {call}"));
        println!("{machine}: stack of {call}: {bytes}");
        (call, bytes)
    });
    for (call, bytes) in stacks {
        assert!(
            bytes < STACK_LIMIT,
            "{machine}: {call} takes {bytes} bytes of stack"
        );
        crate::common::check_documented(&format!("stack of `{call}`, {machine}"), bytes, TOLERANCE);
    }
}

/// Runs the clip on a machine, if that is possible: the same results as here, on a bounded stack.
fn check_target(target: &str, machine: &str, cpu: u32, programs: &[&str]) {
    if require("make") && possible(target, programs) {
        let replay = replay(Some(target), cpu);
        assert_eq!(replay.line, expected(), "this machine at the right");
        check_stack(&replay, machine);
        assert_eq!(
            drive(Some(target)),
            expected_drive(),
            "this machine at the right"
        );
    }
}

#[test]
fn aarch64_answers_alike() {
    let programs = ["aarch64-linux-gnu-gcc", "qemu-aarch64-static"];
    for cpu in [0, POSEWISE_CPU_DOTPROD] {
        check_target("aarch64-unknown-linux-gnu", "AArch64", cpu, &programs);
    }
}

#[test]
#[ignore = "a second emulated machine: .ci/nightly"]
fn armv7_answers_alike() {
    let programs = ["arm-linux-gnueabihf-gcc", "qemu-arm-static"];
    check_target("armv7-unknown-linux-gnueabihf", "ARMv7", 0, &programs);
}

#[test]
#[ignore = "a third emulated machine: .ci/nightly"]
fn cortex_m_answers_alike() {
    let programs = ["arm-none-eabi-gcc", "qemu-system-arm"];
    check_target("thumbv7em-none-eabihf", "Cortex-M4", 0, &programs);
}

/// Every call of the search with right and wrong arguments, and the caller's floating-point
/// environments, on 32-bit machines.
#[test]
#[ignore = "takes minutes: .ci/nightly"]
fn every_wrong_call_is_answered_on_arm() {
    let machines = [
        (
            "armv7-unknown-linux-gnueabihf",
            ["arm-linux-gnueabihf-gcc", "qemu-arm-static"],
        ),
        (
            "thumbv7em-none-eabihf",
            ["arm-none-eabi-gcc", "qemu-system-arm"],
        ),
    ];
    // As many as the Cortex-M's memory holds beside the model.
    let frames: Vec<u8> = crate::common::demo()
        .luma
        .iter()
        .take(12)
        .flatten()
        .copied()
        .collect();
    let path = scratch("targets").join("frames.raw");
    std::fs::write(&path, frames).expect("target/ is writable");
    let mut arguments = c::arguments().clone();
    arguments[1] = path.display().to_string();
    for (target, programs) in machines {
        if require("make") && possible(target, &programs) {
            for name in ["search", "float_env"] {
                let run = xtask::run_c(&built_for(Some(target)), name, &arguments);
                let output = run.unwrap_or_else(|error| panic!("{error:#}"));
                println!(
                    "{target}: {name}: {}",
                    String::from_utf8_lossy(&output.stdout)
                );
            }
        }
    }
}

/// Compiled with MinGW and run with Wine.
#[test]
#[ignore = "a fourth emulated machine: .ci/nightly"]
fn windows_answers_alike() {
    let target = "x86_64-pc-windows-gnu";
    if require("make") && possible(target, &["x86_64-w64-mingw32-gcc", xtask::WINE]) {
        let replay = replay(Some(target), 0);
        assert_eq!(replay.line, expected(), "this machine at the right");
    }
}

/// `POSEWISE_MEMORY_SIZE` may exceed the true need by this factor, no more: it is what a C program
/// sets aside.
const MEMORY_SLACK: f64 = 1.15;

#[test]
fn stack_and_memory_are_bounded_here() {
    if !require("make") {
        return;
    }
    library();
    let replay = replay(None, 0);
    if cfg!(target_arch = "x86_64") {
        check_stack(&replay, "x86-64");
    }
    let (need, stated) = (
        figure(&replay, "tracker"),
        posewise::ffi::types::POSEWISE_MEMORY_SIZE as usize,
    );
    assert!(need <= stated);
    crate::common::check_documented("tracker, 64-bit machine", need, TOLERANCE);
    crate::common::check_documented("… at most, known when compiling", stated, 0.0);
    assert!(
        stated as f64 <= need as f64 * MEMORY_SLACK,
        "POSEWISE_MEMORY_SIZE is {stated}, a tracker needs {need}: lower it in ffi/types.rs"
    );
}

/// Code and constants that a program gets at most, the model not counted \[bytes\].
const CODE_LIMIT: usize = 336 * 1024;

/// What the driver monitor and the mesh add at most, in programs that use them \[bytes\], by the
/// rows of docs/memory.md.
const ON_TOP: [(&str, usize); 2] = [
    ("… of the driver monitor on top, AArch64", 34 * 1024),
    ("… of the mesh on top, AArch64", 11 * 1024),
];

#[test]
fn code_is_small() {
    let target = "aarch64-unknown-linux-gnu";
    if !require("make") || !possible(target, &["aarch64-linux-gnu-gcc", "aarch64-linux-gnu-size"]) {
        return;
    }
    let bytes = xtask::code_size(&built_for(Some(target)));
    let bytes = bytes.unwrap_or_else(|error| panic!("{error:#}"));
    assert!(bytes <= CODE_LIMIT, "{bytes} bytes of code");
    crate::common::check_documented(
        "code and constants without model, AArch64",
        bytes,
        TOLERANCE,
    );
    for ((row, limit), start) in ON_TOP.into_iter().zip(xtask::ON_TOP) {
        let bytes = xtask::size_on_top(&built_for(Some(target)), start);
        let bytes = bytes.unwrap_or_else(|error| panic!("{error:#}"));
        assert!(bytes <= limit, "{bytes} bytes of {start}");
        crate::common::check_documented(row, bytes, TOLERANCE);
    }
}

/// Checks the layout of all structs as a compiler with these flags sees it.
fn check_structs(compiler: &str, flags: &[&str]) {
    let mut command = Command::new(compiler);
    command.args(flags).args(STRICT).arg("-Wpadded");
    command
        .args(["-fsyntax-only", "-I"])
        .arg(root().join("include"));
    succeed(command.arg(crate::c::layouts()));
}

#[test]
fn structs_lie_alike() {
    check_structs(&cc(), &["-std=c99"]);
    if let Some(cxx) = cxx() {
        check_structs(&cxx, &["-x", "c++", "-std=c++11"]);
    }
    if require("aarch64-linux-gnu-gcc") {
        check_structs("aarch64-linux-gnu-gcc", &["-std=c99"]);
    }
    if require("clang") {
        for target in ["armv7-unknown-linux-gnueabihf", "thumbv7em-none-eabihf"] {
            let target = format!("--target={target}");
            check_structs("clang", &[&target, "-std=c99", "-ffreestanding"]);
        }
    }
}

/// As GCC sees it, with the headers of each machine's C library.
#[test]
#[ignore = "needs two cross compilers: .ci/nightly"]
fn structs_lie_alike_on_arm() {
    let cortex_m = ["-std=c99", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard"];
    let cross: [(&str, &[&str]); 2] = [
        // Short enums, as some ARM compilers have them, must not matter.
        ("arm-linux-gnueabihf-gcc", &["-std=c99", "-fshort-enums"]),
        ("arm-none-eabi-gcc", &cortex_m),
    ];
    for (compiler, flags) in cross {
        if require(compiler) {
            check_structs(compiler, flags);
        }
    }
}
