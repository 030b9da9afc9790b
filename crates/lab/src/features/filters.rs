//! Filters on patches, and principal components.

use faer::{Mat, Side};
use ndarray::{Array1, Array2};
use serde::{Deserialize, Serialize};

/// Features per landmark after reduction; fewer in tests, for regressions on a third of the numbers
/// take a twentieth of the time.
pub const OUTPUTS: usize = if cfg!(test) { 8 } else { 24 };

/// Filters on a patch: sigmoid(bias + weightsᵀ·patch), shared by all landmarks.
#[derive(Clone, Serialize, Deserialize)]
pub struct Filters {
    /// A column per output.
    pub weights: Array2<f32>,
    /// Of each output.
    pub bias: Array1<f32>,
}

impl Filters {
    /// Outputs for patches in rows.
    pub fn of(&self, patches: &Array2<f32>) -> Array2<f32> {
        let mut out = patches.dot(&self.weights);
        out += &self.bias;
        out.mapv_inplace(sigmoid);
        out
    }
}

/// 1 / (1 + e⁻ᶻ)
pub fn sigmoid(z: f32) -> f32 {
    1.0 / (1.0 + (-z).exp())
}

/// Covariance of rows around their mean.
pub fn covariance(rows: &Array2<f32>, mean: &Array1<f32>) -> Mat<f64> {
    let centred = rows - mean;
    let sum = centred.t().dot(&centred);
    Mat::from_fn(mean.len(), mean.len(), |i, j| {
        sum[(i, j)] as f64 / rows.nrows() as f64
    })
}

/// Eigenvalues of a symmetric matrix and its eigenvectors in columns, largest first.
pub fn principal(matrix: &Mat<f64>) -> (Vec<f64>, Mat<f64>) {
    let eigen = matrix
        .self_adjoint_eigen(Side::Lower)
        .expect("a symmetric matrix has eigenvalues");
    let (n, values) = (matrix.nrows(), eigen.S().column_vector());
    let vectors = Mat::from_fn(n, n, |i, j| eigen.U()[(i, n - 1 - j)]);
    ((0..n).map(|j| values[n - 1 - j]).collect(), vectors)
}
