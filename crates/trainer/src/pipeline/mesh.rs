//! Stage `mesh`: the dense mesh of the morphable head (section `MESH`). It depends on the head and
//! the 3D face alone, so that it can be added to a finished model.

use super::add::{self, Added};
use super::data_sheet::MESH_HEADING;
use super::hash::Hash;
use super::sections;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::face_section;
use crate::head::Head;
use crate::mesh::{VERTICES, mesh_section};
use anyhow::{Context, Result};
use posewise::shape::{FACE_TAG, MESH_TAG};
use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};
use std::path::Path;

/// Makes the section that belongs to this section `FACE`.
pub fn make(store: &Store, data: &Path, face: &[u8]) -> Result<Output> {
    let kit = data.join("facekit.npz");
    let stage = Stage::new("mesh", 3)
        .options(&VERTICES)?
        .input("face", Hash::of(face))
        .input("facekit.npz", store.data(&kit)?);
    store.make(&stage, &[sections::FILE], |folder| {
        let alone = blob(&[SectionWriter::of_bytes(FACE_TAG, face.to_vec())]);
        let alone = AlignedBytes::new(&alone);
        let face = face_section::open(&Blob::open(&alone)?)?;
        sections::write(folder, &mesh_section(&Head::load(&kit)?, &face)?)
    })
}

/// Writes a model with section `MESH` added or replaced: `posewise-train add-mesh`.
pub fn add(args: &add::Args) -> Result<()> {
    let store = Store::open(&args.cache)?;
    let bytes = add::read(&args.model)?;
    let model = Blob::open(&bytes)?;
    let face = add::part(&model, FACE_TAG).context("the model has no 3D face")?;
    let output = make(&store, &args.data, face)?;
    let added = Added {
        tag: MESH_TAG,
        section: sections::read(&(&output, MESH_TAG))?,
        heading: MESH_HEADING,
        about: ABOUT,
    };
    add::write(&model, &added, &args.out)
}

/// What a data sheet says of the section.
const ABOUT: &str = "\
528 vertices of the head facekit above, with its modes, as `posewise-train add-mesh` adds them to a
finished model; nothing was trained for it.";

/// The same for a whole model.
pub fn about() -> String {
    format!("{MESH_HEADING}{ABOUT}")
}
