//! Writes the model of all sections, and its data sheet beside it.

use anyhow::{Context, Result};
use posewise_format::{SHEET_TAG, SectionWriter, blob};
use std::path::Path;

/// Writes both; returns the model's size in bytes.
pub fn write(path: &Path, mut sections: Vec<SectionWriter>, sheet: &str) -> Result<usize> {
    let mut info = SectionWriter::new(SHEET_TAG);
    info.array(sheet.as_bytes());
    sections.push(info);
    let bytes = blob(&sections);
    let out = path.display();
    std::fs::write(path, &bytes).with_context(|| format!("writing {out}"))?;
    let sheet = format!("{sheet}\nSize: {} bytes.\n", bytes.len());
    std::fs::write(path.with_extension("md"), sheet)
        .with_context(|| format!("writing the data sheet of {out}"))?;
    Ok(bytes.len())
}
