//! Sections of the model as outputs of stages.

use super::stage::Stage;
use super::store::Output;
use crate::align;
use anyhow::Result;
use posewise::align::AlignModel;
use posewise_format::{SectionWriter, Tag};
use std::path::Path;

/// The file of a stage that makes a section.
pub const FILE: &str = "section.bin";

/// Writes the section into the stage's folder.
pub fn write(folder: &Path, section: &SectionWriter) -> Result<()> {
    Ok(std::fs::write(folder.join(FILE), section.bytes())?)
}

/// Reads it back.
pub fn read((output, tag): &(&Output, Tag)) -> Result<SectionWriter> {
    Ok(SectionWriter::of_bytes(*tag, output.read(FILE)?))
}

/// The stage with a finished cascade as input: the outputs of its four stages, in their order.
pub fn with_cascade(mut stage: Stage, cascade: &[(&Output, Tag); 4]) -> Result<Stage> {
    let names = [
        "global-network",
        "ensemble-member",
        "refiners",
        "shape-regression",
    ];
    for (name, (output, _)) in names.iter().zip(cascade) {
        stage = stage.input(name, output.hash(FILE)?);
    }
    Ok(stage)
}

/// Opens the cascade of these sections.
pub fn with_model<T>(
    sections: &[(&Output, Tag)],
    run: impl FnOnce(&AlignModel<'_>) -> Result<T>,
) -> Result<T> {
    let sections: Vec<SectionWriter> = sections.iter().map(read).collect::<Result<_>>()?;
    align::with_model(&sections.iter().collect::<Vec<_>>(), run)
}
