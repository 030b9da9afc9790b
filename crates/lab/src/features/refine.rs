//! Tunes the filters of a stage for its regression, by gradients.

use super::filters::{Filters, OUTPUTS, sigmoid};
use super::local::Features;
use faer::Mat;
use ndarray::{Array1, Array2, Axis, s};
use posewise::shape::LANDMARKS;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

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
/// error per output in the first and in the last epoch.
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
