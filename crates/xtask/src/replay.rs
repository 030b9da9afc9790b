//! Replays the same frames on any machine: `tests/c/replay.c` prints a hash of all results.

use crate::{Library, Machine, output_of, root};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

/// What a replay printed.
pub struct Replay {
    /// Hash, number of frames, number of tracked frames: the same on every machine.
    pub line: String,
    /// Sizes, one a line as `name: number unit`; they differ from machine to machine.
    pub notes: String,
}

impl Replay {
    /// Frames in which a face was tracked.
    pub fn tracked(&self) -> Option<usize> {
        self.line.split(' ').rev().nth(1)?.parse().ok()
    }

    /// One of the sizes in the notes: `model`, `tracker`, `landmarks`, `stack of posewise_step`, …
    pub fn figure(&self, name: &str) -> Option<usize> {
        let mut lines = self.notes.lines();
        let rest = lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(": "))?;
        rest.split(' ').next()?.parse().ok()
    }
}

/// Tracks the first frames of a y4m clip with a library, on its machine, which has these features
/// of `POSEWISE_CPU_*`.
pub fn replay(library: &Library, clip: &Path, frames: usize, cpu: u32) -> Result<Replay> {
    let arguments = [
        clip.display().to_string(),
        frames.to_string(),
        cpu.to_string(),
    ];
    let output = run_c(library, "replay", &arguments)?;
    // Windows ends lines with two characters.
    let text = |bytes| String::from_utf8(bytes).map(|text| text.replace("\r\n", "\n"));
    Ok(Replay {
        line: text(output.stdout)?,
        notes: text(output.stderr)?,
    })
}

/// Compiles a program of tests/c with a library, and runs it on the library's machine.
pub fn run_c(library: &Library, name: &str, arguments: &[String]) -> Result<Output> {
    let program = compile_c(library, name)?;
    let machine = Machine::named(library.target.as_deref())?;
    output_of(machine.run(&program, arguments).stdin(Stdio::null()))
}

/// Compiles a program of tests/c with a library, and gives its path.
pub(crate) fn compile_c(library: &Library, name: &str) -> Result<PathBuf> {
    let machine = Machine::named(library.target.as_deref())?;
    let archive = library.build()?;
    let file = format!("{name}-{}{}", library.target_name(), machine.suffix());
    let program = library.target_dir.join(file);
    let mut compile = machine.compiler();
    compile.args([
        "-std=c99",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
    ]);
    compile.arg("-I").arg(root().join("include"));
    compile.arg(root().join(format!("tests/c/{name}.c")));
    compile.args(machine.start_up()).arg(archive);
    compile.args(["-Wl,--gc-sections", "-lm", "-o"]);
    output_of(compile.arg(&program))?;
    Ok(program)
}

/// Unpacks the clip of the repository into a folder, and gives its path.
pub fn demo_clip(folder: &Path) -> Result<PathBuf> {
    let packed = std::fs::File::open(root().join("tests/data/demo.y4m.gz"))
        .context("tests/data/demo.y4m.gz")?;
    std::fs::create_dir_all(folder)?;
    let path = folder.join("demo.y4m");
    let mut clip = std::fs::File::create(&path)?;
    std::io::copy(&mut flate2::read::MultiGzDecoder::new(packed), &mut clip)?;
    Ok(path)
}
