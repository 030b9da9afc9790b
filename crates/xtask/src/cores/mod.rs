//! `cargo xtask cores`: how long a tracking step takes on ARM cores, estimated.
//!
//! An emulator counts the instructions and prints paths through them, a sample. LLVM's model of the
//! core says how many cycles a path takes. A model of the caches counts misses, each of which costs
//! its whole latency. The same is done for this machine's own core, on which the steps are measured
//! too.

mod mca;

use crate::counts::{Caches, Counts, Steps};
use crate::{Library, demo_clip, output_of, root};
use anyhow::{Context, Result};
use mca::Processor;
use std::fmt::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Frames of the demo clip whose steps are estimated; the face is found before.
const FRAMES: Range<usize> = 20..44;

/// Paths whose cycles are modelled.
const PATHS: u64 = 400;

/// How often the steps are timed.
const ROUNDS: usize = 60;

struct Core {
    name: &'static str,
    processor: Processor,
    /// The clock \[GHz\].
    clock: f64,
    kernel: &'static str,
    caches: Caches,
    /// What misses of the first and of the second level cost \[cycles\].
    latencies: [f64; 2],
}

const fn arm(cpu: &'static str) -> Processor {
    Processor {
        triple: "aarch64",
        cpu,
        more: "+v8.2a,+dotprod",
    }
}

/// The one that most depends on which results wait.
const A53: Core = Core {
    name: "Cortex-A53, 1.4 GHz",
    processor: arm("cortex-a53"),
    clock: 1.4,
    kernel: "neon",
    caches: caches((32, 4), (32, 2), (512, 16)),
    latencies: [15.0, 180.0],
};

/// On Raspberry Pi 3, Radxa Zero 3, Raspberry Pi 4 and 5. LLVM has the results of all SIMD
/// instructions of Cortex-A53 wait six cycles, of A55 four: A53 is estimated both ways. Cortex-A76
/// is taken for Neoverse N1, as LLVM has no model of it; its misses of the second level go to a
/// third, which holds all that a step reads.
const CORES: [Core; 5] = [
    A53,
    Core {
        name: "the same, waiting like A55",
        processor: arm("cortex-a55"),
        ..A53
    },
    Core {
        name: "Cortex-A55, 1.6 GHz",
        processor: arm("cortex-a55"),
        clock: 1.6,
        kernel: "dotprod",
        caches: caches((32, 4), (32, 4), (512, 16)),
        latencies: [15.0, 200.0],
    },
    Core {
        name: "Cortex-A72, 1.8 GHz",
        processor: arm("cortex-a72"),
        clock: 1.8,
        kernel: "neon",
        caches: caches((32, 2), (48, 3), (1024, 16)),
        latencies: [20.0, 200.0],
    },
    Core {
        name: "Cortex-A76, 2.4 GHz",
        processor: arm("neoverse-n1"),
        clock: 2.4,
        kernel: "dotprod",
        caches: caches((64, 4), (64, 4), (512, 8)),
        latencies: [11.0, 40.0],
    },
];

const fn caches(l1d: (u32, u32), l1i: (u32, u32), l2: (u32, u32)) -> Caches {
    Caches { l1d, l1i, l2 }
}

/// Sapphire Rapids, at the clock that is measured.
const THIS: Core = Core {
    name: "this machine",
    processor: Processor {
        triple: "x86_64",
        cpu: "sapphirerapids",
        more: "+avx2",
    },
    clock: 1.0,
    kernel: "avx2",
    caches: caches((48, 12), (32, 8), (2048, 16)),
    latencies: [14.0, 70.0],
};

/// What a step takes, in millions.
struct Estimate {
    instructions: f64,
    cycles: f64,
    misses: f64,
}

/// Prints a table of estimates, and how far one for this machine is from what is measured.
pub fn run(target_dir: &Path) -> Result<()> {
    let clip = demo_clip(target_dir)?;
    let library = Library {
        target: Some("aarch64-unknown-linux-gnu".into()),
        without: Vec::new(),
        target_dir: target_dir.into(),
    };
    let mut table = String::from(
        "| core, clock | kernel | instructions | cycles | of misses | tracking step |\n\
         |---|---|---|---|---|---|\n",
    );
    for core in &CORES {
        let features = u32::from(core.kernel == "dotprod");
        let steps = Steps::of_library(&library, &clip, features)?;
        let of = estimate(core, &steps.count(FRAMES, core.caches, PATHS)?)?;
        row(&mut table, core, &of)?;
    }
    print!("{table}");
    if cfg!(target_arch = "x86_64") && is_known()? {
        print!("\n{}", check(target_dir)?);
    }
    Ok(())
}

fn row(table: &mut String, core: &Core, of: &Estimate) -> Result<()> {
    let time = |cycles: f64| cycles / core.clock;
    writeln!(
        table,
        "| {} | `{}` | {:.1} M | {:.1} M | {:.1} M | {:.1}–{:.1} ms |",
        core.name,
        core.kernel,
        of.instructions,
        of.cycles,
        of.misses,
        time(of.cycles),
        time(of.cycles + of.misses),
    )?;
    Ok(())
}

fn estimate(core: &Core, counts: &Counts) -> Result<Estimate> {
    let cycles = mca::cycles(core.processor, &counts.paths)?;
    Ok(of_step(core, counts, cycles.iter().sum()))
}

/// A step's share of what is counted, when all paths together take these cycles.
fn of_step(core: &Core, counts: &Counts, cycles: f64) -> Estimate {
    let of_step = |number: f64| number / FRAMES.len() as f64 / 1e6;
    let on_paths: usize = counts
        .paths
        .iter()
        .map(|path| path.split(' ').count())
        .sum();
    let [data, code, second] = counts.misses.map(|misses| misses as f64);
    let [second_level, memory] = core.latencies;
    let instructions = counts.instructions as f64;
    Estimate {
        instructions: of_step(instructions),
        cycles: of_step(cycles / on_paths as f64 * instructions),
        misses: of_step((data + code) * second_level + second * memory),
    }
}

/// Whether this machine's core is the one that [`THIS`] describes.
fn is_known() -> Result<bool> {
    let flags = std::fs::read_to_string("/proc/cpuinfo")?;
    Ok(["amx_int8", "avx512_fp16", "GenuineIntel"]
        .iter()
        .all(|flag| flags.contains(flag)))
}

/// Estimates the steps of this machine, measures them, and compares both.
fn check(target_dir: &Path) -> Result<String> {
    let program = bench()?;
    let steps = Steps {
        emulator: vec!["qemu-x86_64", "-cpu", "max"],
        program: program.clone(),
        before: THIS.kernel.into(),
        after: None,
        target_dir: target_dir.into(),
    };
    let of = estimate(&THIS, &steps.count(FRAMES, THIS.caches, PATHS)?)?;
    let mut time = Command::new(program);
    time.args([THIS.kernel.into(), FRAMES.end.to_string()]);
    time.args([FRAMES.start, ROUNDS].map(|number| number.to_string()));
    let said = String::from_utf8(output_of(&mut time)?.stdout)?;
    let numbers = said.lines().nth(1).context("no times")?;
    let (step, cycle) = numbers.split_once(' ').context("no time of a cycle")?;
    let (step, cycle): (f64, f64) = (step.parse()?, cycle.parse()?);
    let measured = step / cycle / 1e6;
    Ok(format!(
        "This machine, {:.2} GHz, `{}`: {:.1} M instructions, estimated {:.2} to {:.2} M cycles, \
         measured {measured:.2} M ({:.2} ms): {:.2} to {:.2} of the estimate.\n",
        1.0 / cycle,
        THIS.kernel,
        of.instructions,
        of.cycles,
        of.cycles + of.misses,
        step / 1e6,
        measured / (of.cycles + of.misses),
        measured / of.cycles,
    ))
}

/// Builds benches/steps.rs, and gives the program's path.
fn bench() -> Result<PathBuf> {
    let mut cargo = Command::new(std::env::var("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root());
    cargo.args([
        "bench",
        "--bench",
        "steps",
        "--no-run",
        "--message-format=json",
    ]);
    let messages = String::from_utf8(output_of(&mut cargo)?.stdout)?;
    let programs = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let mut programs = programs.filter(|m| m["target"]["name"] == "steps");
    let program = programs.find_map(|m| m["executable"].as_str().map(PathBuf::from));
    program.context("cargo names no program")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_takes_the_cycles_of_its_paths_and_misses() {
        let counts = Counts {
            tracked: FRAMES.len(),
            instructions: 24_000_000,
            misses: [240_000, 0, 24_000],
            paths: vec!["01 02 03".into(), "04".into()],
        };
        let of = of_step(&CORES[0], &counts, 6.0);
        assert_eq!((of.instructions, of.cycles), (1.0, 1.5));
        let [second_level, memory] = CORES[0].latencies;
        assert_eq!(
            of.misses,
            (10_000.0 * second_level + 1_000.0 * memory) / 1e6
        );
    }
}
