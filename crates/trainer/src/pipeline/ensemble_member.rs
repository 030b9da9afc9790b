//! Stage `ensemble-member`: a second network of the global stage, whose predictions are
//! averaged with those of the first (section `ENSM`).

use super::context::Context;
use super::stage::Stage;
use super::store::Output;
use super::{global_network, sections};
use crate::align;
use anyhow::Result;

/// Makes the section.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let options = global_network::options(context).ensemble_member();
    let stage = context.with_faces(Stage::new("ensemble-member", 3).options(&options)?)?;
    context.store.make(&stage, &[sections::FILE], |folder| {
        let checkpoint = folder.join(global_network::NETWORK);
        let section = align::ensemble_member(context.faces()?, &options, &checkpoint)?;
        sections::write(folder, &section)
    })
}
