//! Stage `detector`: boosted trees with hard negatives, and the forest that moves a hit onto the
//! face (section `DTCT`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::detect;
use crate::photographs;
use anyhow::Result;
use serde::Serialize;

/// Rendered profiles that the box refiner learns from beside the photographs, which have none.
const PROFILES: usize = 800;
/// Renders that stand in for photographs where there are none: with more of them the thresholds
/// open.
const FRONTS: usize = 3000;
/// Discard quantile of renders: more of their windows than of photographs' are dark or full of
/// noise.
const DISCARD_QUANTILE_RENDERS: f32 = 0.15;

#[derive(Serialize)]
struct Options {
    detector: detect::Options,
    profiles: usize,
    fronts: Option<usize>,
}

/// Makes the section.
pub fn make(context: &Context<'_>) -> Result<Output> {
    let clean = context.args.clean;
    let mut detector = detect::Options {
        seed: context.args.seed,
        ..detect::Options::default()
    };
    if clean {
        detector.discard_quantile = DISCARD_QUANTILE_RENDERS;
    }
    let options = Options {
        detector,
        profiles: PROFILES,
        fronts: clean.then_some(FRONTS),
    };
    let mut stage = context.with_near(Stage::new("detector", 3).options(&options)?)?;
    if clean {
        stage = context.with_faces(stage)?;
    }
    let stage = context.with_sets(stage, &photographs::UNCROPPED)?;
    let stage = context.with_photographs(stage, &["backgrounds"])?;
    context.store.make(&stage, &[sections::FILE], |folder| {
        let near = context.near()?;
        let mut faces;
        let of_trees = if clean {
            faces = detect::faces::profiles(near, PROFILES);
            faces.extend(detect::faces::fronts(context.faces()?));
            PROFILES + FRONTS
        } else {
            faces = detect::faces::load(&context.args.data, context.args.seed)?;
            faces.extend(detect::faces::profiles(near, PROFILES));
            faces.len()
        };
        let backgrounds = context.backgrounds()?;
        let section = detect::train(&faces, of_trees, &backgrounds, folder, &options.detector)?;
        sections::write(folder, &section)
    })
}
