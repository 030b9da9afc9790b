//! Stage `detector`: the network that finds faces in tiles (section `DTCT`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::detect::pictures::{Kind, Pictures};
use crate::detect::{self, faces};
use crate::photographs::Framing;
use anyhow::Result;
use posewise::detect::TAG;
use serde::Serialize;

/// Most renders near profile, and close-up renders near profile and from the front.
const PROFILES: usize = 8_000;
const NEAR_PROFILES: usize = 2_000;
const NEAR_FRONTS: usize = 1_000;
/// Most renders from the front.
const FRONTS: usize = 8_000;
/// Procedural scenes beside the photographs without people.
const MADE_UP: u64 = 60;

#[derive(Serialize)]
struct Options {
    detector: detect::Options,
    profiles: [usize; 2],
    fronts: [usize; 2],
}

/// Makes the section; with no batches, that of the finished model stays as it is.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let steps = context.args.detector_steps;
    if let Some(kept) = context.kept_stage("detector-kept", steps, TAG)? {
        return Ok(kept);
    }
    let usual = detect::Options::default();
    let options = Options {
        detector: detect::Options {
            seed: context.args.seed,
            steps,
            rate: context.rate(usual.rate),
            ..usual
        },
        profiles: [PROFILES, NEAR_PROFILES],
        fronts: [FRONTS, NEAR_FRONTS],
    };
    let stage = context.with_near(Stage::new("detector", 7).options(&options)?)?;
    let stage = context.with_backgrounds(context.with_faces(stage)?)?;
    let stage = context.with_finished(stage);
    context.store.make(&stage, &[sections::FILE], |folder| {
        let pictures = pictures(context)?;
        println!(
            "detector: {:?} faces and pictures without",
            pictures.count()
        );
        let before = context.section(TAG)?;
        let section = detect::train(&pictures, folder, &options.detector, before)?;
        sections::write(folder, &section)
    })
}

fn pictures(context: &Context<'_>) -> Result<Pictures> {
    let mut all = vec![];
    for set in context.sources.sets() {
        let kind = match set.framing {
            Framing::Whole => Kind::Photograph,
            Framing::Tight => Kind::Crop,
            Framing::Half => Kind::HalfLabelled,
        };
        let faces = faces::of_photographs(context.photographed(&set)?);
        all.extend(faces.into_iter().map(|face| (kind, face)));
    }
    let plain = context.plain()?;
    let near = context.near()?;
    let renders = [
        faces::profiles(&plain, PROFILES),
        faces::fronts(&plain, FRONTS),
        faces::profiles(near, NEAR_PROFILES),
        faces::fronts(near, NEAR_FRONTS),
    ];
    let renders = renders.into_iter().flatten();
    all.extend(renders.map(|face| (Kind::Render, face)));
    let mut backgrounds = context.backgrounds()?;
    if context.sources.has_backgrounds() {
        backgrounds.extend(detect::backgrounds::made_up(context.args.seed, MADE_UP));
    }
    Ok(Pictures::new(all, backgrounds))
}
