//! `posewise-lab driver-clips`: clips of drivers with exact truth, which the driver monitor is
//! measured on. `posewise-lab eval monitor` reads their truth.
//!
//! Heads, hair and lights are those of the sweeps, by streams of their own. What is as in a car: a
//! camera up to 40° off the direction of the road, glances of head and eyes and of the eyes alone,
//! blinks, closures of 0.2 to 6 s, half-shut lids, yawns, nods, talking, clear and dark glasses,
//! infrared light, hands before eyes and mouth, the rim of a steering wheel.
//!
//! ```text
//! plan ─► script (what the driver does, and when) ─► scene (draws, truth)
//! ```

mod args;
mod night;
mod passenger;
mod plan;
mod scene;
mod script;

use super::clip::Studio;
use anyhow::Result;
pub use args::Args;
use posewise_train::head::Head;
use rayon::prelude::*;

/// Renders the clips that are not there yet.
pub fn run(args: &Args) -> Result<()> {
    let kit = Head::load(&args.material.facekit)?;
    let studio = Studio::new(&kit, None, args.material.pictures()?)?;
    std::fs::create_dir_all(&args.out)?;
    let mut clips = plan::clips(args);
    if !args.only.is_empty() {
        clips.retain(|c| args.only.iter().any(|name| c.sweep.name.starts_with(name)));
    }
    clips
        .par_iter()
        .try_for_each(|clip| scene::render(&studio, clip, &args.out))
}

#[cfg(test)]
mod tests;
