//! Stage `shape-regression`: each coordinate corrected by a linear map of the whole shape (section
//! `SREG`). Where people set no label, this is where landmarks go to where people mark them.

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use crate::faces::Face;
use crate::head::{Labels, MARKS_VERSION, MESH_MARKS_VERSION};
use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember, Refiners, ShapeRegression};

/// Makes the section for a cascade of these: global network, ensemble member, refiners. Where all
/// are kept, that of the finished model stays as it is.
pub fn make(context: &Context<'_>, [global, member, refiners]: [&Output; 3]) -> Result<Output> {
    let steps = context.args.steps + super::refiners::steps(context.args);
    if let Some(kept) = context.kept_stage("shape-regression-kept", steps, ShapeRegression::TAG)? {
        return Ok(kept);
    }
    let stage = Stage::new("shape-regression", 5)
        .input("global-network", global.hash(sections::FILE)?)
        .input("ensemble-member", member.hash(sections::FILE)?)
        .input("refiners", refiners.hash(sections::FILE)?);
    let mut stage = context.with_near(context.with_faces(stage)?)?;
    let labels = context.sources.labels();
    stage = match labels {
        None => stage,
        Some(Labels::Convention) => stage.options(&("facing", MARKS_VERSION))?,
        Some(Labels::FaceMesh) => stage.options(&("face mesh", MESH_MARKS_VERSION))?,
    };
    let label = |face: &Face| labels.map_or(face.landmarks, |labels| face.marked(labels));
    context.store.make(&stage, &[sections::FILE], |folder| {
        let faces = [context.faces()?, context.near()?].concat();
        let cascade = [
            (global, AlignModel::TAG),
            (member, EnsembleMember::TAG),
            (refiners, Refiners::TAG),
        ];
        let section = sections::with_model(&cascade, |model| {
            align::shape_regression::train(model, &faces, &label)
        })?;
        sections::write(folder, &section)
    })
}
