//! Cycles of instructions by llvm-mca, LLVM's model of processors: Debian's package llvm-22.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::io::Write;
use std::process::{Command, Stdio};

/// The programs; another version has other models.
const DISASSEMBLER: &str = "llvm-mc-22";
const ANALYSER: &str = "llvm-mca-22";

/// What a path begins with, before its number.
const BEGIN: &str = "# LLVM-MCA-BEGIN ";

/// A processor by LLVM's names.
#[derive(Clone, Copy)]
pub(super) struct Processor {
    pub triple: &'static str,
    pub cpu: &'static str,
    /// Instruction sets that its model lacks, each with a `+`.
    pub more: &'static str,
}

/// Cycles of each path, whose instructions are words of hexadecimal digits, where all loads hit and
/// all branches are predicted.
pub(super) fn cycles(processor: Processor, paths: &[String]) -> Result<Vec<f64>> {
    let assembly = assembly(processor, paths)?;
    let mut analyse = Command::new(ANALYSER);
    analyse.arg(format!("--mtriple={}", processor.triple));
    analyse.arg(format!("--mattr={}", processor.more));
    analyse.arg(format!("--mcpu={}", processor.cpu));
    analyse.args([
        "--iterations=1",
        "--json",
        "--instruction-info=0",
        "--resource-pressure=0",
    ]);
    // By default a call is taken to need 100 cycles.
    analyse.args(["--call-latency=1", "--skip-unsupported-instructions=any"]);
    let instructions: Vec<u64> = assembly
        .split(BEGIN)
        .skip(1)
        .map(|path| path.lines().count() as u64 - 2)
        .collect();
    read(&piped(analyse, assembly)?, &instructions)
}

/// The paths in assembly, each between marks.
fn assembly(processor: Processor, paths: &[String]) -> Result<String> {
    let mut disassemble = Command::new(DISASSEMBLER);
    disassemble.arg(format!("--triple={}", processor.triple));
    disassemble.arg(format!("--mattr={}", processor.more));
    disassemble.arg("--disassemble");
    let mut bytes = String::new();
    for digit in paths.join(" ").replace(' ', "").as_bytes().chunks(2) {
        bytes += &format!("0x{} ", String::from_utf8_lossy(digit));
    }
    let text = piped(disassemble, bytes)?;
    let mut lines = text
        .lines()
        .filter(|line| !line.trim().is_empty() && !line.trim().starts_with('.'));
    let mut assembly = String::new();
    for (n, path) in paths.iter().enumerate() {
        assembly += &format!("{BEGIN}{n}\n");
        for _ in path.split(' ') {
            let line = lines.next().context("fewer instructions than bytes say")?;
            assembly += &apart(line);
            assembly += "\n";
        }
        assembly += "# LLVM-MCA-END\n";
    }
    ensure!(lines.next().is_none(), "more instructions than bytes say");
    Ok(assembly)
}

/// A store of AArch64 that also moves its base register, as two instructions; others as they are.
/// The analyser would have the base wait for what is stored.
fn apart(line: &str) -> String {
    let (true, Some((before, address))) =
        (line.trim_start().starts_with("st"), line.rsplit_once('['))
    else {
        return line.into();
    };
    let add = |base: &str, offset: &str| format!("add\t{base}, {base}, {}", offset.trim());
    if let Some((base, offset)) = address.split_once("],") {
        return format!("{before}[{base}]\n{}", add(base, offset));
    }
    let address = address.strip_suffix("]!").and_then(|a| a.split_once(','));
    match address {
        Some((base, offset)) => format!("{}\n{before}[{base}]", add(base, offset)),
        None => line.into(),
    }
}

/// What a command says when it reads a text.
fn piped(mut command: Command, text: String) -> Result<String> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command
        .stderr(Stdio::null()) // It warns of calls and returns.
        .spawn()
        .with_context(|| format!("cannot start {command:?} (Debian: apt install llvm-22)"))?;
    let mut input = child.stdin.take().context("no input")?;
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output()?;
    ensure!(output.status.success(), "{command:?} failed");
    writer.join().ok().context("the writer failed")??;
    Ok(String::from_utf8(output.stdout)?)
}

/// The cycles in the analyser's report on paths of these numbers of instructions.
fn read(report: &str, instructions: &[u64]) -> Result<Vec<f64>> {
    let report: Value = serde_json::from_str(report)?;
    let regions = report["CodeRegions"].as_array().context("no regions")?;
    let mut cycles = vec![None; instructions.len()];
    for region in regions {
        let name = region["Name"].as_str().context("a region without name")?;
        let number: usize = name.parse()?;
        let summary = &region["SummaryView"];
        let of = |name: &str| summary[name].as_u64().with_context(|| name.to_string());
        let known = of("Instructions")?;
        let all = *instructions.get(number).context("an unknown region")?;
        ensure!(
            known == all,
            "{known} of {all} instructions of a path are known"
        );
        cycles[number] = Some(of("TotalCycles")? as f64);
    }
    let cycles: Option<Vec<f64>> = cycles.into_iter().collect();
    cycles.context("a path is not in the report")
}

#[cfg(test)]
mod tests {
    use super::{apart, read};

    const REPORT: &str = r#"{"CodeRegions": [
        {"Name": "1", "SummaryView": {"Instructions": 3, "TotalCycles": 45}},
        {"Name": "0", "SummaryView": {"Instructions": 2, "TotalCycles": 21}}
    ]}"#;

    #[test]
    fn stores_that_move_their_base_are_taken_apart() {
        assert_eq!(
            apart("str\td4, [x18], #8"),
            "str\td4, [x18]\nadd\tx18, x18, #8"
        );
        assert_eq!(
            apart("stp\tx1, x2, [sp, #-16]!"),
            "add\tsp, sp, #-16\nstp\tx1, x2, [sp]"
        );
        assert_eq!(
            apart("st1\t{ v0.8b }, [x0], x1"),
            "st1\t{ v0.8b }, [x0]\nadd\tx0, x0, x1"
        );
        for line in [
            "str\tq3, [sp, #608]",
            "ldr\td5, [x0], #8",
            "sub\tx8, x5, #6",
        ] {
            assert_eq!(apart(line), line);
        }
    }

    #[test]
    fn cycles_are_read_in_the_order_of_the_paths() {
        assert_eq!(read(REPORT, &[2, 3]).unwrap(), [21.0, 45.0]);
        assert!(read(REPORT, &[2, 3, 1]).is_err(), "one is missing");
        assert!(read(REPORT, &[2, 4]).is_err(), "an instruction is unknown");
    }
}
