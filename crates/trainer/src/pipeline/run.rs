//! Runs all stages in order.

use super::add::{self, Added};
use super::args::{Args, Until};
use super::context::Context;
use super::store::Store;
use super::{
    data_sheet, detector, ensemble_member, face, fits, global_network, mesh, pack, refiners,
    rotation_regression, sections, shape_regression, verifier,
};
use crate::render::Kind;
use anyhow::Result;
use posewise::align::{
    AlignModel, EYES_TAG, EnsembleMember, Refiners, RotationRegression, ShapeRegression,
    WEIGHTS_TAG,
};
use posewise::detect;
use posewise::shape::{FACE_TAG, MESH_TAG};
use posewise::verifier::Verifier;
use posewise_format::Blob;
use std::time::Instant;

/// Makes what the store does not hold yet and writes the model and its data sheet.
pub fn run(args: &Args) -> Result<()> {
    let started = Instant::now();
    let store = Store::open(&args.cache)?;
    pack::make_folder(&args.out)?;
    let sources = args.sources()?;
    let whole = sources.whole();
    let fits = match whole.is_empty() {
        true => None,
        false => Some(fits::make(&store, &args.data, &whole)?),
    };
    let face = face::make(&store, args, fits.as_ref(), sources.labels())?;
    let context = Context::new(args, &store, fits.as_ref())?;
    match args.until {
        None => {}
        Some(Until::Renders) => {
            context.renders(Kind::Plain)?;
            return context.renders(Kind::Near).map(drop);
        }
        Some(Until::Detector) => return detector::make(&context).map(drop),
        Some(Until::GlobalNetwork) => return global_network::make(&context).map(drop),
        Some(Until::EnsembleMember) => return ensemble_member::make(&context).map(drop),
    }
    let detector = detector::make(&context)?;
    let global = global_network::make(&context)?;
    let member = ensemble_member::make(&context)?;
    let refiners = refiners::make(&context, &global, &member)?;
    let regression = shape_regression::make(&context, [&global, &member, &refiners])?;
    let cascade = [
        (&global, AlignModel::TAG),
        (&member, EnsembleMember::TAG),
        (&refiners, Refiners::TAG),
        (&regression, ShapeRegression::TAG),
    ];
    let verifier = verifier::make(&context, &cascade, &detector)?;
    if let Some((model, _)) = context.finished.as_ref().filter(|_| keeps_networks(args)) {
        let added = Added {
            tag: Verifier::TAG,
            section: sections::read(&(&verifier, Verifier::TAG))?,
            heading: data_sheet::VERIFIER_HEADING,
            about: &data_sheet::about_verifier(args, &sources),
        };
        return add::write(&Blob::open(model)?, &added, &args.out);
    }
    let rotation = rotation_regression::make(&context, &cascade)?;
    let sheet = data_sheet::make(&context, &cascade)?;
    let mut sheet = data_sheet::text(args, &sources, &data_sheet::read(&sheet)?);
    let mut all = [(&face, FACE_TAG), (&detector, detect::TAG)]
        .iter()
        .chain(&cascade)
        .chain(&[
            (&rotation, RotationRegression::TAG),
            (&verifier, Verifier::TAG),
        ])
        .map(sections::read)
        .collect::<Result<Vec<_>>>()?;
    if args.wireframe.is_none() {
        let mesh = mesh::make(&store, &args.data, &face.read(sections::FILE)?)?;
        all.push(sections::read(&(&mesh, MESH_TAG))?);
        data_sheet::add(&mut sheet, &mesh::about());
    }
    let mut kept = vec![];
    if refiners::steps(args) == 0 {
        kept.push((WEIGHTS_TAG, data_sheet::WEIGHTS_HEADING));
    }
    kept.push((EYES_TAG, data_sheet::EYES_HEADING));
    for (tag, heading) in kept {
        if let Some((section, about)) = data_sheet::kept_part(&context, tag, heading)? {
            all.push(section);
            data_sheet::add(&mut sheet, &about);
        }
    }
    let size = pack::write(&args.out, all, &sheet)?;
    println!(
        "{}: {size} bytes, in {:.0?}",
        args.out.display(),
        started.elapsed()
    );
    Ok(())
}

/// Whether no network is trained.
fn keeps_networks(args: &Args) -> bool {
    args.steps == 0 && args.detector_steps == 0 && refiners::steps(args) == 0
}
