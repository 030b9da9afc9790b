//! Folders for Android and iOS, with static libraries that are built here: `cargo xtask android`,
//! `cargo xtask ios`.

mod android;
mod ios;
mod objects;

pub use android::{ABIS, android};
pub use ios::{PLATFORMS, ios};
pub use objects::{Contents, contents};

use crate::{Library, notices, root, write};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Files of the repository that both folders hold, and their names in it.
const NOTICES: [(&str, &str); 3] = [
    ("LICENSE", "LICENSE"),
    ("packaging/NOTICES.txt", "NOTICES.txt"),
    ("models/posewise.md", "posewise.md"),
];

/// The library for a machine.
fn library(target: &str, target_dir: &Path) -> Library {
    Library {
        target: Some(target.into()),
        without: Vec::new(),
        target_dir: target_dir.into(),
    }
}

/// The machines for which there is no Rust here.
pub fn missing<'a>(targets: impl Iterator<Item = &'a str>, target_dir: &Path) -> Vec<&'a str> {
    targets
        .filter(|target| !library(target, target_dir).can_be_built())
        .collect()
}

/// An empty folder.
fn empty(folder: &Path) -> Result<()> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).with_context(|| format!("cannot empty {folder:?}"))?;
    }
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create {folder:?}"))
}

/// Copies the licences, written anew, and the data sheet of the model into a folder.
fn copy_notices(folder: &Path) -> Result<()> {
    notices::write()?;
    copy(NOTICES, folder)
}

/// Copies files of the repository into a folder: their paths, and their names there.
fn copy<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>, folder: &Path) -> Result<()> {
    for (from, to) in files {
        let from: PathBuf = root().join(from);
        let contents = std::fs::read(&from).with_context(|| format!("cannot read {from:?}"))?;
        write(&folder.join(to), &contents)?;
    }
    Ok(())
}
