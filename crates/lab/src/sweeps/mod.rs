//! Renders clips of heads with exact truth per frame: a validation of head pose and of covered
//! faces that is harder than what the renderer shows in training.
//!
//! Identity coefficients reach 2.5 standard deviations. Every head is also deformed smoothly,
//! outside of the morphable model, and some are Candide-3, a head of another make. Looks, hair,
//! lights and cameras come from seeds that no training uses; no photograph of a person is
//! involved. Clips are grey y4m behind gzip, and their truth has the columns that
//! `posewise-lab eval pose` and `eval eyes` read.
//!
//! ```text
//! plan ─► casting, body | candide, motion, covers ─► clip (draws, writes) ─► truth
//! ```

mod body;
mod candide;
mod casting;
mod clip;
mod covers;
mod crossing;
mod driver;
mod motion;
mod paint;
mod plan;
mod truth;
mod u3pt;

pub use crossing::{Args as CrossingArgs, run as run_crossings};
pub use driver::{Args as DriverArgs, run as run_driver_clips};
pub use u3pt::{Args as U3ptArgs, render as render_u3pt, run as run_u3pt};

use crate::footage::backgrounds::held_out;
use anyhow::{Context, Result};
use clip::Studio;
use image::GrayImage;
use posewise_train::head::Head;
use rayon::prelude::*;
use std::path::PathBuf;

/// What renders of both kinds are made of.
#[derive(Clone, Debug, clap::Args)]
pub struct Material {
    /// The morphable head.
    #[arg(long, default_value = "../shared/data/facekit.npz")]
    pub facekit: PathBuf,
    /// Folder of pictures that the heads are drawn before; procedural ones without it. Pictures
    /// that its file with-people.txt names are left out.
    #[arg(long)]
    pub backgrounds: Option<PathBuf>,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Settings of `posewise-lab sweeps`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub material: Material,
    /// Candide-3 for the sweeps of a second head; left out without it.
    #[arg(long)]
    pub candide: Option<PathBuf>,
    /// Where clips (.y4m.gz), truths (.csv) and descriptions (.json) go. A clip whose description
    /// is there and agrees is not rendered again.
    #[arg(long)]
    pub out: PathBuf,
    /// Render only clips whose names begin with one of these; repeat for several.
    #[arg(long)]
    pub only: Vec<String>,
    /// Render at most this number of frames of each clip.
    #[arg(long)]
    pub frames: Option<usize>,
}

/// Renders the clips that are not there yet.
pub fn run(args: &Args) -> Result<()> {
    let kit = Head::load(&args.material.facekit)?;
    let backgrounds = args.material.pictures()?;
    let studio = Studio::new(&kit, args.candide.as_deref(), backgrounds)?;
    std::fs::create_dir_all(&args.out)?;
    let mut sweeps = plan::sweeps(args.material.seed, args.candide.is_some());
    if !args.only.is_empty() {
        sweeps.retain(|s| args.only.iter().any(|name| s.name.starts_with(name)));
    }
    if let Some(most) = args.frames {
        sweeps
            .iter_mut()
            .for_each(|s| s.frames = s.frames.min(most));
    }
    sweeps
        .par_iter()
        .try_for_each(|sweep| studio.render(sweep, &args.out))
}

impl Material {
    /// The pictures that heads are drawn before.
    fn pictures(&self) -> Result<Vec<GrayImage>> {
        let Some(folder) = &self.backgrounds else {
            return Ok(Vec::new());
        };
        // Training takes four of each five pictures; the fifth is new to the model.
        let read = |path: &PathBuf| -> Result<GrayImage> {
            let picture = image::open(path).with_context(|| path.display().to_string())?;
            Ok(picture.to_luma8())
        };
        held_out(folder)?.iter().map(read).collect()
    }
}

#[cfg(test)]
mod tests;
