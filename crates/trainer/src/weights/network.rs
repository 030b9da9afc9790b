//! The network from what a tracker gives to weights, trained by gradients.

use super::outputs::{Figures, NAMES, OF_PERSON, Options, Row, SEEN, places};
use posewise::align::{Inputs, WEIGHT_OUTPUTS};
use posewise_format::SectionWriter;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::ops::Range;

/// Persons of a batch.
const BATCH: usize = 24;
/// Largest rate; it falls as a cosine.
const RATE: f32 = 2e-3;
/// Weight decay.
const DECAY: f32 = 0.2;
/// Most standard deviations of an input from its mean, as in the library.
const FARTHEST: f32 = 5.0;
/// Noise of the inputs while training \[standard deviations\].
const NOISE: f32 = 0.2;

/// A trained network.
pub struct Trained {
    inputs: usize,
    hidden: usize,
    mean: Vec<f32>,
    scale: Vec<f32>,
    /// Weights of the hidden values `[hidden][inputs]`, their biases, `expand [hidden][outputs]`,
    /// `direct [outputs][inputs]`, `offset [outputs]`.
    parameters: Vec<f32>,
}

/// Where the parameters of each kind are.
struct Places {
    weights: Range<usize>,
    bias: Range<usize>,
    expand: Range<usize>,
    direct: Range<usize>,
    offset: Range<usize>,
}

impl Places {
    fn new(inputs: usize, hidden: usize) -> Places {
        let mut at = 0;
        let mut next = |length: usize| {
            at += length;
            at - length..at
        };
        Places {
            weights: next(hidden * inputs),
            bias: next(hidden),
            expand: next(hidden * WEIGHT_OUTPUTS),
            direct: next(WEIGHT_OUTPUTS * inputs),
            offset: next(WEIGHT_OUTPUTS),
        }
    }
}

/// A side of a picture: inputs with means of 0 and deviations of 1, and the truth.
struct Side {
    x: Vec<f32>,
    y: [f32; WEIGHT_OUTPUTS],
}

/// The same side of all pictures of a person.
type Person = Vec<Side>;

fn dot(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 8;
    let mut sums = [0.0f32; LANES];
    let (a, rest_a) = a.as_chunks::<LANES>();
    let (b, rest_b) = b.as_chunks::<LANES>();
    for (a, b) in a.iter().zip(b) {
        (0..LANES).for_each(|k| sums[k] += a[k] * b[k]);
    }
    let rest: f32 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}

fn add(to: &mut [f32], from: &[f32], factor: f32) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += factor * f);
}

impl Trained {
    /// A network that says nothing.
    pub fn blank(inputs: usize) -> Trained {
        let places = Places::new(inputs, 1);
        Trained {
            inputs,
            hidden: 1,
            mean: vec![0.0; inputs],
            scale: vec![1.0; inputs],
            parameters: vec![0.0; places.offset.end],
        }
    }

    fn normalised(&self, raw: &Inputs) -> Vec<f32> {
        let numbers = raw.iter().zip(self.mean.iter().zip(&self.scale));
        numbers
            .map(|(v, (mean, scale))| ((v - mean) * scale).clamp(-FARTHEST, FARTHEST))
            .collect()
    }

    /// Hidden values and outputs.
    fn forward(&self, x: &[f32]) -> (Vec<f32>, [f32; WEIGHT_OUTPUTS]) {
        let places = Places::new(self.inputs, self.hidden);
        let p = &self.parameters;
        let rows = p[places.weights].chunks_exact(self.inputs);
        let hidden: Vec<f32> = rows
            .zip(&p[places.bias])
            .map(|(row, bias)| (dot(row, x) + bias).max(0.0))
            .collect();
        let mut y = *p[places.offset].first_chunk().expect("all offsets");
        for (y, row) in y.iter_mut().zip(p[places.direct].chunks_exact(self.inputs)) {
            *y += dot(row, x);
        }
        for (value, row) in hidden
            .iter()
            .zip(p[places.expand].chunks_exact(WEIGHT_OUTPUTS))
        {
            add(&mut y, row, *value);
        }
        (hidden, y)
    }

    /// Adds the gradient of the loss of a person to `gradient`.
    fn backward(&self, person: &Person, noise: &mut ChaCha8Rng, gradient: &mut [f32]) {
        let places = Places::new(self.inputs, self.hidden);
        let noisy: Vec<Vec<f32>> = person
            .iter()
            .map(|side| {
                let noise = |v: &f32| v + NOISE * (noise.random_range(-1.7..1.7f32));
                side.x.iter().map(noise).collect()
            })
            .collect();
        let runs: Vec<_> = noisy.iter().map(|x| self.forward(x)).collect();
        let n = person.len() as f32;
        let mut mean = [0.0; WEIGHT_OUTPUTS];
        for ((_, y), side) in runs.iter().zip(person) {
            (0..WEIGHT_OUTPUTS).for_each(|o| mean[o] += (y[o] - side.y[o]) / n);
        }
        for (((hidden, y), side), x) in runs.iter().zip(person).zip(&noisy) {
            let by_y: [f32; WEIGHT_OUTPUTS] =
                std::array::from_fn(|o| y[o] - side.y[o] - (1.0 - OF_PERSON) * mean[o]);
            add(&mut gradient[places.offset.clone()], &by_y, 1.0);
            let direct = gradient[places.direct.clone()].chunks_exact_mut(self.inputs);
            for (row, by) in direct.zip(by_y) {
                add(row, x, by);
            }
            for (k, value) in hidden.iter().enumerate().filter(|(_, v)| **v > 0.0) {
                let at = places.expand.start + k * WEIGHT_OUTPUTS;
                let row = &self.parameters[at..at + WEIGHT_OUTPUTS];
                let by_hidden = dot(row, &by_y);
                add(&mut gradient[at..at + WEIGHT_OUTPUTS], &by_y, *value);
                gradient[places.bias.start + k] += by_hidden;
                let at = places.weights.start + k * self.inputs;
                add(&mut gradient[at..at + self.inputs], x, by_hidden);
            }
        }
    }

    /// Correlation and error by weight on these rows, the person's mean error taken off.
    pub fn figures(&self, rows: &[Row], trained_on: usize) -> Figures {
        let mut pairs: Vec<Vec<[f32; 2]>> = vec![vec![]; SEEN];
        for person in rows.chunk_by(|a, b| a.person == b.person) {
            let mut of_person: Vec<Vec<[f32; 2]>> = vec![vec![]; SEEN];
            for row in person {
                let mut found = [0.0; SEEN];
                let mut truth = [0.0; SEEN];
                let [right, left] =
                    [0, 1].map(|k| self.forward(&self.normalised(&row.inputs[k])).1);
                for (left, y) in [(false, right), (true, left)] {
                    let side = usize::from(left);
                    for ((at, y), t) in places(left).into_iter().zip(y).zip(row.targets[side]) {
                        let is_middle = places(!left).contains(&at);
                        found[at] += if is_middle { 0.5 * y } else { y };
                        truth[at] = t;
                    }
                }
                (0..SEEN).for_each(|k| of_person[k].push([found[k], truth[k]]));
            }
            for (to, from) in pairs.iter_mut().zip(of_person) {
                let n = from.len() as f32;
                let off = from.iter().map(|[f, t]| f - t).sum::<f32>() / n;
                to.extend(from.iter().map(|[f, t]| [f - off, *t]));
            }
        }
        let figure = |k: usize| {
            let (correlation, error) = agreement(&pairs[k]);
            (NAMES[k].to_owned(), correlation, error)
        };
        Figures {
            weights: (0..SEEN).map(figure).collect(),
            pictures: rows.len(),
            trained_on,
        }
    }

    /// Writes it, quantised.
    pub fn write(&self, out: &mut SectionWriter) {
        let places = Places::new(self.inputs, self.hidden);
        let p = &self.parameters;
        let (weights, weight_scale) = quantised(&p[places.weights], self.inputs);
        let (direct, direct_scale) = quantised(&p[places.direct], self.inputs);
        out.scalar(self.hidden as u32)
            .array(&self.mean)
            .array(&self.scale)
            .array(&weights)
            .array(&weight_scale)
            .array(&p[places.bias])
            .array(&p[places.expand])
            .array(&direct)
            .array(&direct_scale)
            .array(&p[places.offset]);
    }
}

/// Rows of numbers as `i8`, and what a 1 of each row is worth.
fn quantised(numbers: &[f32], columns: usize) -> (Vec<i8>, Vec<f32>) {
    let (mut all, mut scales) = (vec![], vec![]);
    for row in numbers.chunks_exact(columns) {
        let largest = row.iter().fold(1e-9f32, |m, v| m.max(v.abs()));
        let scale = largest / 127.0;
        all.extend(row.iter().map(|v| (v / scale).round() as i8));
        scales.push(scale);
    }
    (all, scales)
}

/// Correlation and r.m.s. difference.
fn agreement(pairs: &[[f32; 2]]) -> (f32, f32) {
    let n = pairs.len().max(1) as f32;
    let mean = [0, 1].map(|k| pairs.iter().map(|p| p[k]).sum::<f32>() / n);
    let product = |a: usize, b: usize| {
        let of = |p: &[f32; 2]| (p[a] - mean[a]) * (p[b] - mean[b]);
        pairs.iter().map(of).sum::<f32>() / n
    };
    let deviations = (product(0, 0) * product(1, 1)).sqrt().max(1e-9);
    let square = pairs.iter().map(|[f, t]| (f - t) * (f - t)).sum::<f32>() / n;
    (product(0, 1) / deviations, square.sqrt())
}

/// Means and inverse deviations of all inputs, of both sides.
fn spread(rows: &[Row], inputs: usize) -> (Vec<f32>, Vec<f32>) {
    let all = || rows.iter().flat_map(|row| &row.inputs);
    let n = all().count().max(1) as f32;
    (0..inputs)
        .map(|k| {
            let mean = all().map(|x| x[k]).sum::<f32>() / n;
            let square = all().map(|x| (x[k] - mean) * (x[k] - mean)).sum::<f32>() / n;
            (mean, 1.0 / square.sqrt().max(1e-3))
        })
        .unzip()
}

/// Trains on these rows; prints what it reaches on the others.
pub fn train(rows: &[Row], tests: &[Row], inputs: usize, options: &Options) -> Trained {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed ^ 0x11e7);
    let (mean, scale) = spread(rows, inputs);
    let places = Places::new(inputs, options.hidden);
    let mut network = Trained {
        inputs,
        hidden: options.hidden,
        mean,
        scale,
        parameters: vec![0.0; places.offset.end],
    };
    let reach = (1.0 / inputs as f32).sqrt();
    for (kind, reach) in [(places.weights, reach), (places.expand, 0.1)] {
        let numbers = network.parameters[kind].iter_mut();
        numbers.for_each(|v| *v = rng.random_range(-reach..reach));
    }
    let mut persons: Vec<Person> = rows
        .chunk_by(|a, b| a.person == b.person)
        .flat_map(|rows| {
            [0, 1].map(|side| {
                let of = |row: &Row| Side {
                    x: network.normalised(&row.inputs[side]),
                    y: row.targets[side],
                };
                rows.iter().map(of).collect()
            })
        })
        .collect();
    let batches = persons.len().div_ceil(BATCH);
    let steps = (options.rounds * batches) as f32;
    let (mut first, mut second) = (
        vec![0.0; network.parameters.len()],
        vec![0.0; network.parameters.len()],
    );
    let mut step = 0;
    for round in 0..options.rounds {
        persons.shuffle(&mut rng);
        for batch in persons.chunks(BATCH) {
            let seeds: Vec<u64> = batch.iter().map(|_| rng.random()).collect();
            let gradients: Vec<Vec<f32>> = batch
                .par_iter()
                .zip(seeds)
                .map(|(person, seed)| {
                    let mut gradient = vec![0.0; network.parameters.len()];
                    let mut noise = ChaCha8Rng::seed_from_u64(seed);
                    network.backward(person, &mut noise, &mut gradient);
                    gradient
                })
                .collect();
            let pictures: usize = batch.iter().map(Vec::len).sum();
            let mut gradient = vec![0.0; network.parameters.len()];
            for one in &gradients {
                add(&mut gradient, one, 1.0 / pictures as f32);
            }
            step += 1;
            let done = step as f32 / steps;
            let rate = RATE * 0.5 * (1.0 + (std::f32::consts::PI * done).cos());
            let (c1, c2) = (1.0 - 0.9f32.powi(step), 1.0 - 0.999f32.powi(step));
            let moments = first.iter_mut().zip(&mut second);
            let parameters = network.parameters.iter_mut().zip(&gradient);
            for ((p, g), (m, v)) in parameters.zip(moments) {
                *m = 0.9 * *m + 0.1 * g;
                *v = 0.999 * *v + 0.001 * g * g;
                *p -= rate * (*m / c1 / ((*v / c2).sqrt() + 1e-8) + DECAY * *p);
            }
        }
        if (round + 1) % 10 == 0 {
            let figures = network.figures(tests, rows.len());
            let mean = figures.weights.iter().map(|(_, r, _)| r).sum::<f32>() / SEEN as f32;
            println!("weights: round {}, mean correlation {mean:.3}", round + 1);
        }
    }
    network
}
