//! The licences of what is linked into the library and into the command, for packages.

use crate::root;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
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
        let partial = path.with_extension(std::process::id().to_string());
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
    let crates = crates()?;
    let mut by_text: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for name in names {
        let of = crates.get(&name);
        let of = of.with_context(|| format!("no sources of {name}"))?;
        let text = licence(of).with_context(|| name.clone())?;
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

/// A crate whose licence is wanted.
struct Crate {
    folder: PathBuf,
    /// The names of its licences, as its Cargo.toml has them.
    licences: String,
}

/// All crates by name and version.
fn crates() -> Result<BTreeMap<String, Crate>> {
    let metadata: Value =
        serde_json::from_str(&output(cargo("metadata").args(["--format-version", "1"]))?)?;
    let packages = metadata["packages"].as_array().context("no packages")?;
    let described = |package: &Value| {
        let text = |key: &str| package[key].as_str().map(str::to_owned);
        let manifest = PathBuf::from(text("manifest_path")?);
        let name = format!("{} {}", text("name")?, text("version")?);
        let folder = manifest.parent()?.to_owned();
        let licences = text("license").unwrap_or_default();
        Some((name, Crate { folder, licences }))
    };
    Ok(packages.iter().filter_map(described).collect())
}

/// The text of a crate's licence, or its name where the crate has no text.
fn licence(of: &Crate) -> Result<String> {
    let file = LICENCES.iter().map(|name| of.folder.join(name));
    let Some(file) = file
        .into_iter()
        .find(|path| path.is_file())
        .or(any(&of.folder)?)
    else {
        ensure!(!of.licences.is_empty(), "it names no licence");
        return Ok(format!("{} (the crate holds no text)", of.licences));
    };
    let text = std::fs::read_to_string(file)?;
    Ok(text
        .lines()
        .map(str::trim_end)
        .collect::<Vec<_>>()
        .join("\n"))
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
