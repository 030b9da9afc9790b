//! Trains section `DTCT` as a whole.

use super::equalise::equalised;
use super::network::Network;
use super::options::Options;
use super::pictures::Pictures;
use super::{quantize, training};
use anyhow::Result;
use posewise_format::SectionWriter;
use std::path::Path;

/// Tiles that show how large the maps' values grow.
const EXAMPLES: u64 = 512;

/// Trains on these pictures, with checkpoints in `folder`, from which an interrupted run goes on.
///
/// # Errors
/// When a checkpoint cannot be written, or the network does not fit the core's memory.
pub fn train(pictures: &Pictures, folder: &Path, options: &Options) -> Result<SectionWriter> {
    let network = Network::new(options.channels, options.depth);
    let checkpoint = folder.join("network.checkpoint");
    let parameters = training::train(&network, pictures, &checkpoint, options)?;
    // Numbers that no training tile has.
    let example = |k: u64| training::numbered(pictures, options, u64::MAX / 2 + k).luma;
    let tiles: Vec<Vec<u8>> = (0..EXAMPLES).map(example).collect();
    let parameters = equalised(&network, &parameters, &tiles);
    quantize::section(&network, &parameters, &tiles, options)
}
