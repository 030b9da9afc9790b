//! Instructions that a step takes on AArch64, counted by a plugin of QEMU.

use crate::replay::compile_c;
use crate::{Library, output_of, root};
use anyhow::{Context, Result, ensure};
use std::ops::Range;
use std::path::Path;
use std::process::Command;

/// The emulator that can load plugins: Debian's package qemu-user.
pub const COUNTING_EMULATOR: &str = "qemu-aarch64";

/// Mean instructions of the steps on these frames of a y4m clip, all of which must be tracked, or
/// none. The library is one for AArch64, on a processor with these features of `POSEWISE_CPU_*`.
pub fn instructions_per_step(
    library: &Library,
    clip: &Path,
    frames: Range<usize>,
    cpu: u32,
) -> Result<u64> {
    let program = compile_c(library, "steps")?;
    let plugin = library.target_dir.join("libcount.so");
    let mut compile = Command::new(std::env::var("CC").unwrap_or("cc".into()));
    compile.args(["-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-o"]);
    output_of(
        compile
            .arg(&plugin)
            .arg(root().join("crates/xtask/src/count.c")),
    )?;
    // Without a slash the emulator looks for a plugin in the system's folders.
    let plugin = plugin.canonicalize()?;
    let run = |frames: usize| -> Result<(u64, usize)> {
        let mut emulator = Command::new(COUNTING_EMULATOR);
        emulator.args(["-cpu", "cortex-a76", "-d", "plugin", "-plugin"]);
        emulator.arg(&plugin).arg(&program);
        emulator
            .arg(clip)
            .args([frames.to_string(), cpu.to_string()]);
        let output = output_of(&mut emulator)?;
        let said = String::from_utf8(output.stderr)?;
        let count = said.split("instructions: ").nth(1).context("no count")?;
        let tracked = String::from_utf8(output.stdout)?;
        Ok((count.trim().parse()?, tracked.trim().parse()?))
    };
    let ((before, tracked_before), (after, tracked)) = (run(frames.start)?, run(frames.end)?);
    let of_these = tracked - tracked_before;
    ensure!(
        of_these == 0 || of_these == frames.len(),
        "{of_these} of {} frames are tracked",
        frames.len()
    );
    Ok((after - before) / frames.len() as u64)
}
