//! Stage `refiners`: networks of eyes with brows, of the mouth and of the lids (section `RFIN`).

use super::args::Args;
use super::context::Context;
use super::stage::Stage;
use super::store::Output;
use super::{global_network, sections};
use crate::align;
use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember, Refiners};

/// Batches that a refiner is trained on.
pub fn steps(args: &Args) -> usize {
    args.refiner_steps.unwrap_or(args.steps / 2)
}

/// Makes the section for a global stage of these two networks; with no batches, that of the
/// finished model stays as it is.
pub fn make(context: &Context<'_>, global: &Output, member: &Output) -> Result<Output> {
    let args = context.args;
    if let Some(kept) = context.kept_stage("refiners-kept", steps(args), Refiners::TAG)? {
        return Ok(kept);
    }
    let mut options = align::refiners::options(args.seed, steps(args));
    options.rate = global_network::options(context).rate;
    let stage = Stage::new("refiners", 5)
        .options(&options)?
        .input("global-network", global.hash(sections::FILE)?)
        .input("ensemble-member", member.hash(sections::FILE)?);
    let stage = context.with_near(context.with_faces(stage)?)?;
    let mut stage = context.with_finished(stage);
    let has_eyes = context.sources.has_single_eyes();
    if has_eyes {
        stage = stage.input("eyes", context.store.data(&context.data("eyes"))?);
    }
    context.store.make(&stage, &[sections::FILE], |folder| {
        let global = [(global, AlignModel::TAG), (member, EnsembleMember::TAG)];
        let faces = [context.faces()?, context.near()?].concat();
        let eyes = context.data("eyes");
        let [first, second] = [sections::read(&global[0])?, sections::read(&global[1])?];
        let training = align::refiners::Training {
            global: [&first, &second],
            faces: &faces,
            eyes: has_eyes.then_some(&eyes),
            before: context.section(Refiners::TAG)?,
            options: &options,
            checkpoints: folder,
        };
        sections::write(folder, &training.run()?)
    })
}
