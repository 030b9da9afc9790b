//! A second network of the global stage: two that were trained apart err less in the mean than either
//! does alone, and less still where one of them looks in the mirror.

use super::regressor::{Memory, Regressor};
use super::{Shape, mirror};
use crate::image::Crop;
use crate::model::{Blob, ModelError, Section};
use crate::shape::LANDMARKS;

/// Section `ALG2`, checked; without a network where the model lacks it.
///
/// The network is read anew whenever it runs, as those of the fine stages are.
#[derive(Clone, Debug, Default)]
pub struct Second<'m>(Option<Section<'m>>);

impl<'m> Second<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"ALG2";

    /// Reads and checks the section, which holds a regressor; it sees the crops of the first one.
    ///
    /// # Errors
    /// When it is too short or a number is out of range, or made for other crops.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>, first: &Regressor<'_>) -> Result<Self, ModelError> {
        let section = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(Second(None)),
            other => other?,
        };
        let second = Regressor::read(&mut section.clone(), LANDMARKS)?;
        let same = second.side() == first.side() && second.zoom() == first.zoom();
        section.require(same, "it sees other crops")?;
        Ok(Second(Some(section)))
    }

    /// Landmarks as this network sees them in a crop's mirror image, in crop px from the crop's centre;
    /// `None` without a network.
    #[inline(never)]
    pub(super) fn run(&self, crop: &mut Crop, memory: &mut Memory) -> Option<Shape> {
        // It was checked when the model was opened.
        let regressor = Regressor::read(&mut self.0.clone()?, LANDMARKS).ok()?;
        let mut points = [[0.0f32; 2]; LANDMARKS];
        crop.mirror();
        regressor.run(crop, &mut points, memory);
        crop.mirror();
        Some(mirror(&points))
    }
}
