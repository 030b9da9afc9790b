//! The second ensemble member of the global stage. The average of two independently trained
//! networks has a smaller error than either; the gain is larger where one of them sees the mirror
//! image.

use super::placement::mirror;
use super::regressor::{Memory, Regressor};
use super::shape::Shape;
use crate::image::Crop;
use crate::shape::LANDMARKS;
use posewise_format::{Blob, ModelError, Section};

/// A checked view of section `ENSM`; empty where the model lacks it.
///
/// The regressor is parsed again for each run, which takes a microsecond: its table of layers would
/// make a model too large for small stacks.
#[derive(Clone, Debug, Default)]
pub struct EnsembleMember<'m> {
    content: Option<Section<'m>>,
    /// Side of its crops \[px\].
    side: usize,
    /// Crop px per canonical unit.
    zoom: f32,
}

impl<'m> EnsembleMember<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"ENSM";

    /// Reads and checks the section, which holds a regressor.
    ///
    /// # Errors
    /// When the section is too short or a number is out of range.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        let section = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(EnsembleMember::default()),
            other => other?,
        };
        let regressor = Regressor::open(&mut section.clone(), LANDMARKS)?;
        Ok(EnsembleMember {
            side: regressor.side(),
            zoom: regressor.zoom(),
            content: Some(section),
        })
    }

    /// Multiply-adds of one run; 0 without a network.
    #[cfg(feature = "unstable-internals")]
    pub(super) fn multiply_adds(&self) -> usize {
        let regressor = |section: &Section<'m>| Regressor::read(&mut section.clone(), LANDMARKS);
        let read = self.content.as_ref().and_then(|s| regressor(s).ok());
        read.map_or(0, |regressor| regressor.multiply_adds())
    }

    /// Checks that its crops have the size and zoom of the first member's.
    ///
    /// # Errors
    /// When they differ.
    pub(super) fn require_crops_of(&self, first: &Regressor<'_>) -> Result<(), ModelError> {
        let Some(section) = &self.content else {
            return Ok(());
        };
        let same = self.side == first.side() && self.zoom == first.zoom();
        section.require(same, "its crops differ from those of the global stage")
    }

    /// Landmarks predicted from the mirrored standardised crop, mirrored back, in crop px relative
    /// to the crop's centre; `None` without a network. The crop is unchanged afterwards.
    #[inline(never)]
    pub(super) fn run(&self, crop: &mut Crop, memory: &mut Memory) -> Option<Shape> {
        // Reading cannot fail: `open` checked the section.
        let regressor = Regressor::read(&mut self.content.clone()?, LANDMARKS).ok()?;
        let mut points = [[0.0f32; 2]; LANDMARKS];
        crop.mirror();
        regressor.run(crop, &mut points, memory);
        crop.mirror();
        Some(mirror(&points))
    }
}
