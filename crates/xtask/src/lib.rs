//! Developer commands (`cargo xtask --help`). They measure the static library that the Makefile
//! builds, on this machine and on emulated ones, and the accuracy of the models. The tests call the
//! same functions.

pub mod cores;
mod counts;
pub mod figures;
pub mod interface;
mod library;
mod machine;
pub mod mobile;
pub mod notices;
pub mod picture;
pub mod release;
mod replay;
pub mod site;
mod size;
pub mod web;
mod zip;

pub use counts::{COUNTING_EMULATOR, instructions_per_step};
pub use library::{Library, optional_parts};
pub use machine::{Machine, WINE};
pub use replay::{Replay, demo_clip, replay, run_c};
pub use size::{ON_TOP, code_size, functions_of_the_header, size_on_top, size_table};

use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The repository.
pub fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).expect("crates/xtask").to_path_buf()
}

/// Output of a command that must succeed.
fn output_of(command: &mut Command) -> Result<Output> {
    let output = command
        .output()
        .with_context(|| format!("cannot start {command:?}"))?;
    ensure!(
        output.status.success(),
        "{command:?}\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(output)
}

/// Writes a file and the folders above it.
fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<()> {
    std::fs::create_dir_all(path.parent().context("no folder")?)?;
    std::fs::write(path, contents).with_context(|| format!("cannot write {path:?}"))
}
