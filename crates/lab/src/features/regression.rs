//! Ridge regression from local features to displacements, on all landmarks' features or on some.

use super::filters::OUTPUTS;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use posewise::shape::LANDMARKS;
use posewise_train::ridge;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Coordinates of a shape.
pub const COORDINATES: usize = 2 * LANDMARKS;
/// Features of all landmarks.
pub const INPUTS: usize = LANDMARKS * OUTPUTS;
/// Weights of |w|² in the ridge, of which each stage takes the best on a fold.
pub const RIDGES: [f32; 8] = [3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 10.0, 100.0];

/// What a landmark's displacement is predicted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Links {
    /// All landmarks' features.
    Global,
    /// Its own features.
    Own,
    /// Its own and those of the landmarks that help most beside them, on a fold: this many in all.
    Best(usize),
}

/// Sums over samples of products of features (a constant 1 among them) and displacements.
pub struct Normal {
    xx: Mat<f32>,
    xy: Mat<f32>,
    yy: Vec<f64>,
    weight: f64,
}

/// Weights of all outputs, a column each, the bias last.
#[derive(Serialize, Deserialize)]
pub struct Linear(#[serde(with = "super::stored")] Mat<f32>);

impl Linear {
    /// Outputs for features.
    pub fn of(&self, x: &[f32]) -> Vec<f32> {
        ridge::outputs(&self.0, |column| {
            column.iter().zip(x).map(|(w, x)| w * x).sum()
        })
    }

    /// With its outputs projected on the columns of `basis`, which are orthonormal.
    pub fn within(&self, basis: &Mat<f32>) -> Linear {
        Linear((&self.0 * basis) * basis.transpose())
    }
}

/// Features that predict some of the outputs.
pub type Set = (Vec<usize>, Range<usize>);

impl Normal {
    /// No samples yet.
    pub fn new(inputs: usize, outputs: usize) -> Normal {
        Normal {
            xx: Mat::zeros(inputs + 1, inputs + 1),
            xy: Mat::zeros(inputs + 1, outputs),
            yy: vec![0.0; outputs],
            weight: 0.0,
        }
    }

    /// The sums of both.
    pub fn merge(mut self, other: &Normal) -> Normal {
        self.xx += &other.xx;
        self.xy += &other.xy;
        self.yy.iter_mut().zip(&other.yy).for_each(|(a, b)| *a += b);
        self.weight += other.weight;
        self
    }

    /// Adds samples: features, displacements, weight.
    pub fn add(&mut self, samples: &[(&[f32], &[f32], f32)]) {
        let inputs = self.xx.nrows() - 1;
        let a = Mat::from_fn(inputs + 1, samples.len(), |i, n| {
            let (x, _, w) = samples[n];
            w.sqrt() * x.get(i).unwrap_or(&1.0)
        });
        let b = Mat::from_fn(samples.len(), self.yy.len(), |n, o| {
            samples[n].1[o] * samples[n].2.sqrt()
        });
        ridge::accumulate(&mut self.xx, &mut self.xy, &a, &b);
        for (_, y, w) in samples {
            let squares = y.iter().map(|v| (v * v * w) as f64);
            self.yy.iter_mut().zip(squares).for_each(|(s, v)| *s += v);
            self.weight += *w as f64;
        }
    }

    fn products(&self, inputs: &[usize]) -> Mat<f64> {
        Mat::from_fn(inputs.len(), inputs.len(), |i, j| {
            let (i, j) = (inputs[i], inputs[j]);
            self.xx[(i.max(j), i.min(j))] as f64
        })
    }

    /// Weights of one set that minimise mean squared error plus `ridge`·|w|², the bias last.
    fn solve(&self, (inputs, outputs): &Set, ridge: f32) -> Mat<f64> {
        let mut xx = self.products(inputs);
        for i in 0..inputs.len() - 1 {
            xx[(i, i)] += ridge as f64 * self.weight;
        }
        let xy = Mat::from_fn(inputs.len(), outputs.len(), |i, o| {
            self.xy[(inputs[i], outputs.start + o)] as f64
        });
        xx.llt(Side::Lower).expect("a ridge is positive").solve(&xy)
    }

    /// Squared error of such weights, summed over the outputs, mean over the samples.
    fn error(&self, (inputs, outputs): &Set, weights: &Mat<f64>) -> f64 {
        let product = self.products(inputs) * weights;
        let mut sum: f64 = self.yy[outputs.clone()].iter().sum();
        for o in 0..outputs.len() {
            for (i, input) in inputs.iter().enumerate() {
                let xy = self.xy[(*input, outputs.start + o)] as f64;
                sum += weights[(i, o)] * (product[(i, o)] - 2.0 * xy);
            }
        }
        sum / self.weight
    }
}

/// The features that predict each output.
pub fn sets(links: Links, train: &Normal, held: &Normal) -> Vec<Set> {
    let of = |landmarks: &[usize], j: usize| -> Set {
        let inputs = landmarks
            .iter()
            .flat_map(|l| l * OUTPUTS..(l + 1) * OUTPUTS);
        (inputs.chain([INPUTS]).collect(), 2 * j..2 * j + 2)
    };
    let each = (0..LANDMARKS).into_par_iter();
    match links {
        Links::Global => vec![((0..=INPUTS).collect(), 0..COORDINATES)],
        Links::Own => each.map(|j| of(&[j], j)).collect(),
        Links::Best(count) => each
            .map(|j| {
                let mut others: Vec<(f64, usize)> = (0..LANDMARKS)
                    .filter(|i| *i != j)
                    .map(|i| {
                        let set = of(&[j, i], j);
                        (held.error(&set, &train.solve(&set, RIDGES[1])), i)
                    })
                    .collect();
                others.sort_by(|a, b| a.0.total_cmp(&b.0));
                let best = others.iter().take(count - 1).map(|(_, i)| *i);
                of(&[j].into_iter().chain(best).collect::<Vec<_>>(), j)
            })
            .collect(),
    }
}

/// The weight of |w|² that leaves the smallest error on what was held out.
pub fn best_ridge(ridges: &[f32], sets: &[Set], train: &Normal, held: &Normal) -> f32 {
    let error = |ridge: f32| -> f64 {
        let each = sets.par_iter();
        each.map(|set| held.error(set, &train.solve(set, ridge)))
            .sum()
    };
    let errors = ridges.iter().map(|ridge| (error(*ridge), *ridge));
    let best = errors.min_by(|a, b| a.0.total_cmp(&b.0));
    best.expect("there are ridges").1
}

/// Weights of all sets together.
pub fn solve(normal: &Normal, sets: &[Set], ridge: f32) -> Linear {
    let mut all = Mat::<f32>::zeros(INPUTS + 1, COORDINATES);
    let solved: Vec<_> = sets.par_iter().map(|s| normal.solve(s, ridge)).collect();
    for ((inputs, outputs), weights) in sets.iter().zip(&solved) {
        for (o, output) in outputs.clone().enumerate() {
            for (i, input) in inputs.iter().enumerate() {
                all[(*input, output)] = weights[(i, o)] as f32;
            }
        }
    }
    Linear(all)
}
