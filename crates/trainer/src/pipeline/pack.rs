//! Writes the model of all sections, and its data sheet beside it.

use anyhow::{Context, Result};
use posewise::track::Model;
use posewise_format::{AlignedBytes, SHEET_TAG, SectionWriter, blob};
use std::path::Path;

/// Makes the folder that the model is written to, before hours are spent on it.
pub fn make_folder(path: &Path) -> Result<()> {
    let folder = path.parent().context("a model's name")?;
    std::fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))
}

/// Writes both; returns the model's size in bytes.
pub fn write(path: &Path, mut sections: Vec<SectionWriter>, sheet: &str) -> Result<usize> {
    let mut info = SectionWriter::new(SHEET_TAG);
    info.array(sheet.as_bytes());
    sections.push(info);
    let bytes = blob(&sections);
    Model::load(&AlignedBytes::new(&bytes)).context("the model would not load")?;
    let out = path.display();
    std::fs::write(path, &bytes).with_context(|| format!("writing {out}"))?;
    let sheet = format!("{sheet}\nSize: {} bytes.\n", bytes.len());
    std::fs::write(path.with_extension("md"), sheet)
        .with_context(|| format!("writing the data sheet of {out}"))?;
    Ok(bytes.len())
}
