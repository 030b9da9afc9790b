//! Stage `mesh`: the dense mesh of the morphable head (section `MESH`). It depends on the head and
//! the 3D face alone, so that it can be added to a finished model.

use super::data_sheet::{self, MESH_HEADING};
use super::hash::Hash;
use super::sections;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::face_section;
use crate::head::Head;
use crate::mesh::{VERTICES, mesh_section};
use anyhow::{Context, Result};
use posewise::shape::{FACE_TAG, MESH_TAG};
use posewise_format::{AlignedBytes, Blob, SHEET_TAG, SectionWriter, blob};
use std::path::{Path, PathBuf};

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

/// Options of `posewise-train add-mesh`.
#[derive(Clone, Debug, clap::Args)]
pub struct AddArgs {
    /// The finished model.
    #[arg(long)]
    pub model: PathBuf,
    /// The shared data: `facekit.npz`.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for the outputs of stages.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
    /// Where the model with the section goes; its data sheet is written beside it, ending in `.md`.
    #[arg(long)]
    pub out: PathBuf,
}

/// Writes a model with section `MESH` added or replaced; every other section stays as it is.
pub fn add(args: &AddArgs) -> Result<()> {
    let store = Store::open(&args.cache)?;
    let path = args.model.display();
    let bytes = std::fs::read(&args.model).with_context(|| format!("reading {path}"))?;
    let bytes = AlignedBytes::new(&bytes);
    let model = Blob::open(&bytes)?;
    let part = |tag| {
        model
            .sections()
            .find(|(of, _)| *of == tag)
            .map(|(_, bytes)| bytes)
    };
    let face = part(FACE_TAG).context("the model has no 3D face")?;
    let output = make(&store, &args.data, face)?;
    let others = model
        .sections()
        .filter(|(tag, _)| ![MESH_TAG, SHEET_TAG].contains(tag));
    let mut all: Vec<SectionWriter> = others
        .map(|(tag, bytes)| SectionWriter::of_bytes(tag, bytes.to_vec()))
        .collect();
    all.push(sections::read(&(&output, MESH_TAG))?);
    let sheet = std::str::from_utf8(part(SHEET_TAG).unwrap_or_default())?;
    let sheet = data_sheet::with_part(&data_sheet::titled(sheet, &args.out), MESH_HEADING, ABOUT);
    let size = super::pack::write(&args.out, all, &format!("{sheet}\n"))?;
    println!("{}: {size} bytes", args.out.display());
    Ok(())
}

/// What a data sheet says of the section.
const ABOUT: &str = "\
528 vertices of the head facekit above, with its modes, as `posewise-train add-mesh` adds them to a
finished model; nothing was trained for it.";

/// The same for a whole model.
pub fn about() -> String {
    format!("{MESH_HEADING}{ABOUT}")
}
