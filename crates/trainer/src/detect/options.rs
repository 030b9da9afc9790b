//! Size and seed of the detector's training.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::Serialize;

/// How much to train; `default` is what ships.
#[derive(Clone, Debug, Serialize)]
pub struct Options {
    /// Seed of every random choice.
    pub seed: u64,
    /// Channels at 1/2, 1/4 and 1/8 of a tile.
    pub channels: [usize; 3],
    /// Separable layers at 1/8 beyond the first, each with a connection around it.
    pub depth: usize,
    /// Batches to train on, and tiles of a batch.
    pub steps: usize,
    pub batch: usize,
    /// Largest learning rate, and batches until it is reached.
    pub rate: f32,
    pub warm_up: usize,
    /// Decay of the weights per unit of the rate.
    pub decay: f32,
    /// Smallest and largest face that a scan asks a tile for, and the overlap of tiles \[tile px\].
    pub smallest: f32,
    pub largest: f32,
    pub overlap: u32,
    /// Least probability of a hit. Low: every candidate is then aligned and verified, which rejects
    /// false positives far better than a tile does. With 0.2 there are about four candidates in a
    /// frame of 640×480 without people, from 60 px on.
    pub threshold: f32,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            seed: 1,
            channels: [16, 32, 48],
            depth: 4,
            steps: 20_000,
            batch: 64,
            rate: 4e-3,
            warm_up: 400,
            decay: 0.01,
            smallest: 20.0,
            largest: 47.0,
            overlap: 20,
            threshold: 0.2,
        }
    }
}

/// A generator for one purpose, independent of how much the others drew.
pub fn rng_for(seed: u64, purpose: u64, index: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ purpose);
    rng.set_stream(index);
    rng
}
