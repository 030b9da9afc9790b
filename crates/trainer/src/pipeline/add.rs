//! Adds a section to a finished model; every other section stays as it is.

use super::{data_sheet, pack};
use anyhow::{Context, Result};
use posewise_format::{AlignedBytes, Blob, SHEET_TAG, SectionWriter, Tag};
use std::path::{Path, PathBuf};

/// Where the model is, and where it goes with the section.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The finished model.
    #[arg(long)]
    pub model: PathBuf,
    /// The shared data: `facekit.npz`, `free/`.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for the outputs of stages.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
    /// Where the model with the section goes; its data sheet is written beside it, ending in `.md`.
    #[arg(long)]
    pub out: PathBuf,
}

/// A section that is new, and what the data sheet says of it below a heading.
pub struct Added<'a> {
    pub tag: Tag,
    pub section: SectionWriter,
    pub heading: &'a str,
    pub about: &'a str,
}

/// The bytes of a model file.
pub fn read(path: &Path) -> Result<AlignedBytes> {
    let bytes = std::fs::read(path).with_context(|| format!("reading {}", path.display()))?;
    Ok(AlignedBytes::new(&bytes))
}

/// Writes a model with a section added or replaced, and its data sheet beside it.
pub fn write(model: &Blob<'_>, added: &Added<'_>, out: &Path) -> Result<()> {
    let sheet = part(model, SHEET_TAG).unwrap_or_default();
    let sheet = data_sheet::titled(std::str::from_utf8(sheet)?, out);
    let sheet = data_sheet::with_part(&sheet, added.heading, added.about);
    let mut sections = SectionWriter::all_but(&[added.tag, SHEET_TAG], model);
    sections.push(added.section.clone());
    let size = pack::write(out, sections, &format!("{sheet}\n"))?;
    println!("{}: {size} bytes", out.display());
    Ok(())
}

/// The bytes of a model's section.
pub fn part<'b>(model: &Blob<'b>, wanted: Tag) -> Option<&'b [u8]> {
    let found = model.sections().find(|(tag, _)| *tag == wanted);
    found.map(|(_, bytes)| bytes)
}
