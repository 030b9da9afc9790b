//! Stage `ensemble-member`: a second network of the global stage, whose predictions are averaged
//! with the first one's (section `ENSM`).

use super::context::Context;
use super::stage::Stage;
use super::store::Output;
use super::{second_round, sections};
use crate::align;
use anyhow::Result;
use posewise::align::AlignModel;

/// Makes the section beside the second round's.
pub fn make(context: &Context<'_>, global: &Output) -> Result<Output> {
    let options = align::Options {
        seed: context.args.seed,
        steps: context.args.steps,
        front: second_round::front(context),
        ..align::Options::default()
    };
    let options = options.ensemble_member();
    let stage = Stage::new("ensemble-member", 1)
        .options(&options)?
        .input("second-round", global.hash(sections::FILE)?);
    let stage = context.with_pseudo_labelled(stage)?;
    context.store.make(&stage, &[sections::FILE], |folder| {
        let global = [(global, AlignModel::TAG)];
        let faces = context.pseudo_labelled(&global)?;
        let checkpoint = folder.join("network.checkpoint");
        let section = sections::with_model(&global, |model| {
            align::ensemble_member(&faces, model.mean(), &options, &checkpoint)
        })?;
        sections::write(folder, &section)
    })
}
