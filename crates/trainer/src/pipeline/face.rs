//! Stage `face`: the 3D face that the tracker fits (section `FACE`), quantized.

use super::args::Args;
use super::stage::Stage;
use super::store::{Output, Store};
use super::{fits, sections};
use crate::face_section::face_section;
use crate::head::{CONVENTION_VERSION, Head, Labels, MARKS_VERSION, MESH_MARKS_VERSION};
use crate::head::{Wfm, marks_mm};
use anyhow::Result;
use glam::Vec3;

/// Makes the section from the wireframe, or from the morphable head with its landmarks where the
/// fits have them, or without fits by the convention.
pub fn make(
    store: &Store,
    args: &Args,
    fits: Option<&Output>,
    labels: Option<Labels>,
) -> Result<Output> {
    let kit = args.data.join("facekit.npz");
    let mut stage = Stage::new("face", 1);
    match (&args.wireframe, fits) {
        (Some(path), _) => stage = stage.input("wireframe", store.data(path)?),
        (None, Some(fits)) => {
            stage = stage.input("fits", fits.hash(fits::FILE)?);
            if labels.is_some() {
                stage = stage.options(&("frontal", MESH_MARKS_VERSION))?;
            }
        }
        (None, None) => stage = stage.options(&("frontal", CONVENTION_VERSION, MARKS_VERSION))?,
    }
    if args.wireframe.is_none() {
        stage = stage.input("facekit.npz", store.data(&kit)?);
    }
    store.make(&stage, &[sections::FILE], |folder| {
        let section = if let Some(path) = &args.wireframe {
            face_section(&Head::of_wfm(&Wfm::read(path)?)?, None)?
        } else {
            let head = Head::load(&kit)?;
            let mut offsets_mm = match fits {
                Some(fits) => fits::read(fits)?.offsets_mm,
                None => head.conventional_offsets_mm(),
            };
            if let Some(labels) = labels {
                add_marks(&mut offsets_mm, labels);
            }
            face_section(&head, Some(&offsets_mm))?
        };
        sections::write(folder, &section)
    })
}

/// Adds those of where people mark landmarks, in the frontal view. Along the line of sight these
/// make up for landmarks that turn less than the head does, which the pose must not.
fn add_marks(offsets_mm: &mut [[f32; 3]], labels: Labels) {
    for (offset, mark) in offsets_mm.iter_mut().zip(marks_mm(labels)) {
        *offset = (Vec3::from(*offset) + mark.with_z(0.0)).into();
    }
}
