//! The local features of one stage: three kinds, all reduced to the same number.

pub use super::crop::FaceCrop;
use super::crop::{PATCH, UNITS};
use super::filters::{Filters, OUTPUTS, covariance, principal};
use super::rbm;
use ndarray::{Array1, Array2, Axis};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Hidden units of the RBM.
const HIDDEN: usize = 64;
/// Distance and side of the histograms' cells by stage, in canonical units; what all kinds see is
/// as wide as three cells.
const CELLS: [(f32, f32); 4] = [(8.0, 13.0), (7.0, 13.0), (6.0, 11.0), (5.0, 9.0)];

/// Side of a cell that hidden units are pooled over \[crop px\].
const POOLED: f32 = 8.0;
/// Windows of a crop that hidden units are learned from.
const WINDOWS: usize = 64;
/// How hidden units on windows are trained; those that are seldom on find edges.
const ON_WINDOWS: rbm::Options = rbm::Options {
    epochs: 15,
    rate: 0.02,
    batch: 100,
    sparsity: Some(0.1),
};
/// Added to the variances by which windows are whitened: beyond it there is mostly noise.
const WHITENING: f64 = 0.01;

/// Kind of local features.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Gradient histograms of 3×3 cells.
    Hog,
    /// Hidden units of a restricted Boltzmann machine on whole patches.
    Rbm,
    /// Hidden units of a restricted Boltzmann machine on small windows, pooled over 3×3 cells.
    PooledRbm,
}

impl Kind {
    /// Canonical units per crop px.
    pub fn step(self, stage: usize) -> f32 {
        let (distance, side) = CELLS[stage];
        match self {
            Kind::Hog => 1.0,
            Kind::Rbm => (2.0 * distance + side) / PATCH as f32,
            Kind::PooledRbm => side / POOLED,
        }
    }
}

#[derive(Serialize, Deserialize)]
enum Raw {
    /// Distance and side of cells \[px\].
    Hog(f32, f32),
    Filters(Filters),
    /// Filters, distance and side of cells \[px\].
    Pooled(Filters, f32, f32),
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
            Kind::PooledRbm => {
                let (distance, side) = CELLS[stage];
                let step = kind.step(stage);
                Raw::Pooled(on_windows(crops, rng), distance / step, side / step)
            }
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
        Raw::Pooled(filters, distance, side) => crop.pooled(filters, *distance, *side),
    }
}

/// Hidden units on whitened windows of crops, with the whitening in their weights.
fn on_windows(crops: &[FaceCrop], rng: &mut ChaCha8Rng) -> Filters {
    let some = crops.iter().map(|crop| {
        let all = crop.windows();
        let drawn = (0..WINDOWS).map(|_| rng.random_range(0..all.nrows()));
        all.select(Axis(0), &drawn.collect::<Vec<_>>())
    });
    let rows = stacked(some.collect::<Vec<_>>().into_iter());
    let mean = rows.mean_axis(Axis(0)).expect("there are windows");
    let (values, vectors) = principal(&covariance(&rows, &mean));
    let whitening = Array2::from_shape_fn((mean.len(), mean.len()), |(i, j)| {
        let terms = values.iter().enumerate();
        let terms = terms.map(|(k, value)| {
            vectors[(i, k)] * vectors[(j, k)] / (value.max(0.0) + WHITENING).sqrt()
        });
        terms.sum::<f64>() as f32
    });
    let mut filters = rbm::train(&rows.dot(&whitening), UNITS, &ON_WINDOWS, rng);
    filters.weights = whitening.dot(&filters.weights);
    filters
}

fn stacked(parts: impl Iterator<Item = Array2<f32>>) -> Array2<f32> {
    let parts: Vec<_> = parts.collect();
    let views: Vec<_> = parts.iter().map(|part| part.view()).collect();
    ndarray::concatenate(Axis(0), &views).expect("parts are equally wide")
}
