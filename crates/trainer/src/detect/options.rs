//! Size and seed of the detector's training.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::Serialize;

/// Side of the window that the trees read, relative to a face's size \[1/256\]: forehead and ears
/// are outside the landmarks' box and help to recognise a face.
pub const SIDE_Q8: i32 = 333;

/// How much to train; `default` is what ships.
#[derive(Clone, Debug, Serialize)]
pub struct Options {
    /// Seed of every random choice.
    pub seed: u64,
    /// Trees of the cascade that are trained, how many of them ship, and their depth. The last
    /// trees do not ship because the verifier does their work; they are trained because the
    /// thresholds of the trees before them depend on them.
    pub trees: usize,
    pub kept: usize,
    pub depth: usize,
    /// Summed score from which merged hits are reported. Low: every reported face is then aligned
    /// and verified, which rejects false positives far better than the trees do.
    pub confirm: u32,
    /// Share of the best windows around the faces that the last threshold may reject, beside those
    /// lost in training.
    pub discard_quantile: f32,
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
            discard_quantile: 0.08,
            positives: 36_000,
            negatives: 30_000,
            refine_trees: 100,
            refine_depth: 5,
            refine_samples: 24_000,
        }
    }
}

/// A generator for one purpose, independent of how much the others drew.
pub fn rng_for(seed: u64, purpose: u64, index: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ purpose);
    rng.set_stream(index);
    rng
}
