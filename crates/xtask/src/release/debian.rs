//! Debian packages: `make install` into a folder, which debhelper splits as `packaging/debian`
//! says.

use super::{Outcome, Packer, exists};
use crate::{output_of, root};
use anyhow::{Context, Result};
use std::path::Path;

impl Packer {
    /// Three packages for this machine: the shared library, what programs are built with, and the
    /// command.
    pub fn debian(&self) -> Result<Outcome> {
        for program in ["dpkg-buildpackage", "dh"] {
            if !exists(program) {
                return Ok(Outcome::Skipped(format!("no {program}")));
            }
        }
        // The packages come beside the folder in which they are built.
        let stage = self.stage("debian")?;
        let build = stage.join("posewise");
        copy(&root().join("packaging/debian"), &build.join("debian"))?;
        let mut make = self.make("install", None)?;
        make.arg(format!("DESTDIR={}", build.join("installed").display()));
        let mut architecture = self.program("dpkg-architecture");
        let triplet = output_of(architecture.arg("-qDEB_HOST_MULTIARCH"))?.stdout;
        make.arg(format!("LIBDIR=lib/{}", String::from_utf8(triplet)?.trim()));
        output_of(make.arg("PREFIX=/usr"))?;
        let mut build_package = self.program("dpkg-buildpackage");
        build_package.args(["--build=binary", "--no-pre-clean"]);
        build_package.args(["--unsigned-changes", "--unsigned-buildinfo"]);
        output_of(build_package.current_dir(&build))?;
        std::fs::remove_dir_all(&build)?;
        let made = std::fs::read_dir(&stage)?.map(|entry| Ok(entry?.path()));
        let mut made: Vec<_> = made.collect::<Result<_>>()?;
        made.retain(|path| path.extension().is_some_and(|ending| ending == "deb"));
        made.sort();
        let taken: Result<Vec<_>> = made.iter().map(|path| self.take(path)).collect();
        Ok(Outcome::Made(taken?))
    }
}

/// Copies the files of a folder without subfolders, with their permissions.
fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from).with_context(|| format!("{from:?}"))? {
        let path = entry?.path();
        if path.is_dir() {
            continue;
        }
        std::fs::copy(&path, to.join(path.file_name().context("no name")?))?;
    }
    Ok(())
}
