//! Helpers of the command's tests.

#[path = "../../../../../tests/common/skip.rs"]
#[allow(dead_code)] // the list is for the last test of the workspace
pub mod skip;

#[path = "../../../../../tests/common/fails.rs"]
mod fails;

use std::path::Path;

use assert_cmd::Command;

/// The built command.
pub fn posewise() -> Command {
    Command::cargo_bin("posewise").expect("cargo builds the command for its tests")
}

/// The table of `track` on an input that may be `-`.
pub fn csv(input: &str, stdin: &[u8]) -> String {
    let mut run = posewise();
    run.args(["track", input, "--csv", "-", "--quiet"]);
    let run = run.write_stdin(stdin).assert().success();
    String::from_utf8(run.get_output().stdout.clone()).unwrap()
}

/// A y4m clip without a face: a gradient that moves.
pub fn gradient_clip(width: usize, height: usize, frames: usize) -> Vec<u8> {
    let mut out = format!("YUV4MPEG2 W{width} H{height} F25:1 Ip A1:1 C420jpeg\n").into_bytes();
    for i in 0..frames {
        out.extend_from_slice(b"FRAME\n");
        for y in 0..height {
            out.extend((0..width).map(|x| (x + 2 * y + 3 * i) as u8));
        }
        let chroma = width.div_ceil(2) * height.div_ceil(2);
        out.resize(out.len() + 2 * chroma, 128);
    }
    out
}

/// Whether a program is there; without it the test is skipped.
pub fn has_program(name: &str) -> bool {
    let mut program = std::process::Command::new(name);
    skip::need(name, program.arg("-version").output().is_ok())
}

/// Runs the command, which must fail with exit code 1, no panic, and a message that contains
/// each of `words`.
pub fn fails_with(args: &[&str], stdin: Vec<u8>, words: &[&str]) {
    let mut program = posewise();
    program.args(args).write_stdin(stdin);
    fails::fails(program, words);
}

/// A path as an argument.
pub fn arg(path: &Path) -> &str {
    path.to_str().expect("temporary paths are UTF-8")
}

/// The command under a limit of the shell's `ulimit`, as "-f 20" for files of 20 KB.
#[cfg(unix)]
pub fn limited(limit: &str) -> Command {
    let mut command = Command::new("bash");
    let program = assert_cmd::cargo::cargo_bin("posewise");
    command.args(["-c", &format!("ulimit {limit} && exec \"$0\" \"$@\"")]);
    command.arg(program);
    command
}
