//! Stochastic gradient descent (AdamW, Loshchilov and Hutter 2019) on crops that are never twice
//! the same.
//!
//! The same seed gives the same network on one kind of processor: a batch is split into a fixed
//! number of parts whose gradients are added in order.

use super::adam::State;
use super::graph::{Maps, Scratch};
use super::network::{Network, Points, Sizes};
use super::options::Options;
use super::samples::{Sample, standardise};
use super::source::Source;
use super::starts::normal;
use crate::faces::Face;
use anyhow::{Result, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use posewise::align::{Shape, place};
use posewise::shape::LANDMARKS;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

/// Parts that a batch is split into.
const PARTS: usize = 8;
/// Steps between checkpoints.
const CHECKPOINT: usize = 1000;
/// Steps between messages, and the weight of a batch in the mean error that they show.
const MESSAGE: usize = 50;
const SMOOTHING: f32 = 0.005;
/// Largest norm of a batch's mean gradient; a longer one is shortened.
const MAX_NORM: f32 = 5.0;

/// A trained network.
pub struct Trained {
    /// Its form.
    pub network: Network,
    /// Its numbers.
    pub parameters: Vec<f32>,
}

/// Pairs of points whose distance counts by itself, and its weight.
type Pairs = [([usize; 2], f32)];

/// Working memory of one part of a batch.
struct Part {
    maps: Maps,
    work: (Maps, Scratch),
    gradient: Vec<f32>,
    /// Sum of losses after each head, and of weights.
    losses: Vec<f32>,
    weight: f32,
}

impl Part {
    fn new(network: &Network) -> Part {
        Part {
            maps: network.graph.maps(),
            work: (network.graph.maps(), Scratch::default()),
            gradient: vec![0.0; network.parameters],
            losses: vec![],
            weight: 0.0,
        }
    }
}

/// Trains a network; goes on from the checkpoint if there is one, else starts from the numbers
/// given, else from random ones.
pub fn train(
    source: &impl Source,
    options: &Options,
    checkpoint: &Path,
    initial: Option<Vec<f32>>,
) -> Result<Trained> {
    let network = Network::new(&options.sizes);
    let initial = initial.filter(|parameters| parameters.len() == network.parameters);
    println!("checkpoints in {}", checkpoint.display());
    let of_heads: usize = network.heads.iter().map(|h| h.inputs * h.rank).sum();
    println!(
        "network: {} parameters, {:.1} million multiply-adds",
        network.parameters,
        (network.graph.multiply_adds() + of_heads) as f32 / 1e6
    );
    let mut state = match State::read(checkpoint, network.parameters) {
        Some(state) => {
            println!("going on from step {}", state.step);
            state
        }
        None => State::new(match &initial {
            Some(parameters) => parameters.clone(),
            None => random_parameters(&network, source, options),
        }),
    };
    let pairs = source.aperture(&options.aperture);
    let mut parts: Vec<Part> = (0..PARTS).map(|_| Part::new(&network)).collect();
    let style = ProgressStyle::with_template("network {bar:30} {pos}/{len} {eta} {msg}");
    let bar = ProgressBar::new(options.steps as u64).with_style(style.expect("a valid template"));
    bar.set_position(state.step as u64);
    let mut running: Vec<f32> = vec![];
    while state.step < options.steps {
        let late = state.step as f32 >= options.aperture.from * options.steps as f32;
        let pairs = if late { &pairs[..] } else { &[] };
        run_batch(&network, &state, source, options, pairs, &mut parts);
        running = smoothed(running, &parts);
        state.descend(mean_gradient(&mut parts)?, options);
        if state.step % MESSAGE == 0 {
            bar.set_position(state.step as u64);
            bar.set_message(format!("mean error {running:.2?} px"));
        }
        if state.step % CHECKPOINT == 0 || state.step == options.steps {
            state.write(checkpoint)?;
            println!("step {}: mean error {running:.3?} px", state.step);
        }
    }
    bar.finish();
    let mut parameters = state.parameters;
    for (p, start) in parameters.iter_mut().zip(initial.iter().flatten()) {
        *p += options.share_of_start * (start - *p);
    }
    Ok(Trained {
        network,
        parameters,
    })
}

/// Random numbers, scaled by examples.
fn random_parameters(network: &Network, source: &impl Source, options: &Options) -> Vec<f32> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let samples = source.samples(64, &mut rng);
    let examples: Vec<_> = samples.into_iter().map(|s| s.crop).collect();
    network.initial(&source.offset(), &examples, &mut rng)
}

/// Adds the gradients of a batch, each part its own samples. A sample's random numbers depend on
/// its number alone.
fn run_batch(
    network: &Network,
    state: &State,
    source: &impl Source,
    options: &Options,
    pairs: &Pairs,
    parts: &mut [Part],
) {
    let each = options.batch / PARTS;
    parts.par_iter_mut().enumerate().for_each(|(index, part)| {
        part.gradient.fill(0.0);
        part.losses = vec![0.0; network.heads.len()];
        part.weight = 0.0;
        for k in 0..each {
            let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
            rng.set_stream(1 + (state.step * options.batch + index * each + k) as u64);
            let sample = source.draw_again(
                &mut |sample| predict(network, &state.parameters, sample, part),
                &mut rng,
            );
            learn(
                network,
                &state.parameters,
                &sample,
                (pairs, options),
                part,
                &mut rng,
            );
        }
    });
}

/// The points that the network finds in a sample.
fn predict(network: &Network, parameters: &[f32], sample: &Sample, part: &mut Part) -> Points {
    part.maps[0].copy_from_slice(&sample.crop);
    let (maps, scratch) = (&mut part.maps, &mut part.work.1);
    let still = || [0.0; 2];
    let mut prediction = network.forward(parameters, maps, scratch, &sample.start, still);
    prediction.shapes.pop().expect("a network has heads")
}

/// The mean loss after each head, smoothed over batches.
fn smoothed(running: Vec<f32>, parts: &[Part]) -> Vec<f32> {
    let weight: f32 = parts.iter().map(|p| p.weight).sum();
    let losses = |k: usize| parts.iter().map(|p| p.losses[k]).sum::<f32>() / weight;
    let now: Vec<f32> = (0..parts[0].losses.len()).map(losses).collect();
    match running.len() {
        0 => now,
        _ => running
            .iter()
            .zip(&now)
            .map(|(r, n)| (1.0 - SMOOTHING) * r + SMOOTHING * n)
            .collect(),
    }
}

/// The batch's mean gradient, the parts added in order, no longer than [`MAX_NORM`].
fn mean_gradient(parts: &mut [Part]) -> Result<&[f32]> {
    let weight: f32 = parts.iter().map(|p| p.weight).sum();
    let (first, rest) = parts.split_at_mut(1);
    let gradient = &mut first[0].gradient;
    for part in rest {
        gradient
            .iter_mut()
            .zip(&part.gradient)
            .for_each(|(g, p)| *g += p);
    }
    let norm = gradient
        .iter()
        .map(|g| (*g as f64).powi(2))
        .sum::<f64>()
        .sqrt() as f32;
    ensure!(norm.is_finite(), "the network's gradient is not finite");
    let by = (MAX_NORM / (norm / weight + 1e-9)).min(1.0) / weight;
    gradient.iter_mut().for_each(|g| *g *= by);
    Ok(gradient)
}

/// Adds one sample's gradient.
fn learn(
    network: &Network,
    parameters: &[f32],
    sample: &Sample,
    (pairs, options): (&Pairs, &Options),
    part: &mut Part,
    rng: &mut ChaCha8Rng,
) {
    part.maps[0].copy_from_slice(&sample.crop);
    let shake = || [0, 0].map(|_| normal(rng) * options.shake);
    let (maps, scratch) = (&mut part.maps, &mut part.work.1);
    let prediction = network.forward(parameters, maps, scratch, &sample.start, shake);
    let n = sample.truth.len() as f32;
    let slopes: Vec<Vec<f32>> = prediction
        .shapes
        .iter()
        .zip(&mut part.losses)
        .map(|(shape, loss)| slopes(shape, sample, pairs, loss))
        .collect();
    part.weight += sample.weights.iter().sum::<f32>() / n;
    network.backward(
        parameters,
        &part.maps,
        &prediction,
        &slopes,
        &mut part.gradient,
        &mut part.work,
    );
}

/// Slopes of the loss by each coordinate of a predicted shape; adds the loss.
fn slopes(shape: &[[f32; 2]], sample: &Sample, pairs: &Pairs, loss: &mut f32) -> Vec<f32> {
    let n = sample.truth.len() as f32;
    let points = shape.iter().zip(&sample.truth).zip(&sample.weights);
    let mut slopes: Vec<f32> = points
        .flat_map(|((p, t), weight)| {
            // The distance itself, rounded off at 0.1 px: labels have outliers.
            let d = [p[0] - t[0], p[1] - t[1]];
            let length = (d[0] * d[0] + d[1] * d[1] + 0.01).sqrt();
            *loss += weight * length / n;
            d.map(|v| weight * v / length / n)
        })
        .collect();
    // Landmarks alone leave closing lids and opening lips half way: most faces show neither, and
    // half an aperture costs two points little.
    for ([a, b], share) in pairs {
        let weight = share * sample.weights[*a].min(sample.weights[*b]);
        let off =
            |k: usize| (shape[*a][k] - shape[*b][k]) - (sample.truth[*a][k] - sample.truth[*b][k]);
        let d = [off(0), off(1)];
        let length = (d[0] * d[0] + d[1] * d[1] + 0.01).sqrt();
        for k in 0..2 {
            let slope = weight * d[k] / length / n;
            slopes[2 * a + k] += slope;
            slopes[2 * b + k] -= slope;
        }
    }
    slopes
}

impl Trained {
    /// The network of a finished run.
    pub fn read(checkpoint: &Path, sizes: &Sizes) -> Option<Trained> {
        let network = Network::new(sizes);
        let parameters = State::read(checkpoint, network.parameters)?.parameters;
        Some(Trained {
            network,
            parameters,
        })
    }

    /// One iteration of a global stage in `f32`: an initial shape in frame px in, the landmarks
    /// out, as they are after this number of the network's predictions.
    pub fn iterate(
        &self,
        face: &Face,
        mean: &Shape,
        initial_shape: &Shape,
        predictions: usize,
    ) -> Shape {
        let sizes = &self.network.sizes;
        let Some(placed) = place(mean, initial_shape, sizes.zoom, sizes.side) else {
            return *initial_shape;
        };
        let mut crop = face
            .picture
            .crop(&placed.centred_to_frame, sizes.side, false);
        standardise(&mut crop);
        let mut maps = self.network.graph.maps();
        maps[0].copy_from_slice(&crop);
        let start = vec![[0.0; 2]; LANDMARKS];
        let still = || [0.0; 2];
        let (parameters, scratch) = (&self.parameters, &mut Scratch::default());
        let prediction = self
            .network
            .forward(parameters, &mut maps, scratch, &start, still);
        let points = prediction.shapes[..predictions].last();
        let points = points.expect("at least one prediction");
        std::array::from_fn(|i| placed.centred_to_frame.apply(points[i]))
    }
}
