//! Gaussian models of a synthesised face (thesis 3.2), and their update on line (3.4).
//!
//! For each landmark, mean μ and covariance U·diag(λ)·Uᵀ of its descriptors over the synthesised
//! views, with the leading eigenvectors and a floor for the rest. The energy is the Mahalanobis
//! distance over the descriptor's length. On line, with rates α and β and fixed U:
//! μ ← (1 − α)·μ + α·y, and λ ← (1 − β)·λ + β·z² with z = Uᵀ(y − μ).

use super::scorer::LocalModel;
use super::synthesis::{POINTS, Sample};
use nalgebra::{DMatrix, DVector};

/// Share of the variance that the eigenvectors have.
const VARIANCE: f64 = 0.95;
/// Least eigenvalue, as a share of the mean variance of a number of the descriptor: no view is
/// known better than its rendering.
const FLOOR: f64 = 0.25;
/// Least number of views for a model.
const LEAST_VIEWS: usize = 6;

/// Rates of the update, tuned on the clip 04_free (docs/dev/lab.md).
#[derive(Clone, Copy, Debug, PartialEq, clap::Args, serde::Serialize)]
pub struct Rates {
    /// Rate of the means (`adaptive`).
    #[arg(long, default_value_t = 0.005)]
    pub alpha: f64,
    /// Rate of the eigenvalues (`adaptive`).
    #[arg(long, default_value_t = 0.02)]
    pub beta: f64,
}

struct Gaussian {
    mean: DVector<f64>,
    /// Columns are eigenvectors.
    vectors: DMatrix<f64>,
    values: DVector<f64>,
    /// Variance of all other directions, and the least of these.
    rest: f64,
}

/// Models of all landmarks.
pub struct Gaussians {
    points: Vec<Option<Gaussian>>,
    /// `None` leaves the models as they are.
    rates: Option<Rates>,
}

impl Gaussian {
    fn new(samples: &[&Vec<f32>]) -> Option<Gaussian> {
        let first = samples.first()?;
        if samples.len() < LEAST_VIEWS {
            return None;
        }
        let numbers = samples.iter().flat_map(|s| s.iter().map(|v| f64::from(*v)));
        let data = DMatrix::from_iterator(first.len(), samples.len(), numbers);
        let mean = data.column_mean();
        let centred = DMatrix::from_fn(data.nrows(), data.ncols(), |r, c| data[(r, c)] - mean[r]);
        let covariance = &centred * centred.transpose() / samples.len() as f64;
        let total = covariance.trace();
        let eigen = covariance.symmetric_eigen();
        let mut order: Vec<usize> = (0..first.len()).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let mut sum = 0.0;
        let kept = order.iter().take_while(|k| {
            let is_kept = sum < VARIANCE * total;
            sum += eigen.eigenvalues[**k];
            is_kept
        });
        let kept: Vec<usize> = kept.copied().collect();
        let rest = FLOOR * total / first.len() as f64 + f64::EPSILON;
        let values = kept.iter().map(|k| eigen.eigenvalues[*k].max(rest));
        Some(Gaussian {
            values: DVector::from_vec(values.collect()),
            vectors: eigen.eigenvectors.select_columns(&kept),
            mean,
            rest,
        })
    }

    fn energy(&self, descriptor: &[f32]) -> f64 {
        let (length, off) = self.off(descriptor);
        let within = self.vectors.tr_mul(&off);
        let terms = within.iter().zip(&self.values);
        let (distance, explained) = terms.fold((0.0, 0.0), |(d, e), (z, value)| {
            (d + z * z / value, e + z * z)
        });
        let rest = (off.norm_squared() - explained).max(0.0) / self.rest;
        (distance + rest) / length
    }

    fn off(&self, descriptor: &[f32]) -> (f64, DVector<f64>) {
        let numbers = descriptor.iter().map(|v| f64::from(*v));
        let off = DVector::from_iterator(descriptor.len(), numbers) - &self.mean;
        (descriptor.len() as f64, off)
    }

    fn update(&mut self, descriptor: &[f32], rates: Rates) {
        let (_, off) = self.off(descriptor);
        self.mean += rates.alpha * &off;
        let within = self.vectors.tr_mul(&((1.0 - rates.alpha) * off));
        for (value, z) in self.values.iter_mut().zip(&within) {
            *value = ((1.0 - rates.beta) * *value + rates.beta * z * z).max(self.rest);
        }
    }
}

impl Gaussians {
    /// From synthesised views; with rates the models follow the frames.
    pub fn new(samples: &[Sample], rates: Option<Rates>) -> Gaussians {
        let point = |point: usize| {
            let of_point = samples.iter().filter_map(|s| s.positive[point].as_ref());
            Gaussian::new(&of_point.collect::<Vec<_>>())
        };
        Gaussians {
            points: (0..POINTS.len()).map(point).collect(),
            rates,
        }
    }
}

impl LocalModel for Gaussians {
    fn energy(&self, point: usize, descriptor: &[f32]) -> Option<f64> {
        self.points[point].as_ref().map(|g| g.energy(descriptor))
    }

    fn accept(&mut self, point: usize, descriptor: &[f32]) {
        if let (Some(model), Some(rates)) = (&mut self.points[point], self.rates) {
            model.update(descriptor, rates);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points along one direction, and a little beside it.
    fn line() -> Vec<Vec<f32>> {
        let at = |k: i32| vec![k as f32 * 0.1, 0.02 * (k % 2) as f32, 0.0];
        (-10..=10).map(at).collect()
    }

    #[test]
    fn directions_of_large_variance_cost_less() {
        let samples = line();
        let model = Gaussian::new(&samples.iter().collect::<Vec<_>>()).unwrap();
        assert_eq!(model.values.len(), 1);
        let energy = |x, z| model.energy(&[x, 0.01, z]);
        assert!(energy(0.0, 0.0) < 0.01);
        assert!(energy(0.5, 0.0) < energy(0.0, 0.5));
        assert!(Gaussian::new(&[&samples[0]]).is_none(), "too few views");
    }

    #[test]
    fn models_follow_what_is_seen() {
        let samples = line();
        let mut model = Gaussian::new(&samples.iter().collect::<Vec<_>>()).unwrap();
        let new = [0.0, 0.01, 0.4];
        let before = model.energy(&new);
        let rates = Rates {
            alpha: 0.1,
            beta: 0.1,
        };
        (0..50).for_each(|_| model.update(&new, rates));
        assert!(model.energy(&new) < 0.01 * before);
        assert!(model.values[0] >= model.rest);
    }
}
