//! Section `DTCT`: what faces of a tile its network finds, what its outputs mean, and the network.
//!
//! ```text
//! u32 smallest, u32 largest face of a tile [1/256 tile px]   u32 overlap of tiles [tile px]
//! u32 least score of a hit, as the map has it
//! f32[6] values of one unit of the outputs: score [logit], shift right, shift down [tile px],
//!     natural logarithm of the size's ratio to the middle size, roll [rad], yaw
//! f32 middle size [tile px]
//! the network, as `network::Network` reads it: the last node's map is the output
//! ```

use crate::network::{Map, Network};
use posewise_format::{ModelError, Section, Tag};

/// The section's tag.
pub const TAG: Tag = *b"DTCT";

/// Side of a tile \[px\].
pub const TILE: usize = crate::image::CROP_MAX;
/// Outputs of a cell that are read; the network may have more.
pub const OUTPUTS: usize = 6;
/// The value of the map that stands for 0.
pub(super) const ZERO: u8 = 128;

/// Sizes of faces that a section may name \[1/256 tile px\]: 4 to 128 px.
const SIZES_Q8: core::ops::RangeInclusive<usize> = 1024..=256 * TILE;
/// Units that a section may have.
const UNIT_MAX: f32 = 1.0;

/// The detector's parameters. The network is parsed again for each tile, which takes a
/// microsecond: its table of layers would make a model too large for small stacks.
#[derive(Clone, Debug)]
pub struct DetectorModel<'m> {
    /// Smallest and largest face of a tile \[1/256 tile px\]; the second is more than twice the
    /// first.
    pub(super) sizes_q8: [i32; 2],
    /// Overlap of neighbouring tiles \[tile px\], 0..=64.
    pub(super) overlap: i32,
    /// Least score of a hit, as the map has it, > `ZERO` − 128.
    pub(super) threshold: u8,
    /// Values of one unit of each output.
    pub(super) units: [f32; OUTPUTS],
    /// \[tile px\].
    pub(super) middle_size: f32,
    /// The section behind these numbers.
    network: Section<'m>,
}

impl<'m> DetectorModel<'m> {
    /// Reads and checks the section; nothing is copied.
    ///
    /// # Errors
    /// [`ModelError::Section`] names the first precondition of the scan that does not hold.
    #[inline(never)]
    pub fn open(mut section: Section<'m>) -> Result<Self, ModelError> {
        let s = &mut section;
        let (least, most) = (*SIZES_Q8.start(), *SIZES_Q8.end());
        let smallest = s.count(least, most, "a tile's smallest face is out of range")? as i32;
        let largest = s.count(least, most, "a tile's largest face is out of range")? as i32;
        s.require(largest > 2 * smallest, "sizes of tiles leave a gap")?;
        let overlap = s.count(0, TILE / 2, "the overlap is out of range")? as i32;
        let threshold = s.count(1, 255, "the least score is out of range")? as u8;
        let units = s.f32s(OUTPUTS)?.first_chunk().copied();
        let units = units.unwrap_or([0.0; OUTPUTS]);
        let valid = units.iter().all(|u| *u > 0.0 && *u <= UNIT_MAX);
        s.require(valid, "a unit is out of range")?;
        let middle_size = s.f32()?;
        s.require(
            (1.0..=TILE as f32).contains(&middle_size),
            "the middle size is out of range",
        )?;
        let model = DetectorModel {
            sizes_q8: [smallest, largest],
            overlap,
            threshold,
            units,
            middle_size,
            network: section.clone(),
        };
        let network = Network::open(&mut section, TILE)?;
        let output = network.output();
        section.require(
            output.channels() >= OUTPUTS && output.side() > 0,
            "the last map has too few outputs",
        )?;
        Ok(model)
    }

    /// The same with another least probability of a hit: the trainer wants more false positives
    /// than a tracker.
    #[cfg(feature = "unstable-internals")]
    pub fn with_threshold(self, probability: f32) -> Self {
        let [unit, ..] = self.units;
        let logit = libm::logf(probability / (1.0 - probability));
        let steps = libm::roundf(logit / unit).clamp(-127.0, 127.0);
        DetectorModel {
            threshold: (i32::from(ZERO) + steps as i32) as u8,
            ..self
        }
    }

    /// The network and its output.
    pub(super) fn network(&self) -> Option<(Network<'m>, Map)> {
        // Reading cannot fail: `open` checked the section.
        let network = Network::read(&mut self.network.clone(), TILE).ok()?;
        let output = network.output();
        Some((network, output))
    }

    /// Multiply-adds of a tile.
    #[cfg(feature = "unstable-internals")]
    pub fn multiply_adds(&self) -> usize {
        self.network().map_or(0, |(net, _)| net.multiply_adds())
    }
}
