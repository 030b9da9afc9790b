//! Stage `shape-regression`: each coordinate corrected by a linear map of the whole shape (section
//! `SREG`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember, Refiners};

/// Makes the section for a cascade of these: global network, ensemble member, refiners.
pub fn make(context: &Context<'_>, [global, member, refiners]: [&Output; 3]) -> Result<Output> {
    let stage = Stage::new("shape-regression", 2)
        .input("global-network", global.hash(sections::FILE)?)
        .input("ensemble-member", member.hash(sections::FILE)?)
        .input("refiners", refiners.hash(sections::FILE)?);
    let stage = context.with_near(context.with_faces(stage)?)?;
    context.store.make(&stage, &[sections::FILE], |folder| {
        let faces = [context.faces()?, context.near()?].concat();
        let cascade = [
            (global, AlignModel::TAG),
            (member, EnsembleMember::TAG),
            (refiners, Refiners::TAG),
        ];
        let section = sections::with_model(&cascade, |model| {
            align::shape_regression::train(model, &faces)
        })?;
        sections::write(folder, &section)
    })
}
