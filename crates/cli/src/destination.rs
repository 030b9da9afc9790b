//! Output files: written under a temporary name beside the target and renamed at the end, and never
//! over an input or another output.

use std::ffi::OsStr;
use std::fs::Metadata;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};

/// How the names of incomplete files begin; the process and a mark of the name follow.
const TEMPORARY: &str = ".posewise-";
/// Digits and ending of the names of pictures in a folder.
const DIGITS: usize = 6;
const PICTURE: &str = ".png";
/// Longest extension that incomplete files have \[bytes\].
const MAX_EXTENSION: usize = 16;

/// A file that appears under its name when it is complete. Dropped before, it leaves nothing.
pub struct Destination {
    path: PathBuf,
    /// Where it is written; `None` is `path` itself.
    temporary: Option<PathBuf>,
}

impl Destination {
    /// A file of this name. Standard output (`-`), pipes and devices are written as they are.
    pub fn new(path: &Path) -> Self {
        // The target of a link is replaced, not the link.
        let target = std::fs::canonicalize(path).unwrap_or(path.to_path_buf());
        let is_stream = match std::fs::metadata(&target) {
            Ok(found) => !found.is_file(),
            Err(_) => path == Path::new("-"),
        };
        let temporary = target.file_name().filter(|_| !is_stream).map(|name| {
            let start = format!("{TEMPORARY}{}-", std::process::id());
            target.with_file_name(start + &mark(name))
        });
        Destination {
            path: target,
            temporary,
        }
    }

    /// Whether a file is the incomplete one of `path`, of any process.
    pub fn is_temporary(file: &Path, path: &Path) -> bool {
        let names = (file.file_name().and_then(OsStr::to_str), path.file_name());
        let (Some(name), Some(target)) = names else {
            return false;
        };
        let rest = name
            .strip_prefix(TEMPORARY)
            .and_then(|rest| rest.split_once('-'));
        rest.is_some_and(|(process, rest)| process.parse::<u32>().is_ok() && rest == mark(target))
            && file.parent() == path.parent()
    }

    /// Where to write until it is finished.
    pub fn path(&self) -> &Path {
        self.temporary.as_deref().unwrap_or(&self.path)
    }

    /// Gives the file its name.
    pub fn finish(mut self) -> Result<()> {
        let Some(temporary) = self.temporary.take() else {
            return Ok(());
        };
        // A file that was there keeps its permissions, where the system has them.
        if let Ok(old) = std::fs::metadata(&self.path) {
            let _ = std::fs::set_permissions(&temporary, old.permissions());
        }
        std::fs::rename(&temporary, &self.path)
            .with_context(|| format!("cannot write {}", self.path.display()))
    }
}

impl Drop for Destination {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // It may never have been made.
            let _ = std::fs::remove_file(temporary);
        }
    }
}

/// What tells the incomplete file of this name from others, however long it is and whatever bytes
/// it /// has. A short extension stays: it decides the format.
fn mark(name: &OsStr) -> String {
    let digest = Sha256::digest(name.as_encoded_bytes());
    let mut mark: String = digest
        .iter()
        .take(8)
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let extension = Path::new(name).extension().and_then(OsStr::to_str);
    if let Some(extension) = extension.filter(|e| e.len() <= MAX_EXTENSION) {
        mark += &format!(".{extension}");
    }
    mark
}

/// A file that a command reads or writes, and the option that names it.
pub struct Named<'a> {
    /// `--csv`, `INPUT`, …
    pub option: &'a str,
    /// As given.
    pub path: &'a Path,
}

/// Refuses an output that is the same file as an input or as another output, by whatever name or
/// link.
pub fn check(inputs: &[Named<'_>], outputs: &[Named<'_>]) -> Result<()> {
    for (i, output) in outputs.iter().enumerate() {
        let others = inputs.iter().chain(&outputs[..i]);
        if let Some(other) = others
            .into_iter()
            .find(|other| is_same(output.path, other.path))
        {
            bail!(
                "{} {} would overwrite {} {}",
                output.option,
                output.path.display(),
                other.option,
                other.path.display()
            );
        }
    }
    Ok(())
}

/// Whether a file is one of the numbered pictures of a folder.
pub fn is_numbered(file: &Path, folder: &Path) -> bool {
    let name = file.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let number = name.strip_suffix(PICTURE).unwrap_or_default();
    let parent = place(file).parent().map(Path::to_path_buf);
    number.len() >= DIGITS
        && number.bytes().all(|b| b.is_ascii_digit())
        && parent.is_some_and(|parent| is_same(&parent, folder))
}

/// The name of a picture in a folder, from 1.
pub fn numbered(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("{number:0DIGITS$}{PICTURE}"))
}

fn is_same(a: &Path, b: &Path) -> bool {
    match (std::fs::metadata(a), std::fs::metadata(b)) {
        // Devices, as /dev/null, may be given twice.
        (Ok(a), Ok(b)) => (a.is_file() || a.is_dir()) && identity(&a) == identity(&b),
        (Err(_), Err(_)) => place(a) == place(b),
        _ => false,
    }
}

#[cfg(unix)]
fn identity(file: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((file.dev(), file.ino()))
}

#[cfg(not(unix))]
fn identity(file: &Metadata) -> Option<std::time::SystemTime> {
    file.created().ok()
}

/// Where a file that is not there yet would be.
fn place(path: &Path) -> PathBuf {
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let folder = std::fs::canonicalize(folder).unwrap_or(folder.to_path_buf());
    folder.join(path.file_name().unwrap_or(path.as_os_str()))
}
