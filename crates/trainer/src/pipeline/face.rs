//! Stage `face`: the 3D face that the tracker fits (section `FACE`), quantized.

use super::args::Args;
use super::stage::Stage;
use super::store::{Output, Store};
use super::{fits, sections};
use crate::face_section::face_section;
use crate::head::{CONVENTION_VERSION, Head, Wfm};
use anyhow::Result;

/// Makes the section from the wireframe, or from the morphable head with its landmarks where the
/// fits have them, or without fits by the convention.
pub fn make(store: &Store, args: &Args, fits: Option<&Output>) -> Result<Output> {
    let kit = args.data.join("facekit.npz");
    let mut stage = Stage::new("face", 1);
    match (&args.wireframe, fits) {
        (Some(path), _) => stage = stage.input("wireframe", store.data(path)?),
        (None, Some(fits)) => stage = stage.input("fits", fits.hash(fits::FILE)?),
        (None, None) => stage = stage.options(&CONVENTION_VERSION)?,
    }
    if args.wireframe.is_none() {
        stage = stage.input("facekit.npz", store.data(&kit)?);
    }
    store.make(&stage, &[sections::FILE], |folder| {
        let section = if let Some(path) = &args.wireframe {
            face_section(&Head::of_wfm(&Wfm::read(path)?)?, None)?
        } else {
            let head = Head::load(&kit)?;
            let offsets_mm = match fits {
                Some(fits) => fits::read(fits)?.offsets_mm,
                None => head.conventional_offsets_mm(),
            };
            face_section(&head, Some(&offsets_mm))?
        };
        sections::write(folder, &section)
    })
}
