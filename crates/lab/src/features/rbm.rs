//! A restricted Boltzmann machine with Gaussian visible units of deviation 1, trained by
//! contrastive divergence with one step.

use super::filters::Filters;
use ndarray::{Array1, Array2, Axis};
use posewise_train::align::normal;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

/// How an RBM is trained.
pub struct Options {
    /// How often all rows are used.
    pub epochs: usize,
    /// Step along the mean gradient of a batch.
    pub rate: f32,
    /// Rows of a batch.
    pub batch: usize,
    /// Mean probability that hidden units are driven to (Lee et al. 2008).
    pub sparsity: Option<f32>,
}

/// Step of the biases towards the wanted mean probability.
const SPARSITY_RATE: f32 = 0.05;

impl Default for Options {
    fn default() -> Self {
        Options {
            epochs: 10,
            rate: 0.005,
            batch: 100,
            sparsity: None,
        }
    }
}

/// Hidden units trained on rows of visible ones.
pub fn train(
    rows: &Array2<f32>,
    hidden: usize,
    options: &Options,
    rng: &mut ChaCha8Rng,
) -> Filters {
    let visible = rows.ncols();
    let mut filters = Filters {
        weights: Array2::from_shape_simple_fn((visible, hidden), || 0.01 * normal(rng)),
        bias: Array1::zeros(hidden),
    };
    let mut mean = rows.mean_axis(Axis(0)).expect("there are rows");
    let mut speed = Array2::<f32>::zeros((visible, hidden));
    let mut order: Vec<usize> = (0..rows.nrows()).collect();
    for epoch in 0..options.epochs {
        let momentum = if epoch < 2 { 0.5 } else { 0.9 };
        let rate = options.rate * (1.0 - epoch as f32 / options.epochs as f32);
        order.shuffle(rng);
        for batch in order.chunks_exact(options.batch) {
            let v = rows.select(Axis(0), batch);
            let h = filters.of(&v);
            let drawn = h.mapv(|p| f32::from(rng.random_range(0.0..1.0) < p));
            let v2 = drawn.dot(&filters.weights.t()) + &mean;
            let h2 = filters.of(&v2);
            let gain = rate / batch.len() as f32;
            let gradient = v.t().dot(&h) - v2.t().dot(&h2);
            speed = speed * momentum + gradient * gain - &filters.weights * (rate * 2e-4);
            filters.weights += &speed;
            filters.bias += &((&h - &h2).sum_axis(Axis(0)) * gain);
            if let Some(wanted) = options.sparsity {
                let found = h.mean_axis(Axis(0)).expect("a batch has rows");
                filters.bias += &(found.mapv(|found| SPARSITY_RATE * (wanted - found)));
            }
            mean += &((&v - &v2).sum_axis(Axis(0)) * gain);
        }
    }
    eprintln!(
        "    RBM: mean square {:.3}, left after reconstruction {:.3}",
        rows.iter().map(|v| v * v).sum::<f32>() / rows.len() as f32,
        left(rows, &filters, &mean)
    );
    filters
}

/// Mean square of what a reconstruction from the hidden units' probabilities leaves.
fn left(rows: &Array2<f32>, filters: &Filters, mean: &Array1<f32>) -> f32 {
    let rest = rows - &(filters.of(rows).dot(&filters.weights.t()) + mean);
    rest.iter().map(|v| v * v).sum::<f32>() / rest.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn learns_bars() {
        const SIDE: usize = 6;
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut rows = Array2::from_elem((3000, SIDE * SIDE), 0.0f32);
        for mut row in rows.rows_mut() {
            let (at, upright) = (rng.random_range(0..SIDE), rng.random_bool(0.5));
            for k in 0..SIDE {
                row[if upright {
                    k * SIDE + at
                } else {
                    at * SIDE + k
                }] = 2.0;
            }
        }
        let options = Options {
            epochs: 30,
            rate: 0.02,
            batch: 50,
            sparsity: None,
        };
        let filters = train(&rows, 24, &options, &mut rng);
        let mean = rows.mean_axis(Axis(0)).unwrap();
        let alone = (&rows - &mean).mapv(|v| v * v).mean().unwrap();
        // The visible bias is not kept: the best one, given the filters.
        let bias = (&rows - &filters.of(&rows).dot(&filters.weights.t())).mean_axis(Axis(0));
        let rest = left(&rows, &filters, &bias.unwrap());
        assert!(rest < 0.3 * alone, "{rest} of {alone}");
    }
}
