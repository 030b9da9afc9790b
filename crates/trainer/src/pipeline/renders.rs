//! Stages `renders` and `renders-near`: rendered faces with exact landmarks. An
//! interrupted one goes on after the last whole sample of its file.

use super::fits;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::head::CONVENTION_VERSION;
use crate::photographs::UNCROPPED;
use crate::render::{self, Args, Kind, SampleSpec};
use anyhow::Result;
use serde::Serialize;
use std::path::PathBuf;

/// The stage's file.
pub const FILE: &str = "samples.bin";

#[derive(Serialize)]
struct Options {
    seed: u64,
    count: u64,
    clean: bool,
    /// Where rendered landmarks are, if no photographs say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    convention: Option<u32>,
    spec: SampleSpec,
    /// Procedural people, and pictures of each photographed one.
    people: usize,
    pictures: usize,
    /// People with MakeHuman's heads.
    #[serde(skip_serializing_if = "Option::is_none")]
    makehuman_people: Option<usize>,
}

/// Renders faces; a clean model's need no `fits`.
pub fn make(store: &Store, args: &Args, fits: Option<&Output>) -> Result<Output> {
    let name = match args.kind {
        Kind::Plain => "renders",
        Kind::Near => "renders-near",
        Kind::Eyes => "renders-eyes",
    };
    let options = Options {
        seed: args.seed,
        count: args.count,
        clean: args.clean,
        convention: args.clean.then_some(CONVENTION_VERSION),
        spec: render::spec(args),
        people: args.kind.people(args.clean),
        pictures: args.kind.pictures(),
        makehuman_people: (args.makehuman > 0.0).then(|| args.kind.makehuman_people()),
    };
    let data = |name: &str| store.data(&args.data.join(name));
    let mut stage = Stage::new(name, 4)
        .options(&options)?
        .input("facekit.npz", data("facekit.npz")?);
    if args.makehuman > 0.0 {
        stage = stage.input("makehuman", data(render::MAKEHUMAN_FOLDER)?);
    }
    if args.panoramas > 0.0 {
        stage = stage.input("environments.npz", data(render::PANORAMA_FILE)?);
    }
    if let Some(fits) = fits {
        stage = stage.input("fits", fits.hash(fits::FILE)?);
        for name in UNCROPPED
            .map(|set| set.images)
            .into_iter()
            .chain(["backgrounds"])
        {
            stage = stage.input(name, data(name)?);
        }
    }
    store.make(&stage, &[FILE], |folder| {
        let fits = fits.map(fits::read).transpose()?;
        render::write(args, fits.as_ref(), &folder.join(FILE))
    })
}

/// `posewise-train render`: makes the stage and what it needs, and returns the path of the samples.
pub fn run(args: &Args) -> Result<PathBuf> {
    let store = Store::open(&args.cache)?;
    let fits = match args.clean {
        true => None,
        false => Some(fits::make(&store, &args.data)?),
    };
    Ok(make(&store, args, fits.as_ref())?.path(FILE))
}
