//! Stage `rotation-regression`: the head's rotation by what the cascade sees (section `ROTN`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use crate::render::Kind;
use anyhow::Result;
use posewise_format::Tag;
use serde::Serialize;

#[derive(Serialize)]
struct Options {
    seed: u64,
}

/// Makes the section for a finished cascade, from renders alone.
pub fn make(context: &Context<'_>, cascade: &[(&Output, Tag); 4]) -> Result<Output> {
    let seed = context.args.seed;
    let plain = context.renders(Kind::Plain)?.hash(super::renders::FILE)?;
    let stage = Stage::new("rotation-regression", 2)
        .options(&Options { seed })?
        .input("renders", plain);
    let stage = context.with_near(sections::with_cascade(stage, cascade)?)?;
    context.store.make(&stage, &[sections::FILE], |folder| {
        let faces = [context.faces()?, context.near()?].concat();
        let section = sections::with_model(cascade, |model| {
            align::rotation_regression::train(model, &faces, seed)
        })?;
        sections::write(folder, &section)
    })
}
