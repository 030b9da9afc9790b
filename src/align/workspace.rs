//! What a run of the cascade works in.

use super::correction::Corrections;
use super::regressor::Memory;
use super::weights::Seen;
use crate::image::Crop;
use crate::network::{Activations, MAX_FEATURES};
use crate::shape::LANDMARKS;

/// Capacity: features that are kept for the verifier.
const VERIFIER_FEATURES: usize = LANDMARKS * MAX_FEATURES;

/// Working memory of a run, and the outputs of the last run beside its shape.
#[derive(Clone)]
pub struct Workspace {
    pub(super) crop: Crop,
    pub(super) memory: Memory,
    pub(super) features: [i8; VERIFIER_FEATURES],
    pub(super) feature_count: usize,
    /// Those of a run before the last, while two are compared.
    kept_features: [i8; VERIFIER_FEATURES],
    pub(super) view: usize,
    pub(super) corrections: Corrections,
    pub(super) seen: Seen,
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

impl Workspace {
    /// Empty working memory.
    pub const fn new() -> Self {
        Workspace {
            crop: Crop::new(),
            memory: Memory::new(),
            features: [0; VERIFIER_FEATURES],
            feature_count: 0,
            kept_features: [0; VERIFIER_FEATURES],
            view: 0,
            corrections: Corrections::NONE,
            seen: Seen::NOTHING,
        }
    }

    /// What the refiners have seen in their last run, for weights. What a run that was not made
    /// would have seen is that of the run before it.
    pub fn seen(&mut self) -> &mut Seen {
        &mut self.seen
    }

    /// Features of the last iteration for the verifier, `[68][features]`, 0..127: the fine map at
    /// the landmarks of the global stage. Empty before the first.
    pub fn features(&self) -> &[i8] {
        self.features.get(..self.feature_count).unwrap_or(&[])
    }

    /// Keeps the features of a run while another follows, or exchanges those of both runs. Neither
    /// run's corrections hold then.
    pub fn exchange_features(&mut self) {
        self.corrections = Corrections::NONE;
        core::mem::swap(&mut self.features, &mut self.kept_features);
    }

    /// 80 KiB of the working memory, for other use between two runs. A run overwrites it and does
    /// not read it.
    pub fn scratch(&mut self) -> &mut [u8] {
        self.memory.scratch()
    }

    /// A crop and the memory of a network's maps, for a network of another module between two runs.
    /// A run overwrites both and does not read them.
    pub fn network_memory(&mut self) -> (&mut Crop, &mut Activations) {
        (&mut self.crop, self.memory.maps())
    }

    /// The same crop, and all of the memory of a regressor.
    pub(super) fn eye_memory(&mut self) -> (&mut Crop, &mut Memory) {
        (&mut self.crop, &mut self.memory)
    }

    /// Signed view of the global shape: 0 is frontal, then the model's views turned to the
    /// image right, then those turned left. Below [`super::AlignModel::signed_views`].
    pub fn view(&self) -> usize {
        self.view
    }
}
