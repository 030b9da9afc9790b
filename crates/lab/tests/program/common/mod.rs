//! Small clips with truth, and the program.

#[path = "../../../../../tests/common/skip.rs"]
#[allow(dead_code)] // the list is for the last test
pub mod skip;

#[path = "../../../../../tests/common/fails.rs"]
mod fails;

use flate2::read::GzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Frames of each clip.
pub const FRAMES: usize = 12;

/// A folder with clips.
pub struct Run(TempDir);

impl Run {
    /// A file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with these arguments.
    pub fn plain(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_posewise-lab"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    /// The same, then the two clips, and posewise only.
    pub fn arguments(&self, arguments: &[&str]) -> Command {
        let mut command = self.plain(arguments);
        command.args(["a.y4m", "b.y4m", "--methods", "posewise"]);
        command
    }
}

/// Standard output of a command that must succeed.
pub fn lab(command: &mut Command) -> String {
    let output = command.output().expect("posewise-lab");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{stderr}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Two parts of the demo clip, `a.y4m` and `b.y4m`, with their truth.
pub fn two_clips() -> Run {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data");
    let packed = std::fs::File::open(data.join("demo.y4m.gz")).expect("the demo clip");
    let mut video = Vec::new();
    GzDecoder::new(packed)
        .read_to_end(&mut video)
        .expect("gzip");
    let head = video.iter().position(|b| *b == b'\n').expect("a line") + 1;
    let frame = "FRAME\n".len() + 320 * 240;
    let truth = std::fs::read_to_string(data.join("demo.csv")).expect("its truth");
    let lines: Vec<&str> = truth.lines().collect();
    let run = Run(tempfile::tempdir().expect("a folder"));
    for (name, from) in [("a", 0), ("b", 40)] {
        let frames = &video[head + from * frame..][..FRAMES * frame];
        std::fs::write(
            run.path(&format!("{name}.y4m")),
            [&video[..head], frames].concat(),
        )
        .expect("writable");
        let rows = [&lines[..1], &lines[1 + from..][..FRAMES]].concat();
        std::fs::write(run.path(&format!("{name}.csv")), rows.join("\n")).expect("writable");
    }
    run
}

/// The clip that ships with posewise, and its truth.
pub const DEMO: [&str; 2] = [
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz"),
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.csv"),
];

/// The program.
pub fn program() -> assert_cmd::Command {
    assert_cmd::Command::new(env!("CARGO_BIN_EXE_posewise-lab"))
}

/// `posewise track` with these arguments, in this process.
pub fn track(args: &[&str]) {
    let all = [&["posewise", "track", "--quiet"], args].concat();
    let cli = <posewise_cli::cli::Cli as clap::Parser>::parse_from(all);
    posewise_cli::command::run(cli).expect("the command");
}

/// Runs the program, which must fail with exit code 1, no panic, and a message that contains
/// each of `words`.
pub fn fails_with(args: &[&str], words: &[&str]) {
    let mut program = program();
    program.args(args);
    fails::fails(program, words);
}

/// A path as an argument.
pub fn arg(path: &Path) -> &str {
    path.to_str().expect("temporary paths are UTF-8")
}
