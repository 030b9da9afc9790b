//! What commands on rendered people have in common.

use anyhow::Result;
use posewise_cli::model_file::ModelFile;
use posewise_train::render::{self, Kind, Renderer};
use std::path::PathBuf;

/// Their options.
#[derive(clap::Args)]
pub struct Args {
    /// The shared data: `facekit.npz`, `free/`
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// The model; the built-in one by default
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

impl Args {
    /// The model's file.
    pub fn file(&self) -> Result<ModelFile> {
        ModelFile::read(self.model.as_deref())
    }

    /// Draws procedural people of both families of heads.
    pub fn renderer(&self, seed: u64, kind: Kind) -> Result<Renderer> {
        render::renderer(&render::Args::procedural(&self.data, seed, kind), None)
    }
}
