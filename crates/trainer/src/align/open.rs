//! Opens a cascade while it is being made.

use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember, Refiners};
use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

/// Opens a cascade that is being made: the sections of its global stage, and fine ones where there
/// are some.
pub fn with_model<T>(
    sections: &[&SectionWriter],
    run: impl FnOnce(&AlignModel<'_>) -> Result<T>,
) -> Result<T> {
    let sections: Vec<SectionWriter> = sections.iter().copied().cloned().collect();
    let bytes = AlignedBytes::new(&blob(&sections));
    let opened = Blob::open(&bytes)?;
    run(&AlignModel::open(
        &opened,
        EnsembleMember::open(&opened)?,
        Refiners::open(&opened)?,
    )?)
}
