//! `make dist` for each machine that the tests know.

use super::{Outcome, Packer, exists};
use crate::{Library, Machine, output_of};
use anyhow::Result;
use std::path::Path;

/// Machines, by their names in Rust; the first is this one.
const TARGETS: [Option<&str>; 5] = [
    None,
    Some("aarch64-unknown-linux-gnu"),
    Some("armv7-unknown-linux-gnueabihf"),
    Some("thumbv7em-none-eabihf"),
    Some("x86_64-pc-windows-gnu"),
];

impl Packer {
    /// Library and header for each machine; for this one also the command.
    pub(super) fn tarballs(&self) -> Result<Vec<(String, Outcome)>> {
        let make = |target: &Option<&str>| {
            let name = format!("tarball of {}", target.unwrap_or("this machine"));
            Ok((name, self.tarball(*target)?))
        };
        TARGETS.iter().map(make).collect()
    }

    /// The archive of `make dist`.
    pub fn tarball(&self, target: Option<&str>) -> Result<Outcome> {
        if let Some(why) = self.lack(target)? {
            return Ok(Outcome::Skipped(why));
        }
        let output = output_of(&mut self.make("dist", target)?)?;
        let printed = String::from_utf8(output.stdout)?;
        Ok(Outcome::Made(vec![self.take(Path::new(printed.trim()))?]))
    }

    /// What is missing here to build the library for a machine.
    pub(super) fn lack(&self, target: Option<&str>) -> Result<Option<String>> {
        let library = Library {
            target: target.map(String::from),
            without: Vec::new(),
            target_dir: self.target_dir.clone(),
        };
        if !library.can_be_built() {
            return Ok(Some("no Rust for it".into()));
        }
        let compiler = Machine::named(target)?.compiler();
        let compiler = compiler.get_program().to_string_lossy();
        Ok((!exists(&compiler)).then(|| format!("no {compiler}")))
    }
}
