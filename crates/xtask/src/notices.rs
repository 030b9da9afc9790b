//! The licences of what is linked into the library and into the command, for packages.

use crate::root;
use anyhow::{Context, Result, bail, ensure};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The notices of one product.
pub struct Notices {
    /// Where they are.
    pub file: &'static str,
    package: &'static str,
    features: &'static str,
    what: &'static str,
}

/// The products that packages hold.
pub const NOTICES: [Notices; 2] = [
    Notices {
        file: "packaging/NOTICES.txt",
        package: "posewise",
        features: "ffi",
        what: "library",
    },
    Notices {
        file: "packaging/NOTICES-command.txt",
        package: "posewise-cli",
        features: "default",
        what: "command",
    },
];

/// Files of a licence in a crate, the wanted ones first: of a choice, MIT.
const LICENCES: [&str; 8] = [
    "LICENSE-MIT",
    "LICENSE-MIT.md",
    "MIT-LICENSE",
    "LICENSE.txt",
    "LICENSE",
    "LICENSE.md",
    "LICENSE-BOOST",
    "LICENSE-ZLIB.md",
];

/// Writes the files, each under another name first: several may do so at a time.
pub fn write() -> Result<()> {
    for notices in &NOTICES {
        let path = root().join(notices.file);
        // Another process, or another test in this one, may write it too.
        let (process, thread) = (std::process::id(), std::thread::current().id());
        let partial = path.with_extension(format!("{process}-{thread:?}"));
        std::fs::write(&partial, notices.text()?)?;
        std::fs::rename(partial, path)?;
    }
    Ok(())
}

impl Notices {
    /// What the file holds.
    pub fn text(&self) -> Result<String> {
        let mut out = format!(
            "The posewise {} is under the MIT License, see LICENSE. These crates are linked into \
             it. Where a\ncrate lets the user choose among licences, the MIT License is chosen.\n",
            self.what
        );
        for (text, crates) in by_text(linked(self.package, self.features)?)? {
            let line = "-".repeat(80);
            write!(
                out,
                "\n{line}\n{}\n{line}\n\n{}\n",
                crates.join(", "),
                text.trim()
            )?;
        }
        Ok(out)
    }
}

/// The crates under each text of a licence.
fn by_text(names: BTreeSet<String>) -> Result<BTreeMap<String, Vec<String>>> {
    let mut by_text: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for name in names {
        let folder = sources(&name)?;
        let text = licence(&folder).with_context(|| name.clone())?;
        by_text.entry(text).or_default().push(name);
    }
    Ok(by_text)
}

/// Names with versions of the crates that a package is made of, those of this repository left out.
pub(crate) fn linked(package: &str, features: &str) -> Result<BTreeSet<String>> {
    let mut tree = cargo("tree");
    tree.args(["--package", package, "--edges", "normal,no-proc-macro"]);
    tree.args([
        "--features",
        features,
        "--prefix",
        "none",
        "--format",
        "{p}",
    ]);
    let list = output(&mut tree)?;
    let name = |line: &str| {
        let mut words = line.split_whitespace();
        let (name, version) = (words.next()?, words.next()?.trim_start_matches('v'));
        (!name.starts_with("posewise")).then(|| format!("{name} {version}"))
    };
    Ok(list.lines().filter_map(name).collect())
}

/// Where cargo keeps the sources of a crate, given as `NAME VERSION`. `cargo metadata` would say it
/// too, but downloads what only other packages of the workspace need.
fn sources(name: &str) -> Result<PathBuf> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(std::env::home_dir()?.join(".cargo")));
    let registries = home.context("no CARGO_HOME")?.join("registry/src");
    let folder = name.replace(' ', "-");
    for registry in std::fs::read_dir(&registries).with_context(|| format!("{registries:?}"))? {
        let sources = registry?.path().join(&folder);
        if sources.exists() {
            return Ok(sources);
        }
    }
    bail!("no sources of {name} in {registries:?}");
}

/// The text of a crate's licence, or its name in Cargo.toml where the crate has no text.
fn licence(folder: &Path) -> Result<String> {
    let mut files = LICENCES.iter().map(|name| folder.join(name));
    let Some(file) = files.find(|path| path.is_file()).or(any(folder)?) else {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml"))?;
        let mut named = manifest
            .lines()
            .filter_map(|l| l.strip_prefix("license = \""));
        let name = named.next().context("it names no licence")?;
        let name = name.trim_end_matches('"');
        return Ok(format!("{name} (the crate holds no text)"));
    };
    let text = std::fs::read_to_string(file)?;
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    Ok(lines.join("\n"))
}

/// The first file of a crate whose name says that it is a licence.
fn any(folder: &Path) -> Result<Option<PathBuf>> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_ascii_uppercase();
        let name = name.to_string_lossy();
        if path.is_file()
            && ["LICENSE", "LICENCE", "COPYING"]
                .iter()
                .any(|n| name.starts_with(n))
        {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths.into_iter().next())
}

fn cargo(subcommand: &str) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args([subcommand, "--locked"]).current_dir(root());
    cargo
}

fn output(command: &mut Command) -> Result<String> {
    let output = command.output()?;
    let why = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{command:?}: {why}");
    Ok(String::from_utf8(output.stdout)?)
}
