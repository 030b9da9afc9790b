//! Stage `global-network`: the global stage's network (section `ALGN`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::align;
use crate::photographs::Framing;
use anyhow::Result;
use posewise::align::AlignModel;

/// The network before it is quantized.
pub const NETWORK: &str = "network.checkpoint";

/// How much more often renders seen from the front are drawn than profiles where there are no
/// photographs. Faces are mostly seen from the front, which photographs show by themselves.
const FRONT_WITHOUT_PHOTOGRAPHS: f32 = 4.0;

/// Share of renders where no photograph shows a profile: only they do.
const RENDERED_WITHOUT_PROFILES: f32 = 0.6;

/// How it is trained.
pub fn options(context: &Context<'_>) -> align::Options {
    let usual = align::Options::default();
    let has_photographs = context.sources.sets().next().is_some();
    let has_profiles = (context.sources.sets()).any(|set| set.framing == Framing::Half);
    align::Options {
        rendered: match has_profiles {
            true => usual.rendered,
            false => RENDERED_WITHOUT_PROFILES,
        },
        seed: context.args.seed,
        steps: context.args.steps,
        front: if has_photographs {
            0.0
        } else {
            FRONT_WITHOUT_PHOTOGRAPHS
        },
        rate: context.rate(usual.rate),
        aperture: align::Aperture {
            // Apertures count late because landmarks come first; those are trained already.
            from: match context.finished {
                Some(_) => 0.0,
                None => usual.aperture.from,
            },
            ..usual.aperture
        },
        share_of_start: context.args.share_of_from,
        ..usual
    }
}

/// Makes section and network.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let steps = context.args.steps;
    if let Some(kept) = context.kept_stage("global-network-kept", steps, AlignModel::TAG)? {
        return Ok(kept);
    }
    let options = options(context);
    let stage = context.with_faces(Stage::new("global-network", 4).options(&options)?)?;
    let stage = context.with_finished(stage);
    context
        .store
        .make(&stage, &[sections::FILE, NETWORK], |folder| {
            let before = context.section(AlignModel::TAG)?;
            let checkpoint = folder.join(NETWORK);
            let section = align::cascade(context.faces()?, &options, &checkpoint, before)?;
            sections::write(folder, &section)
        })
}
