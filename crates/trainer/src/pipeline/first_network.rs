//! Stage `first-network`: the global stage's network (section `ALGN`), trained on the annotators'
//! labels and on renders.

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use anyhow::Result;

/// The network before it is quantized, from which the second round goes on.
pub const NETWORK: &str = "network.checkpoint";

/// How it is trained.
pub fn options(context: &Context<'_>) -> align::Options {
    align::Options {
        seed: context.args.seed,
        steps: context.args.steps,
        occluded: if context.args.clean { 0.25 } else { 0.0 },
        ..align::Options::default()
    }
}

/// Makes section and network.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let options = options(context);
    let stage = context.with_faces(Stage::new("first-network", 1).options(&options)?)?;
    context
        .store
        .make(&stage, &[sections::FILE, NETWORK], |folder| {
            let checkpoint = folder.join(NETWORK);
            let section = align::cascade(context.faces()?, &options, &checkpoint, None)?;
            sections::write(folder, &section)
        })
}
