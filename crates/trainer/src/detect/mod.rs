//! Trains section `DTCT`: soft cascades of pixel comparisons and the forest that refines a hit.
//!
//! In: faces with boxes, and backgrounds. Out: a [`SectionWriter`]. The order
//! is that of the files: [`faces`] and [`backgrounds`] are read into memory, [`sample`] cuts
//! augmented patches, [`boost`] grows trees on them, [`cascade`] alternates with [`mine`] for hard
//! negatives, [`refine`] fits the regression forest, [`calibrate`] sets the thresholds, and
//! [`pack`] writes.

pub mod backgrounds;
pub mod boost;
pub mod calibrate;
pub mod cascade;
pub mod faces;
pub mod grey;
pub mod mine;
pub mod pack;
pub mod refine;
pub mod sample;

use std::path::Path;

use anyhow::Result;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::pack::SectionWriter;

/// Side of the window that the trees look at over a face's size \[1/256\]: forehead and ears are
/// outside the landmarks' box and help to tell a face.
pub const SIDE_Q8: i32 = 333;

/// How much to train; `default` is what ships.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of every random choice.
    pub seed: u64,
    /// Trees of the cascade, how many of them ship, and their depth. The last trees demand what only
    /// a detector without a verifier behind it must; the thresholds of those before are set with
    /// them there.
    pub trees: usize,
    pub kept: usize,
    pub depth: usize,
    /// Summed score from which merged hits are told. Low: every face told is then aligned and
    /// verified, which tells faces far better than the trees do.
    pub confirm: u32,
    /// Share of the best windows around the faces that may be lost for the sum of all trees, beside
    /// what training loses.
    pub hopeless: f32,
    /// Patches of faces and of backgrounds.
    pub positives: usize,
    pub negatives: usize,
    /// Trees of the refining forest, their depth, and patches to fit it on.
    pub refine_trees: usize,
    pub refine_depth: usize,
    pub refine_samples: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            seed: 1,
            trees: 400,
            kept: 350,
            depth: 5,
            confirm: 1000,
            hopeless: 0.08,
            positives: 36_000,
            negatives: 30_000,
            refine_trees: 100,
            refine_depth: 5,
            refine_samples: 24_000,
        }
    }
}

/// A generator for one purpose, independent of how much the others drew.
pub(crate) fn rng_for(seed: u64, purpose: u64, index: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ purpose);
    rng.set_stream(index);
    rng
}

/// Trains everything on these faces and backgrounds, keeping intermediate results in `cache`, from
/// which an interrupted run goes on. The cascade learns from the first `told` faces alone, the forest
/// that refines its hits from all.
///
/// # Errors
/// When the cache cannot be written.
pub fn train(
    faces: &[faces::Face],
    told: usize,
    backgrounds: &[grey::Grey],
    cache: &Path,
    options: &Options,
) -> Result<SectionWriter> {
    std::fs::create_dir_all(cache)?;
    let learnt = &faces[..told.min(faces.len())];
    let cascade = cascade::train(learnt, backgrounds, cache, options)?;
    let refiner = refine::train(faces, cache, options)?;
    let mut cascade = calibrate::thresholds(&cascade, learnt, options.hopeless);
    cascade.trees.truncate(options.kept);
    cascade.thresholds.truncate(options.kept);
    Ok(pack::section(&cascade, &refiner, options.confirm))
}
