//! Zip archives whose bytes follow from the files in them.

use anyhow::{Context, Result};
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use zip::write::{SimpleFileOptions, ZipWriter};
use zip::{CompressionMethod, DateTime};

/// Packs the files of a folder, with paths from there. Each is of 1 January 1980.
pub fn zip(folder: &Path, archive: &Path) -> Result<()> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    files.sort();
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut out = ZipWriter::new(File::create(archive)?);
    for path in files {
        let name = path.strip_prefix(folder)?.to_str().context("no UTF-8")?;
        out.start_file(name, options)?;
        let mut contents = Vec::new();
        File::open(&path)?.read_to_end(&mut contents)?;
        out.write_all(&contents)?;
    }
    out.finish()?;
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| format!("cannot read {folder:?}"))? {
        let path = entry?.path();
        match path.is_dir() {
            true => collect(&path, files)?,
            false => files.push(path),
        }
    }
    Ok(())
}
