//! Stage `ensemble-member`: a second network of the global stage, whose predictions are
//! averaged with those of the first (section `ENSM`).

use super::context::Context;
use super::stage::Stage;
use super::store::Output;
use super::{global_network, sections};
use crate::align;
use anyhow::Result;
use posewise::align::{AlignModel, EnsembleMember};

/// Makes the section.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let steps = context.args.steps;
    if let Some(kept) = context.kept_stage("ensemble-member-kept", steps, EnsembleMember::TAG)? {
        return Ok(kept);
    }
    let options = global_network::options(context).ensemble_member();
    let stage = context.with_faces(Stage::new("ensemble-member", 5).options(&options)?)?;
    let stage = context.with_finished(stage);
    context.store.make(&stage, &[sections::FILE], |folder| {
        let checkpoint = folder.join(global_network::NETWORK);
        let before = context.section(EnsembleMember::TAG)?;
        let faces = context.faces()?;
        let mean = match context.section(AlignModel::TAG)? {
            Some(mut section) => align::global::shapes(&mut section)?.0,
            None => align::mean_shape(faces),
        };
        let section = align::ensemble_member(faces, &mean, &options, &checkpoint, before)?;
        sections::write(folder, &section)
    })
}
