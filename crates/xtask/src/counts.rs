//! What a program runs while it takes steps, counted by a plugin of QEMU.

use crate::replay::compile_c;
use crate::{Library, output_of, root};
use anyhow::{Context, Result, ensure};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The emulator that can load plugins: Debian's package qemu-user.
pub const COUNTING_EMULATOR: &str = "qemu-aarch64";

/// The emulated core of AArch64, which has dot products.
pub(crate) const AARCH64: [&str; 3] = [COUNTING_EMULATOR, "-cpu", "cortex-a76"];

/// KiB and ways of a core's caches.
#[derive(Clone, Copy)]
pub(crate) struct Caches {
    pub l1d: (u32, u32),
    pub l1i: (u32, u32),
    pub l2: (u32, u32),
}

/// A program that takes steps on the first frames of a clip and prints how many were tracked.
pub(crate) struct Steps {
    /// The emulator that runs it, and its options.
    pub emulator: Vec<&'static str>,
    pub program: PathBuf,
    /// Its arguments before and after the number of frames.
    pub before: String,
    pub after: Option<String>,
    /// Where the plugin is put.
    pub target_dir: PathBuf,
}

impl Steps {
    /// tests/c/steps.c on a y4m clip, with a library for AArch64 that is told these features of
    /// `POSEWISE_CPU_*`.
    pub fn of_library(library: &Library, clip: &Path, cpu: u32) -> Result<Self> {
        Ok(Steps {
            emulator: AARCH64.to_vec(),
            program: compile_c(library, "steps")?,
            before: clip.display().to_string(),
            after: Some(cpu.to_string()),
            target_dir: library.target_dir.clone(),
        })
    }

    /// What the steps on these frames take, all of which must be tracked, or none, and about as
    /// many paths through them.
    pub fn count(&self, frames: Range<usize>, caches: Caches, paths: u64) -> Result<Counts> {
        let before = self.run(frames.start, caches, [0, 0])?;
        let mut counts = self.run(frames.end, caches, [0, 0])?;
        if let Some(every) = (counts.instructions - before.instructions).checked_div(paths) {
            let first = before.instructions + every / 2;
            counts = self.run(frames.end, caches, [first, every])?;
        }
        let counts = counts.since(&before);
        ensure!(
            counts.tracked == 0 || counts.tracked == frames.len(),
            "{} of {} frames are tracked",
            counts.tracked,
            frames.len()
        );
        Ok(counts)
    }

    /// Counts over the first frames; paths begin at instruction `from`, one each `every`.
    fn run(&self, frames: usize, caches: Caches, [from, every]: [u64; 2]) -> Result<Counts> {
        let plugin = self.target_dir.join("libcount.so");
        let mut compile = Command::new(std::env::var("CC").unwrap_or("cc".into()));
        compile.args(["-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-o"]);
        output_of(
            compile
                .arg(&plugin)
                .arg(root().join("crates/xtask/src/count.c")),
        )?;
        // Without a slash the emulator looks for a plugin in the system's folders.
        let plugin = plugin.canonicalize()?;
        let option = |name, (kib, ways)| format!(",{name}={kib}:{ways}");
        let Caches { l1d, l1i, l2 } = caches;
        let mut options = option("l1d", l1d) + &option("l1i", l1i) + &option("l2", l2);
        options += &format!(",paths={from}:{every}");
        let mut emulator = Command::new(self.emulator[0]);
        emulator.args(&self.emulator[1..]);
        emulator.args(["-d", "plugin", "-plugin"]);
        emulator.arg(format!("{}{options}", plugin.display()));
        emulator.arg(&self.program);
        emulator.arg(&self.before).arg(frames.to_string());
        emulator.args(&self.after);
        let output = output_of(&mut emulator)?;
        let tracked = String::from_utf8(output.stdout)?;
        let mut counts = Counts::read(&String::from_utf8(output.stderr)?)?;
        counts.tracked = tracked.trim().parse()?;
        Ok(counts)
    }
}

/// Mean instructions of the steps on these frames of a y4m clip, all of which must be tracked, or
/// none. The library is one for AArch64, on a processor with these features of `POSEWISE_CPU_*`.
pub fn instructions_per_step(
    library: &Library,
    clip: &Path,
    frames: Range<usize>,
    cpu: u32,
) -> Result<u64> {
    let caches = Caches {
        l1d: (32, 4),
        l1i: (32, 4),
        l2: (512, 16),
    };
    let counts = Steps::of_library(library, clip, cpu)?.count(frames.clone(), caches, 0)?;
    Ok(counts.instructions / frames.len() as u64)
}

/// What the plugin counted.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Counts {
    pub tracked: usize,
    pub instructions: u64,
    /// Misses of the first level, of data and of code, and of the second level.
    pub misses: [u64; 3],
    /// Instructions as they run, each a word of hexadecimal digits.
    pub paths: Vec<String>,
}

impl Counts {
    /// Reads what the plugin printed.
    fn read(said: &str) -> Result<Self> {
        let number = |name: &str| -> Result<u64> {
            let mut lines = said.lines().rev();
            let number = lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
            Ok(number.with_context(|| format!("no {name}"))?.parse()?)
        };
        let paths = said.lines().filter_map(|line| line.strip_prefix("path "));
        Ok(Counts {
            tracked: 0,
            instructions: number("instructions")?,
            misses: [number("l1d")?, number("l1i")?, number("l2")?],
            paths: paths.map(|path| path.trim().to_string()).collect(),
        })
    }

    /// What came after the program had done what the other one does.
    fn since(mut self, before: &Counts) -> Self {
        self.tracked -= before.tracked;
        self.instructions -= before.instructions;
        for (misses, before) in self.misses.iter_mut().zip(before.misses) {
            *misses -= before;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_and_subtracted() {
        let before = Counts::read("\ninstructions 30\nl1d 4\nl1i 2\nl2 1\n").unwrap();
        let said =
            "path 11223344 aabbccdd \npath 01020304 \n\ninstructions 90\nl1d 9\nl1i 2\nl2 2\n";
        let counts = Counts::read(said).unwrap().since(&before);
        assert_eq!((counts.instructions, counts.misses), (60, [5, 0, 1]));
        assert_eq!(counts.paths, ["11223344 aabbccdd", "01020304"]);
        assert!(Counts::read("nothing").is_err());
    }
}
