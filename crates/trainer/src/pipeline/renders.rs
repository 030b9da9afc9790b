//! Stages `renders` and `renders-near`: rendered faces with exact landmarks. An
//! interrupted one goes on after the last whole sample of its file.

use super::fits;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::head::CONVENTION_VERSION;
use crate::photographs::Set;
use crate::render::{self, Args, Kind, SampleSpec};
use crate::sources::{Sources, Terms};
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

/// Photographs whose people are rendered: the fits of these sets.
pub type Photographed<'a> = Option<(&'a Output, &'a [Set])>;

/// Renders faces, of procedural people and of photographed ones.
pub fn make(store: &Store, args: &Args, photographed: Photographed<'_>) -> Result<Output> {
    let (name, version) = match args.kind {
        Kind::Plain => ("renders", 7),
        Kind::Near => ("renders-near", 7),
        Kind::Eyes => ("renders-eyes", 9),
    };
    let options = Options {
        seed: args.seed,
        count: args.count,
        clean: args.clean,
        convention: photographed.is_none().then_some(CONVENTION_VERSION),
        spec: render::spec(args, photographed.is_some()),
        people: args.kind.people(photographed.is_some()),
        pictures: args.kind.pictures(),
        makehuman_people: (args.makehuman > 0.0).then(|| args.kind.makehuman_people()),
    };
    let data = |name: &str| store.data(&args.data.join(name));
    let mut stage = Stage::new(name, version)
        .options(&options)?
        .input("facekit.npz", data("facekit.npz")?);
    if args.makehuman > 0.0 {
        stage = stage.input("makehuman", data(render::MAKEHUMAN_FOLDER)?);
    }
    if args.panoramas > 0.0 {
        stage = stage.input("environments.npz", data(render::PANORAMA_FILE)?);
    }
    if let Some((fits, sets)) = photographed {
        stage = stage.input("fits", fits.hash(fits::FILE)?);
        for set in sets {
            stage = stage.input(set.images, data(set.images)?);
        }
    }
    if !args.clean {
        stage = stage.input("backgrounds", data("backgrounds")?);
    }
    store.make(&stage, &[FILE], |folder| {
        let fits = photographed.map(|(fits, _)| fits::read(fits)).transpose()?;
        render::write(args, fits.as_ref(), &folder.join(FILE))
    })
}

/// `posewise-train render`: makes the stage and what it needs, and returns the path of the samples.
pub fn run(args: &Args) -> Result<PathBuf> {
    let store = Store::open(&args.cache)?;
    let terms = match args.clean {
        true => Terms::Free,
        false => Terms::Research,
    };
    let sets = Sources::new(terms, &[])?.whole();
    let fits = fits::make(&store, &args.data, &sets)?;
    Ok(make(&store, args, Some((&fits, &sets)))?.path(FILE))
}
