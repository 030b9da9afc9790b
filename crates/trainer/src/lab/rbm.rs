//! A restricted Boltzmann machine with Gaussian visible units of deviation 1, learnt by contrastive
//! divergence with one step; then its filters tuned for a regression by gradients.

use super::features::{Features, Filters, OUTPUTS, sigmoid};
use crate::align::normal;
use faer::Mat;
use ndarray::{Array1, Array2, Axis, s};
use posewise::shape::LANDMARKS;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

/// How an RBM is trained.
pub struct Options {
    /// Passes over the rows.
    pub epochs: usize,
    /// Step along the mean gradient of a batch.
    pub rate: f32,
    /// Rows of a batch.
    pub batch: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            epochs: 10,
            rate: 0.005,
            batch: 100,
        }
    }
}

/// Hidden units learnt from rows of visible ones.
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
            mean += &((&v - &v2).sum_axis(Axis(0)) * gain);
        }
    }
    println!(
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

/// A sample to refine on: patches of its landmarks in rows, and where its landmarks should go.
pub type Example = (Array2<f32>, Array1<f32>);

/// Parameters with their Adam state; steps are shares of the parameters' own size.
struct Tuned {
    value: Array2<f32>,
    first: Array2<f32>,
    second: Array2<f32>,
    unit: f32,
}

impl Tuned {
    fn new(value: Array2<f32>) -> Tuned {
        let unit = (value.iter().map(|v| v * v).sum::<f32>() / value.len() as f32).sqrt();
        Tuned {
            first: Array2::zeros(value.raw_dim()),
            second: Array2::zeros(value.raw_dim()),
            unit,
            value,
        }
    }

    fn step(&mut self, gradient: &Array2<f32>, rate: f32, t: i32) {
        let (early, late) = (1.0 - 0.9f32.powi(t), 1.0 - 0.99f32.powi(t));
        let rate = rate * self.unit;
        ndarray::Zip::from(&mut self.value)
            .and(&mut self.first)
            .and(&mut self.second)
            .and(gradient)
            .for_each(|value, m, v, g| {
                *m = 0.9 * *m + 0.1 * g;
                *v = 0.99 * *v + 0.01 * g * g;
                *value -= rate * (*m / early) / ((*v / late).sqrt() + 1e-12);
            });
    }
}

/// Tunes filters and reduction by the squared error of the linear regression on top of them, which
/// is tuned along with them from `weights` (the last row is the bias). Returns the mean squared
/// error per output in the first and in the last pass.
pub fn refine(
    features: &mut Features,
    weights: &Mat<f32>,
    epochs: usize,
    examples: &[Example],
    rng: &mut ChaCha8Rng,
) -> [f32; 2] {
    const BATCH: usize = 32;
    const RATE: f32 = 0.01;
    let (inputs, outputs) = (weights.nrows() - 1, weights.ncols());
    let mean = features.mean.clone();
    let mut reduction = Tuned::new(features.reduction.clone());
    let filters = features.filters().expect("only filters can be refined");
    let mut tuned = Tuned::new(filters.weights.clone());
    let mut bias = Tuned::new(filters.bias.clone().insert_axis(Axis(0)));
    let mut top = Tuned::new(Array2::from_shape_fn((inputs, outputs), |(i, o)| {
        weights[(i, o)]
    }));
    let constant = Array1::from_shape_fn(outputs, |o| weights[(inputs, o)]);
    let steps = (epochs * (examples.len() / BATCH)) as f32;
    let mut order: Vec<usize> = (0..examples.len()).collect();
    let (mut t, mut errors) = (0, vec![]);
    for _ in 0..epochs {
        order.shuffle(rng);
        let mut sum = 0.0;
        for batch in order.chunks_exact(BATCH) {
            let views: Vec<_> = batch.iter().map(|i| examples[*i].0.view()).collect();
            let patches = ndarray::concatenate(Axis(0), &views).expect("patches are equally wide");
            let mut hidden = patches.dot(&tuned.value);
            hidden += &bias.value.row(0);
            hidden.mapv_inplace(sigmoid);
            let centred = &hidden - &mean;
            let reduced = centred.dot(&reduction.value);
            let reduced = reduced
                .into_shape_with_order((BATCH, LANDMARKS * OUTPUTS))
                .expect("a row per sample");
            let mut error = reduced.dot(&top.value) + &constant;
            for (mut row, i) in error.rows_mut().into_iter().zip(batch) {
                row -= &examples[*i].1;
            }
            sum += error.iter().map(|e| e * e).sum::<f32>() / error.len() as f32;
            let back = error.dot(&top.value.t());
            let back = back
                .into_shape_with_order((BATCH * LANDMARKS, OUTPUTS))
                .expect("a row per landmark");
            let mut to_hidden = back.dot(&reduction.value.t());
            to_hidden.zip_mut_with(&hidden, |d, h| *d *= h * (1.0 - h));
            t += 1;
            let rate = RATE * (1.0 - (t - 1) as f32 / steps);
            top.step(&reduced.t().dot(&error), rate, t);
            reduction.step(&centred.t().dot(&back), rate, t);
            bias.step(&to_hidden.sum_axis(Axis(0)).insert_axis(Axis(0)), rate, t);
            tuned.step(&patches.t().dot(&to_hidden), rate, t);
        }
        errors.push(sum / (examples.len() / BATCH) as f32);
    }
    *filters = Filters {
        weights: tuned.value,
        bias: bias.value.slice(s![0, ..]).to_owned(),
    };
    features.reduction = reduction.value;
    [errors[0], errors[epochs - 1]]
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
