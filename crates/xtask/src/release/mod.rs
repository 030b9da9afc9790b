//! `cargo xtask release`: everything that can be packed on this machine, with checksums. The same
//! sources give the same bytes.
//!
//! | file | what it packs |
//! |---|---|
//! | `tarball` | `make dist` for each machine |
//! | `languages` | the Python wheels, the JavaScript package, the crates |
//! | `debian` | Debian packages |
//! | `mobile` | the folders for Android and iOS |
//! | `sbom` | the parts of each, in CycloneDX |

mod debian;
mod languages;
mod mobile;
mod sbom;
mod tarball;

pub use languages::CRATES;

use crate::{notices, output_of, root};
use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The list of checksums, in the format of sha256sum.
pub const CHECKSUMS: &str = "SHA256SUMS";

/// Names of the packages, in the order in which they are made.
pub const NAMES: [&str; 8] = [
    "tarballs", "wheels", "npm", "crates", "debian", "android", "ios", "sbom",
];

/// Version of everything in this repository.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What became of a package.
pub enum Outcome {
    /// Files in the folder of packages.
    Made(Vec<PathBuf>),
    /// Why it cannot be made on this machine.
    Skipped(String),
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Outcome::Skipped(why) => write!(f, "skipped: {why}"),
            Outcome::Made(files) => {
                let names = files.iter().filter_map(|path| path.file_name());
                let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
                f.write_str(&names.join(", "))
            }
        }
    }
}

/// Makes packages, all into one folder.
pub struct Packer {
    /// Cargo's build folder.
    target_dir: PathBuf,
    /// Where the packages go.
    folder: PathBuf,
    /// The command where it is built already.
    command: Option<PathBuf>,
    /// The time that packages state in place of the current one: seconds since 1970.
    epoch: String,
}

impl Packer {
    /// A packer whose folder is made, and empty.
    pub fn new(target_dir: &Path, folder: &Path) -> Result<Self> {
        if folder.exists() {
            std::fs::remove_dir_all(folder).with_context(|| format!("cannot empty {folder:?}"))?;
        }
        std::fs::create_dir_all(folder).with_context(|| format!("cannot create {folder:?}"))?;
        // Make would build a program for that, one for each machine's folder.
        notices::write()?;
        // Programs that the packer starts run elsewhere.
        Ok(Self {
            target_dir: std::path::absolute(target_dir)?,
            folder: std::path::absolute(folder)?,
            command: None,
            epoch: epoch()?,
        })
    }

    /// Packs this command in place of building one.
    pub fn with_command(mut self, command: &Path) -> Self {
        self.command = Some(command.into());
        self
    }

    /// Makes packages: all, or those whose names are given. For each, what became of it.
    pub fn pack(&self, only: &[String]) -> Result<Vec<(String, Outcome)>> {
        if let Some(unknown) = only.iter().find(|name| !NAMES.contains(&name.as_str())) {
            bail!("no package {unknown}; there are {}", NAMES.join(", "));
        }
        let mut outcomes = Vec::new();
        for name in NAMES {
            if !only.is_empty() && !only.iter().any(|wanted| wanted == name) {
                continue;
            }
            match name {
                "tarballs" => outcomes.extend(self.tarballs()?),
                "wheels" => outcomes.extend(self.wheels()?),
                _ => outcomes.push((name.to_string(), self.package(name)?)),
            }
        }
        outcomes.push(("checksums".into(), self.checksums()?));
        Ok(outcomes)
    }

    /// Makes one of the packages that are one.
    fn package(&self, name: &str) -> Result<Outcome> {
        match name {
            "npm" => self.npm(),
            "crates" => self.crates(),
            "debian" => self.debian(),
            "android" => self.android(),
            "ios" => self.ios(),
            "sbom" => self.sbom(),
            _ => bail!("no package {name}"),
        }
    }

    /// Lists the SHA-256 of each file in the folder.
    pub fn checksums(&self) -> Result<Outcome> {
        let mut lines = Vec::new();
        for entry in std::fs::read_dir(&self.folder)? {
            let path = entry?.path();
            let name = path.file_name().context("no name")?.to_string_lossy();
            lines.push(format!("{}  {name}\n", sha256(&std::fs::read(&path)?)));
        }
        // By name, which begins after the hash and two blanks.
        lines.sort_by(|a, b| a[66..].cmp(&b[66..]));
        let path = self.folder.join(CHECKSUMS);
        std::fs::write(&path, lines.concat())?;
        Ok(Outcome::Made(vec![path]))
    }

    /// Copies a file into the folder of packages.
    fn take(&self, file: &Path) -> Result<PathBuf> {
        let path = self.folder.join(file.file_name().context("no name")?);
        std::fs::copy(file, &path).with_context(|| format!("cannot copy {file:?}"))?;
        Ok(path)
    }

    /// An empty folder for a package that is being made.
    fn stage(&self, name: &str) -> Result<PathBuf> {
        let stage = self.target_dir.join("package").join(name);
        if stage.exists() {
            std::fs::remove_dir_all(&stage)?;
        }
        std::fs::create_dir_all(&stage)?;
        Ok(stage)
    }

    /// A program that is to take the time of the packages for the current one.
    fn program(&self, name: &str) -> Command {
        let mut command = Command::new(name);
        command.env("SOURCE_DATE_EPOCH", &self.epoch);
        command
    }

    /// `make` with a target of the Makefile, for this build folder and a machine.
    fn make(&self, what: &str, target: Option<&str>) -> Result<Command> {
        let mut make = self.program("make");
        make.args(["--silent", "--directory"]).arg(root());
        make.arg(what);
        make.arg(format!("TARGET_DIR={}", self.target_dir.display()));
        make.arg(match target {
            Some(target) => format!("TARGET={target}"),
            None => format!("COMMAND={}", self.command()?.display()),
        });
        Ok(make)
    }

    /// The command, into which no path of this machine is built.
    fn command(&self) -> Result<PathBuf> {
        if let Some(command) = &self.command {
            return Ok(command.clone());
        }
        let cargo_home = match std::env::var_os("CARGO_HOME") {
            Some(folder) => folder.into(),
            None => std::env::home_dir().context("no home")?.join(".cargo"),
        };
        // Flags reach all crates; with a folder of their own, no other build is made anew by them.
        let folder = self.target_dir.join("command");
        let mut cargo = self.program("cargo");
        cargo.args(["build", "--quiet", "--release", "--bin", "posewise"]);
        cargo.arg("--target-dir").arg(&folder).current_dir(root());
        // Symbols have hashes of cargo's folder in their names, and the linker hashes them.
        let home = cargo_home.display();
        let flags = format!("--remap-path-prefix={home}=cargo -Cstrip=symbols");
        output_of(cargo.env("RUSTFLAGS", flags))?;
        Ok(folder.join("release/posewise"))
    }
}

/// Whether a program can be started.
fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// `SOURCE_DATE_EPOCH`, or else the time of the last commit, or else that of nothing.
fn epoch() -> Result<String> {
    if let Ok(epoch) = std::env::var("SOURCE_DATE_EPOCH") {
        return Ok(epoch);
    }
    let mut git = Command::new("git");
    git.args(["log", "-1", "--format=%ct"]).current_dir(root());
    let Ok(output) = output_of(&mut git) else {
        return Ok(ZIP_EPOCH.into());
    };
    Ok(String::from_utf8(output.stdout)?.trim().into())
}

/// The earliest time that a zip archive can state: 1 January 1980, as the wheel is one.
const ZIP_EPOCH: &str = "315532800";

/// Hexadecimal digits of the SHA-256 of some bytes.
fn sha256(bytes: &[u8]) -> String {
    let hash = Sha256::digest(bytes);
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}
