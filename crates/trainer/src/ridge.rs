//! Ridge regression from `i8` features, by normal equations that are sums over samples.

use anyhow::{Result, anyhow};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, Par, Side};
use rayon::prelude::*;

/// Features are divided by this, so that sums of squares stay near one per sample.
pub const FEATURE_UNIT: f32 = 64.0;

/// Sums of `x·xᵀ` and `x·yᵀ`, x with a constant 1 appended. Sums of shards can be added.
#[derive(Clone)]
pub struct Normal {
    /// Lower triangle.
    xx: Mat<f32>,
    xy: Mat<f32>,
    samples: f64,
}

impl Normal {
    /// No samples yet.
    pub fn new(features: usize, outputs: usize) -> Normal {
        let xx = Mat::zeros(features + 1, features + 1);
        Normal {
            xx,
            xy: Mat::zeros(features + 1, outputs),
            samples: 0.0,
        }
    }

    /// Adds samples: rows of features, rows of targets, weights.
    pub fn add(&mut self, x: &[&[i8]], y: &[&[f32]], weight: &[f32]) {
        const BLOCK: usize = 2048;
        let (features, outputs) = (self.xx.nrows() - 1, self.xy.ncols());
        let blocks: Vec<_> = x
            .chunks(BLOCK)
            .zip(y.chunks(BLOCK))
            .zip(weight.chunks(BLOCK))
            .collect();
        let sum = blocks
            .into_par_iter()
            .fold(
                || Normal::new(features, outputs),
                |mut sum, ((x, y), w)| {
                    let a = Mat::from_fn(features + 1, x.len(), |i, n| {
                        let v = if i == features {
                            1.0
                        } else {
                            x[n][i] as f32 / FEATURE_UNIT
                        };
                        v * w[n].sqrt()
                    });
                    let b = Mat::from_fn(x.len(), outputs, |n, o| y[n][o] * w[n].sqrt());
                    accumulate(&mut sum.xx, &mut sum.xy, &a, &b);
                    sum.samples += w.iter().map(|w| *w as f64).sum::<f64>();
                    sum
                },
            )
            .reduce_with(|mut a, b| {
                a.merge(&b);
                a
            });
        if let Some(sum) = sum {
            self.merge(&sum);
        }
    }

    /// The sums of both.
    pub fn merge(&mut self, other: &Normal) {
        self.xx += &other.xx;
        self.xy += &other.xy;
        self.samples += other.samples;
    }

    /// Weights (features + 1 rows, the last one the bias) that minimise the mean squared error plus
    /// `ridge`·|w|².
    pub fn solve(&self, ridge: f32) -> Result<Mat<f32>> {
        let n = self.xx.nrows();
        let mut xx = Mat::<f64>::from_fn(n, n, |i, j| {
            if i >= j {
                self.xx[(i, j)] as f64
            } else {
                self.xx[(j, i)] as f64
            }
        });
        for i in 0..n - 1 {
            xx[(i, i)] += ridge as f64 * self.samples;
        }
        let xy = Mat::<f64>::from_fn(n, self.xy.ncols(), |i, j| self.xy[(i, j)] as f64);
        let llt = xx
            .llt(Side::Lower)
            .map_err(|e| anyhow!("ridge system: {e:?}"))?;
        let w = llt.solve(&xy);
        Ok(Mat::from_fn(n, w.ncols(), |i, j| w[(i, j)] as f32))
    }
}

/// Adds `a·aᵀ` (its lower triangle) and `a·b`: samples are columns of `a` and rows of `b`.
///
/// One thread a block: threads inside one product spin while they wait for each other.
pub fn accumulate(xx: &mut Mat<f32>, xy: &mut Mat<f32>, a: &Mat<f32>, b: &Mat<f32>) {
    matmul(
        &mut *xx,
        BlockStructure::TriangularLower,
        Accum::Add,
        a,
        BlockStructure::Rectangular,
        a.transpose(),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    faer::linalg::matmul::matmul(&mut *xy, Accum::Add, a, b, 1.0, Par::Seq);
}

/// Output of the weights for one row of features.
pub fn predict(weights: &Mat<f32>, x: &[i8]) -> Vec<f32> {
    outputs(weights, |column| {
        let dot: f32 = column.iter().zip(x).map(|(w, x)| w * *x as f32).sum();
        dot / FEATURE_UNIT
    })
}

/// What `product` makes of each output's weights, plus its bias.
pub fn outputs(weights: &Mat<f32>, product: impl Fn(&[f32]) -> f32) -> Vec<f32> {
    let n = weights.nrows() - 1;
    (0..weights.ncols())
        .map(|o| {
            let column = weights
                .col(o)
                .try_as_col_major()
                .expect("columns are contiguous");
            let column = column.as_slice();
            product(&column[..n]) + column[n]
        })
        .collect()
}
/// Quantised weights of one output: `scale·Σ weight·feature + bias`.
pub struct Linear {
    pub weight: Vec<i8>,
    pub scale: f32,
    pub bias: f32,
}

impl Linear {
    /// From a solution with one output.
    pub fn quantise(weights: &Mat<f32>) -> Linear {
        let inputs = weights.nrows() - 1;
        let column: Vec<f32> = (0..inputs).map(|i| weights[(i, 0)]).collect();
        let largest = column.iter().fold(1e-9f32, |m, w| m.max(w.abs()));
        let scale = largest / 127.0;
        Linear {
            weight: column.iter().map(|w| (w / scale).round() as i8).collect(),
            scale: scale / FEATURE_UNIT,
            bias: weights[(inputs, 0)],
        }
    }
}
