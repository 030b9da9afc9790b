//! Options of `posewise-train model`.

use crate::render::{self, Kind};
use crate::sources::{Sources, Terms};
use anyhow::Result;
use std::path::PathBuf;

/// Options of `posewise-train model`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for the outputs of stages.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
    /// The model; its data sheet is written beside it, ending in `.md`.
    #[arg(long, default_value = "models/posewise.posewise")]
    pub out: PathBuf,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The model's 3D face: a Candide-3 wireframe (`.wfm`) in place of the morphable head, which
    /// still renders.
    #[arg(long)]
    pub wireframe: Option<PathBuf>,
    /// Rendered faces to train on.
    #[arg(long, default_value_t = 16_000)]
    pub renders: u64,
    /// Close-up renders, for the refiners.
    #[arg(long, default_value_t = 9_000)]
    pub near_renders: u64,
    /// Renders whose eyes look around, for the network of single eyes.
    #[arg(long, default_value_t = 32_000)]
    pub eye_renders: u64,
    /// Batches that the network of single eyes is trained on.
    #[arg(long, default_value_t = 48_000)]
    pub eye_steps: usize,
    /// Batches that each network of the global stage is trained on; with `--from`, 0 keeps all of
    /// the model but the verifier, if refiners and detector are kept too.
    #[arg(long, default_value_t = 40_000)]
    pub steps: usize,
    /// Batches that a refiner is trained on, half of `--steps` unless given; with `--from`, 0 keeps
    /// the refiners, and section `WGHT`, which reads them.
    #[arg(long)]
    pub refiner_steps: Option<usize>,
    /// With `--from`: share of its numbers in those of the networks of the global stage that the
    /// training ends with.
    #[arg(long, default_value_t = 0.0)]
    pub share_of_from: f32,
    /// Batches that the detector's network is trained on; with `--from`, 0 keeps the detector.
    #[arg(long, default_value_t = 20_000)]
    pub detector_steps: usize,
    /// Train on sources whose terms allow at least this.
    #[arg(long, value_enum, default_value = "research")]
    pub terms: Terms,
    /// Leave out this source; repeat for several.
    #[arg(long)]
    pub without: Vec<String>,
    /// Go on from the networks of this model in place of random ones.
    #[arg(long)]
    pub from: Option<PathBuf>,
    /// Stop after this stage, and make only what it needs; a whole model otherwise.
    #[arg(long, value_enum)]
    pub until: Option<Until>,
}

impl Args {
    /// What it trains on.
    pub fn sources(&self) -> Result<Sources> {
        Sources::new(self.terms, &self.without)
    }

    /// What is left out, on a line of its own, for the commands in data sheets; nothing if nothing.
    pub fn without_option(&self) -> String {
        match self.without.is_empty() {
            true => String::new(),
            false => format!("\n--without {}", self.without.join(" --without ")),
        }
    }

    /// `--from MODEL` on a line of its own, for the commands in data sheets; nothing without it.
    pub fn from_option(&self) -> String {
        match &self.from {
            Some(path) => format!("\n--from {}", path.display()),
            None => String::new(),
        }
    }

    /// The same as `posewise-train render` would be given, for one kind.
    pub fn render(&self, kind: Kind, sources: &Sources) -> render::Args {
        let share = |of: f64, has: bool| if has { of } else { 0.0 };
        render::Args {
            data: self.data.clone(),
            cache: self.cache.clone(),
            count: match kind {
                Kind::Plain => self.renders,
                Kind::Near => self.near_renders,
                Kind::Eyes => self.eye_renders,
            },
            seed: self.seed,
            clean: self.terms == Terms::Free,
            makehuman: share(render::MAKEHUMAN, sources.has_makehuman()),
            panoramas: share(render::PANORAMAS, sources.has_panoramas()),
            kind,
        }
    }
}

/// Stages that can be made alone, so that several can run at a time or on another machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Until {
    /// Rendered faces, near ones too.
    Renders,
    /// The face detector.
    Detector,
    /// The global stage's network.
    GlobalNetwork,
    /// The global stage's ensemble member.
    EnsembleMember,
}
