//! A second network of the global stage: two that were trained apart err less in the mean than either
//! does alone, and less still where one of them looks in the mirror.

use super::regressor::{Memory, Regressor};
use super::{Shape, mirror};
use crate::image::Crop;
use crate::model::{Blob, ModelError, Section};
use crate::shape::LANDMARKS;

/// Section `ENSM`, checked; without a network where the model lacks it.
///
/// The network is read anew whenever it runs, as those of the fine stages are.
#[derive(Clone, Debug, Default)]
pub struct EnsembleMember<'m> {
    content: Option<Section<'m>>,
    /// Side of the crops that it sees \[px\].
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
    /// When it is too short or a number is out of range.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        let section = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(EnsembleMember::default()),
            other => other?,
        };
        let regressor = Regressor::read(&mut section.clone(), LANDMARKS)?;
        Ok(EnsembleMember {
            side: regressor.side(),
            zoom: regressor.zoom(),
            content: Some(section),
        })
    }

    /// Checks that it sees the crops of the first network.
    ///
    /// # Errors
    /// When it was made for other crops.
    pub(super) fn require_crops_of(&self, first: &Regressor<'_>) -> Result<(), ModelError> {
        let Some(section) = &self.content else {
            return Ok(());
        };
        let same = self.side == first.side() && self.zoom == first.zoom();
        section.require(same, "it sees other crops")
    }

    /// Landmarks as this network sees them in a crop's mirror image, in crop px from the crop's centre;
    /// `None` without a network.
    #[inline(never)]
    pub(super) fn run(&self, crop: &mut Crop, memory: &mut Memory) -> Option<Shape> {
        // It was checked when the model was opened.
        let regressor = Regressor::read(&mut self.content.clone()?, LANDMARKS).ok()?;
        let mut points = [[0.0f32; 2]; LANDMARKS];
        crop.mirror();
        regressor.run(crop, &mut points, memory);
        crop.mirror();
        Some(mirror(&points))
    }
}
