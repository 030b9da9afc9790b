//! Stage `global-network`: the global stage's network (section `ALGN`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use anyhow::Result;

/// The network before it is quantized.
pub const NETWORK: &str = "network.checkpoint";

/// How much more often a clean model draws a render seen from the front than one in profile. Faces
/// are mostly seen from the front, which photographs show by themselves.
const CLEAN_FRONT: f32 = 4.0;

/// How it is trained.
pub fn options(context: &Context<'_>) -> align::Options {
    align::Options {
        seed: context.args.seed,
        steps: context.args.steps,
        front: if context.args.clean { CLEAN_FRONT } else { 0.0 },
        ..align::Options::default()
    }
}

/// Makes section and network.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let options = options(context);
    let stage = context.with_faces(Stage::new("global-network", 2).options(&options)?)?;
    context
        .store
        .make(&stage, &[sections::FILE, NETWORK], |folder| {
            let section = align::cascade(context.faces()?, &options, &folder.join(NETWORK))?;
            sections::write(folder, &section)
        })
}
