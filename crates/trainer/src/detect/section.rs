//! Trains section `DTCT` as a whole.

use super::equalise::equalised;
use super::network::Network;
use super::options::Options;
use super::pictures::Pictures;
use super::{finished, quantize, training};
use anyhow::Result;
use posewise_format::{Section, SectionWriter};
use std::path::Path;

/// Tiles that show how large the maps' values grow.
const EXAMPLES: u64 = 512;

/// Trains on these pictures, with checkpoints in `folder`, from which an interrupted run goes on; a
/// new one starts from the section `before`, if there is one.
///
/// # Errors
/// When a checkpoint cannot be written, or the network does not fit the core's memory.
pub fn train(
    pictures: &Pictures,
    folder: &Path,
    options: &Options,
    before: Option<Section<'_>>,
) -> Result<SectionWriter> {
    let network = Network::new(options.channels, options.depth);
    let checkpoint = folder.join("network.checkpoint");
    let before = before.map(|mut s| finished::parameters(&mut s, &network));
    let before = before.transpose()?;
    let parameters = training::train(&network, pictures, &checkpoint, options, before)?;
    // Numbers that no training tile has.
    let example = |k: u64| training::numbered(pictures, options, u64::MAX / 2 + k).luma;
    let tiles: Vec<Vec<u8>> = (0..EXAMPLES).map(example).collect();
    let parameters = equalised(&network, &parameters, &tiles);
    quantize::section(&network, &parameters, &tiles, options)
}
