//! Stage `shape-regression`: each coordinate corrected by a linear map of the whole shape (section
//! `SREG`). Without photographs, this is where landmarks go to where people mark them.

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use crate::faces::Face;
use crate::head::MARKS_VERSION;
use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember, Refiners, Shape};

/// Makes the section for a cascade of these: global network, ensemble member, refiners.
pub fn make(context: &Context<'_>, [global, member, refiners]: [&Output; 3]) -> Result<Output> {
    let stage = Stage::new("shape-regression", 4)
        .input("global-network", global.hash(sections::FILE)?)
        .input("ensemble-member", member.hash(sections::FILE)?)
        .input("refiners", refiners.hash(sections::FILE)?);
    let mut stage = context.with_near(context.with_faces(stage)?)?;
    let mut label: fn(&Face) -> Shape = |face| face.landmarks;
    if context.sources.sets().next().is_none() {
        stage = stage.options(&("facing", MARKS_VERSION))?;
        label = Face::marked;
    }
    context.store.make(&stage, &[sections::FILE], |folder| {
        let faces = [context.faces()?, context.near()?].concat();
        let cascade = [
            (global, AlignModel::TAG),
            (member, EnsembleMember::TAG),
            (refiners, Refiners::TAG),
        ];
        let section = sections::with_model(&cascade, |model| {
            align::shape_regression::train(model, &faces, label)
        })?;
        sections::write(folder, &section)
    })
}
