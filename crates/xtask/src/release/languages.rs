//! Packages for the package managers of Python, JavaScript and Rust.

use super::{Outcome, Packer, VERSION, exists};
use crate::{output_of, root, web};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Crates that are published, in this order.
pub const CRATES: [&str; 4] = [
    "posewise-format",
    "posewise",
    "posewise-metrics",
    "posewise-cli",
];

/// Machines that wheels are made for, beside this one, by their names in Rust.
const OTHERS: [&str; 1] = ["aarch64-unknown-linux-gnu"];

/// What a Python needs to build the wheel; setuptools wants to be the first.
const WHEEL_NEEDS: &str = "import setuptools, pip, wheel";

impl Packer {
    /// A wheel for each machine.
    pub(super) fn wheels(&self) -> Result<Vec<(String, Outcome)>> {
        let is_other = |target: &&str| !target.starts_with(std::env::consts::ARCH);
        let others = OTHERS.into_iter().filter(is_other).map(Some);
        let make = |target: Option<&str>| {
            let name = format!("wheel of {}", target.unwrap_or("this machine"));
            Ok((name, self.wheel(target)?))
        };
        std::iter::once(None).chain(others).map(make).collect()
    }

    /// The wheel for a machine, by the Python that `POSEWISE_PYTHON` names or else `python3`.
    pub fn wheel(&self, target: Option<&str>) -> Result<Outcome> {
        let python = std::env::var("POSEWISE_PYTHON").unwrap_or("python3".into());
        let asked = Command::new(&python).args(["-c", WHEEL_NEEDS]).output();
        if !asked.is_ok_and(|output| output.status.success()) {
            let why = format!("no {python} that can `{WHEEL_NEEDS}`");
            return Ok(Outcome::Skipped(why));
        }
        if let Some(why) = self.lack(target)? {
            return Ok(Outcome::Skipped(why));
        }
        // What an earlier build left there would be packed, too.
        let left = root().join("python/build");
        if left.exists() {
            std::fs::remove_dir_all(&left).with_context(|| format!("cannot remove {left:?}"))?;
        }
        let stage = self.stage("wheel")?;
        let mut pip = self.program(&python);
        pip.args(["-m", "pip", "--quiet", "--disable-pip-version-check"]);
        pip.args(["wheel", "--no-deps", "--no-index", "--no-build-isolation"]);
        pip.env("CARGO_TARGET_DIR", &self.target_dir);
        if let Some((machine, _)) = target.and_then(|target| target.split_once('-')) {
            pip.env("_PYTHON_HOST_PLATFORM", format!("linux-{machine}"));
        }
        output_of(
            pip.arg("--wheel-dir")
                .arg(&stage)
                .arg(root().join("python")),
        )?;
        self.take_all(&stage)
    }

    /// What `npm publish` would upload.
    pub fn npm(&self) -> Result<Outcome> {
        if !exists("npm") {
            return Ok(Outcome::Skipped("no npm".into()));
        }
        if !web::can_be_built(&self.target_dir) {
            let why = "no Rust for WebAssembly (rustup target add wasm32-unknown-unknown)";
            return Ok(Outcome::Skipped(why.into()));
        }
        self.npm_of(&web::build(&self.target_dir)?)
    }

    /// The same of a package that is built, and gets its types.
    pub fn npm_of(&self, package: &Path) -> Result<Outcome> {
        if !web::declarations(package)? {
            return Ok(Outcome::Skipped(
                "no TypeScript (npm ci --prefix web)".into(),
            ));
        }
        let stage = self.stage("npm")?;
        let mut npm = self.program("npm");
        npm.args(["pack", "--silent", "--offline", "--pack-destination"]);
        output_of(npm.arg(&stage).current_dir(package))?;
        self.take_all(&stage)
    }

    /// What `cargo publish` would upload.
    pub fn crates(&self) -> Result<Outcome> {
        let mut cargo = self.program("cargo");
        cargo.args(["package", "--quiet", "--allow-dirty", "--no-verify"]);
        cargo.arg("--target-dir").arg(&self.target_dir);
        for name in CRATES {
            cargo.args(["--package", name]);
        }
        output_of(cargo.current_dir(root()))?;
        let file = |name| {
            let name = format!("{name}-{VERSION}.crate");
            self.take(&self.target_dir.join("package").join(name))
        };
        let made: Result<Vec<_>> = CRATES.map(file).into_iter().collect();
        Ok(Outcome::Made(made?))
    }

    /// Copies all files of a folder into the folder of packages.
    pub(super) fn take_all(&self, stage: &Path) -> Result<Outcome> {
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(stage)? {
            paths.push(entry?.path());
        }
        paths.sort();
        let made: Result<Vec<PathBuf>> = paths.iter().map(|path| self.take(path)).collect();
        Ok(Outcome::Made(made?))
    }
}
