//! Stage `verifier`: classifiers of faces, of correct and of visible landmarks on the network's
//! features, calibrated out of fold (section `VRFY`).

use super::context::Context;
use super::sections;
use super::stage::Stage;
use super::store::Output;
use crate::verifier;
use anyhow::Result;
use posewise::detect::DetectorModel;
use posewise_format::{AlignedBytes, Blob, Tag, blob};
use serde::Serialize;

/// Least probability of a false positive that it learns from: with the detector's own threshold
/// there would be few in a picture.
const LEAST_PROBABILITY: f32 = 0.05;

#[derive(Serialize)]
struct Options {
    seed: u64,
    least_probability: f32,
}

/// Makes the section for a finished cascade and detector.
pub fn make(
    context: &Context<'_>,
    cascade: &[(&Output, Tag); 4],
    detector: &Output,
) -> Result<Output> {
    let seed = context.args.seed;
    let options = Options {
        seed,
        least_probability: LEAST_PROBABILITY,
    };
    let stage = Stage::new("verifier", 14)
        .options(&options)?
        .input("detector", detector.hash(sections::FILE)?);
    let stage = sections::with_cascade(stage, cascade)?;
    let stage = context.with_backgrounds(context.with_faces(stage)?)?;
    context.store.make(&stage, &[sections::FILE], |folder| {
        let detector = sections::read(&(detector, posewise::detect::TAG))?;
        let detector = AlignedBytes::new(&blob(&[detector]));
        let detector = Blob::open(&detector)?;
        let detector = DetectorModel::open(detector.section(&posewise::detect::TAG)?)?
            .with_threshold(LEAST_PROBABILITY);
        let backgrounds = context.backgrounds()?;
        let section = sections::with_model(cascade, |model| {
            verifier::train(model, &detector, context.faces()?, &backgrounds, seed)
        })?;
        sections::write(folder, &section)
    })
}
