//! The local features of one stage: two kinds, both reduced to the same number.

use super::crop::{FaceCrop, PATCH};
use super::filters::{Filters, OUTPUTS, covariance, principal};
use super::rbm;
use ndarray::{Array1, Array2, Axis};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Hidden units of the RBM.
const HIDDEN: usize = 64;
/// Distance and side of the histograms' cells by stage, in canonical units; what both kinds see is
/// as wide as three cells.
const CELLS: [(f32, f32); 4] = [(8.0, 13.0), (7.0, 13.0), (6.0, 11.0), (5.0, 9.0)];

/// Kind of local features.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Gradient histograms of 3×3 cells.
    Hog,
    /// Hidden units of a restricted Boltzmann machine.
    Rbm,
}

impl Kind {
    /// Canonical units per crop px.
    pub fn step(self, stage: usize) -> f32 {
        let (distance, side) = CELLS[stage];
        match self {
            Kind::Hog => 1.0,
            Kind::Rbm => (2.0 * distance + side) / PATCH as f32,
        }
    }
}

#[derive(Serialize, Deserialize)]
enum Raw {
    Hog(f32, f32),
    Filters(Filters),
}

/// The features of one stage: raw ones and what reduces them to [`OUTPUTS`].
#[derive(Serialize, Deserialize)]
pub struct Features {
    raw: Raw,
    /// Of the raw features.
    mean: Array1<f32>,
    /// A column per output; outputs have a mean square of 1.
    reduction: Array2<f32>,
    /// Canonical units per px of the crops.
    pub step: f32,
}

impl Features {
    /// Learns a stage's features from crops.
    pub fn fit(kind: Kind, stage: usize, crops: &[FaceCrop], rng: &mut ChaCha8Rng) -> Features {
        let patches = || stacked(crops.iter().map(FaceCrop::patches));
        let raw = match kind {
            Kind::Hog => Raw::Hog(CELLS[stage].0, CELLS[stage].1),
            Kind::Rbm => Raw::Filters(rbm::train(
                &patches(),
                HIDDEN,
                &rbm::Options::default(),
                rng,
            )),
        };
        let raw_rows = stacked(crops.iter().map(|crop| raw_of(&raw, crop)));
        let mean = raw_rows.mean_axis(Axis(0)).expect("there are crops");
        let (_, vectors) = principal(&covariance(&raw_rows, &mean));
        let reduction =
            Array2::from_shape_fn((mean.len(), OUTPUTS), |(i, o)| vectors[(i, o)] as f32);
        let mut features = Features {
            raw,
            mean,
            reduction,
            step: kind.step(stage),
        };
        features.rescale(crops);
        features
    }

    /// Makes outputs 1 in the mean square over these crops.
    fn rescale(&mut self, crops: &[FaceCrop]) {
        let raw_rows = stacked(crops.iter().map(|crop| raw_of(&self.raw, crop)));
        self.mean = raw_rows.mean_axis(Axis(0)).expect("there are crops");
        let out = (raw_rows - &self.mean).dot(&self.reduction);
        let square = out.iter().map(|v| (*v as f64).powi(2)).sum::<f64>() / out.len() as f64;
        self.reduction /= square.sqrt() as f32;
    }

    /// Features of a crop, landmark after landmark.
    pub fn of(&self, crop: &FaceCrop) -> Vec<f32> {
        let raw = raw_of(&self.raw, crop) - &self.mean;
        raw.dot(&self.reduction).into_iter().collect()
    }
}

fn raw_of(raw: &Raw, crop: &FaceCrop) -> Array2<f32> {
    match raw {
        Raw::Hog(distance, side) => crop.histograms(*distance, *side),
        Raw::Filters(filters) => filters.of(&crop.patches()),
    }
}

fn stacked(parts: impl Iterator<Item = Array2<f32>>) -> Array2<f32> {
    let parts: Vec<_> = parts.collect();
    let views: Vec<_> = parts.iter().map(|part| part.view()).collect();
    ndarray::concatenate(Axis(0), &views).expect("parts are equally wide")
}
