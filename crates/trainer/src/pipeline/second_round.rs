//! Stage `second-round`: the first network goes on with pseudo-labelled photographs, hard renders
//! and occlusions (section `ALGN`).

use super::context::Context;
use super::stage::Stage;
use super::store::Output;
use super::{first_network, renders, sections};
use crate::align::{self, Options};
use anyhow::Result;
use posewise::align::AlignModel;

/// The network before it is quantized.
pub const NETWORK: &str = "network.checkpoint";

/// How it is trained.
pub fn options(context: &Context<'_>) -> Options {
    Options {
        seed: context.args.seed ^ 0x5eed,
        front: front(context),
        ..first_network::options(context).second_round()
    }
}

/// How much more often a render seen from the front is drawn. Faces are mostly seen from the front,
/// which photographs show by themselves.
pub fn front(context: &Context<'_>) -> f32 {
    if context.args.clean { 4.0 } else { 0.0 }
}

/// Makes section and network.
pub fn make(context: &Context<'_>, first: &Output) -> Result<Output> {
    let options = options(context);
    let mut stage = Stage::new("second-round", 1)
        .options(&options)?
        .input("first-network", first.hash(sections::FILE)?)
        .input(
            "first-network checkpoint",
            first.hash(first_network::NETWORK)?,
        );
    if let Some(hard) = &context.hard {
        stage = stage.input("renders-hard", hard.hash(renders::FILE)?);
    }
    let stage = context.with_pseudo_labelled(stage)?;
    context
        .store
        .make(&stage, &[sections::FILE, NETWORK], |folder| {
            let mut faces = context.pseudo_labelled(&[(first, AlignModel::TAG)])?;
            faces.extend(context.hard()?);
            let before = first.path(first_network::NETWORK);
            let section = align::cascade(&faces, &options, &folder.join(NETWORK), Some(&before))?;
            sections::write(folder, &section)
        })
}
