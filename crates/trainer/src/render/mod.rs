//! Rendered faces: a morphable head with procedural or photographed skin, lit and drawn at poses,
//! expressions and under conditions that photographs lack, with exact landmarks.
//!
//! ```text
//! head ─► mesh ─┬─► expression, identity ─► draw (raster, light, texture, props) ─► effects ─►
//! Sample
//!               ├─► people (skin, photo)       over a background
//!               └─► contour: the 68 points in the photographs' convention
//! ```

pub mod accessories;
pub mod background;
pub mod cache;
pub mod contour;
pub mod dead_leaves;
pub mod deform;
pub mod draw;
pub mod effects;
pub mod environment;
pub mod expression;
pub mod eye_cache;
pub mod eye_truth;
pub mod glare;
pub mod lids;
pub mod light;
pub mod makehuman;
pub mod mesh;
mod mirror;
pub mod noise;
pub mod people;
pub mod person;
pub mod photo;
pub mod props;
pub mod raster;
pub mod sample;
pub mod sheet;
pub mod skin;
pub mod spec;
pub mod strands;
pub mod texture;

pub use makehuman::Family;
pub use people::{People, Persons};
pub use sample::{Behind, Renderer, Sample};
pub use spec::SampleSpec;

use crate::fit::{Fits, PhotoFit};
use crate::head::Head;
use crate::picture::Picture;
use anyhow::Result;
use glam::Vec3;
use image::GrayImage;
use std::path::{Path, PathBuf};

/// Share of MakeHuman's heads, and of samples among a panorama.
pub const MAKEHUMAN: f64 = 0.5;
pub const PANORAMAS: f64 = 0.5;

/// Settings of `posewise-train render`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data: `facekit.npz`, `backgrounds/`, `faces300w/`, `faces68/`.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for the outputs of stages.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
    /// Samples in all; an interrupted run goes on where it stopped.
    #[arg(long, default_value_t = 20_000)]
    pub count: u64,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Use no photograph whose terms restrict its use.
    #[arg(long)]
    pub clean: bool,
    /// Share of MakeHuman's heads (`free/makehuman`) among the renders; the others are of the
    /// morphable head.
    #[arg(long, default_value_t = MAKEHUMAN)]
    pub makehuman: f64,
    /// Share of the renders that a panorama (`free/environments.npz`) lights and surrounds.
    #[arg(long, default_value_t = PANORAMAS)]
    pub panoramas: f64,
    /// What to render.
    #[arg(long, value_enum, default_value_t = Kind::Plain)]
    pub kind: Kind,
}

impl Args {
    /// For the [`renderer`] of procedural people of both families.
    pub fn procedural(data: &Path, seed: u64, kind: Kind) -> Self {
        Args {
            data: data.to_path_buf(),
            cache: PathBuf::new(),
            count: 0,
            seed,
            clean: true,
            makehuman: MAKEHUMAN,
            panoramas: PANORAMAS,
            kind,
        }
    }
}

/// What renders show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// Poses, expressions and lights that photographs lack.
    Plain,
    /// Faces seen from near, for the refiners: sharp, lids in detail and half way too.
    Near,
    /// Faces whose eyes look around, with the truth of the eyes.
    Eyes,
}

impl Kind {
    /// Different procedural people, alone or beside photographed ones.
    pub fn people(self, beside_photographed: bool) -> usize {
        match (self, beside_photographed) {
            (Kind::Plain, false) => 1024,
            (Kind::Plain, true) => 256,
            (Kind::Near, _) => 600,
            (Kind::Eyes, _) => 1024,
        }
    }

    /// Different people with MakeHuman's heads.
    pub fn makehuman_people(self) -> usize {
        match self {
            Kind::Plain => 1024,
            Kind::Near => 600,
            Kind::Eyes => 1024,
        }
    }

    /// Pictures of each photographed person.
    pub fn pictures(self) -> usize {
        match self {
            Kind::Plain => 2,
            Kind::Near => 3,
            Kind::Eyes => 1,
        }
    }
}

/// A renderer as `args` ask for; photographed people need the `fits` of their photographs.
pub fn renderer(args: &Args, fits: Option<&Fits>) -> Result<Renderer> {
    let head = Head::load(&args.data.join("facekit.npz"))?;
    let mesh = mesh::Mesh::new(&head)?;
    let scenes = match args.clean {
        true => Vec::new(),
        false => backgrounds(&args.data.join("backgrounds"))?,
    };
    let behind = Behind {
        people: match fits {
            Some(fits) if scenes.is_empty() => pieces(&fits.fits, &args.data)?,
            _ => Vec::new(),
        },
        scenes,
    };
    let mut people = People::new(
        &mesh,
        args.kind.people(fits.is_some()),
        args.seed,
        args.kind != Kind::Plain,
    );
    let offsets_mm = match fits {
        None => head.conventional_offsets_mm(),
        Some(fits) => {
            let pictures = args.kind.pictures();
            people.add_photographs(&head, &mesh, &fits.fits, &args.data, pictures)?;
            fits.offsets_mm.clone()
        }
    };
    let mut renderer = Renderer::new(mesh, people, behind, &offsets_mm);
    if args.makehuman > 0.0 {
        let conventional = head.conventional_offsets_mm();
        let moved = offsets_mm.iter().zip(&conventional);
        let moved: Vec<Vec3> = moved
            .map(|(a, b)| Vec3::from(*a) - Vec3::from(*b))
            .collect();
        let people = args.kind.makehuman_people();
        let near = args.kind != Kind::Plain;
        let folder = args.data.join(MAKEHUMAN_FOLDER);
        let family = Family::load(&folder, &renderer.mesh, &moved, people, args.seed, near)?;
        renderer = renderer.with_makehuman(family);
    }
    if args.panoramas > 0.0 {
        let panoramas = environment::load(&args.data.join(PANORAMA_FILE))?;
        renderer = renderer.with_panoramas(panoramas);
    }
    Ok(renderer)
}

/// Where both are, in the shared data.
pub const MAKEHUMAN_FOLDER: &str = "free/makehuman";
pub const PANORAMA_FILE: &str = "free/environments.npz";

/// Share of everyday samples where no photographs are: those are beside the renders otherwise.
const EVERYDAY_CLEAN: f64 = 0.6;

/// The spec that goes with `args`.
pub fn spec(args: &Args, has_photographed: bool) -> SampleSpec {
    let kind = match args.kind {
        Kind::Plain => SampleSpec::default(),
        Kind::Near => SampleSpec::near(),
        Kind::Eyes => SampleSpec::eyes(),
    };
    SampleSpec {
        persons: if has_photographed {
            Persons::All
        } else {
            Persons::Procedural
        },
        everyday: match args.kind {
            Kind::Plain | Kind::Near if !has_photographed => EVERYDAY_CLEAN,
            _ => 0.0,
        },
        makehuman: args.makehuman,
        panoramas: args.panoramas,
        ..kind
    }
}

/// Renders the samples into a file, going on where an interrupted run stopped.
pub fn write(args: &Args, fits: Option<&Fits>, path: &Path) -> Result<()> {
    // Samples of one kind are not those of another once more.
    let seed = args.seed ^ ((args.kind as u64) << 32);
    let renderer = &renderer(args, fits)?;
    let spec = &spec(args, fits.is_some());
    match args.kind {
        Kind::Eyes => eye_cache::write(path, renderer, seed, args.count, spec),
        _ => cache::write(path, renderer, seed, args.count, spec).map(drop),
    }
}

/// Most photographs of people whose pieces are behind renders.
const MOST_PIECES: usize = 800;

/// Photographs whose pieces are behind renders: every n-th.
fn pieces(fits: &[PhotoFit], data: &Path) -> Result<Vec<GrayImage>> {
    let every = fits.len().div_ceil(MOST_PIECES).max(1);
    fits.iter()
        .step_by(every)
        .map(|fit| Ok(image::open(data.join(&fit.image))?.to_luma8()))
        .collect()
}

/// All pictures of a folder in the order of their names, as luma.
pub fn backgrounds(folder: &Path) -> Result<Vec<GrayImage>> {
    Picture::list(folder)?
        .iter()
        .map(|p| Ok(image::open(p)?.to_luma8()))
        .collect()
}
