//! Filters on patches, and principal components.

use faer::{Mat, Side};
use ndarray::{Array1, Array2, Axis};
use serde::{Deserialize, Serialize};

/// Features per landmark after reduction.
pub const OUTPUTS: usize = 24;

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

/// The first principal components, brought to a deviation of 1.
pub fn whitening(patches: &Array2<f32>) -> Filters {
    let mean = patches.mean_axis(Axis(0)).expect("there are patches");
    let (values, vectors) = principal(&covariance(patches, &mean));
    let weights = Array2::from_shape_fn((mean.len(), OUTPUTS), |(i, o)| {
        (vectors[(i, o)] / values[o].sqrt().max(1e-6)) as f32
    });
    let bias = -mean.dot(&weights);
    Filters { weights, bias }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise_train::align::normal;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn whitened_components_have_unit_deviation() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let rows = Array2::from_shape_simple_fn((4000, 30), || normal(&mut rng));
        let mixed = &rows * &Array1::from_shape_fn(30, |i| 1.0 + i as f32);
        let filters = whitening(&mixed);
        let out = mixed.dot(&filters.weights) + &filters.bias;
        for column in out.columns() {
            assert!((column.std(0.0) - 1.0).abs() < 0.01 && column.mean().unwrap().abs() < 0.01);
        }
    }
}
