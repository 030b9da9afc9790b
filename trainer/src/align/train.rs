//! Stochastic gradient descent (AdamW, Loshchilov and Hutter 2019) on crops that are never twice
//! the same.
//!
//! The same seed gives the same network on one kind of processor: a batch is split into a fixed
//! number of parts whose gradients are added in order.

use super::graph::{Maps, Scratch};
use super::network::{Network, Sizes};
use super::samples::{Augment, Sample, Start, cut_at, sample, standardise};
use super::starts::normal;
use crate::faces::Face;
use anyhow::{Context, Result, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use posewise::align::Shape;
use posewise::math::Similarity;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

/// How the network is trained.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of all randomness.
    pub seed: u64,
    /// Turns of the start shapes, rising from 0.
    pub turns: Vec<f32>,
    /// Passes after a detection.
    pub passes: usize,
    /// How large the network is.
    pub sizes: Sizes,
    /// Where crops are cut.
    pub start: Start,
    /// How they are disturbed.
    pub augment: Augment,
    /// Batches.
    pub steps: usize,
    /// Samples of a batch.
    pub batch: usize,
    /// Share of renders among them.
    pub rendered: f32,
    /// How much more often a photograph of a face in profile is drawn than one from the front.
    pub turned: f32,
    /// Largest rate; it rises over `warm_up` steps, then falls as a cosine.
    pub rate: f32,
    /// Steps until then.
    pub warm_up: usize,
    /// Weight decay.
    pub decay: f32,
    /// Weights of the gaps between the lids and between the lips, and the share of the steps after
    /// which they count.
    pub gaps: Gaps,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            seed: 1,
            turns: vec![0.0, 0.4, 0.8],
            passes: 3,
            sizes: Sizes::default(),
            start: Start::default(),
            augment: Augment::default(),
            steps: 30_000,
            batch: 64,
            rendered: 0.4,
            turned: 3.0,
            rate: 2e-3,
            warm_up: 300,
            decay: 0.02,
            gaps: Gaps {
                lids: 6.0,
                lips: 2.0,
                from: 0.65,
            },
        }
    }
}

/// What a gap's error weighs beside a landmark's.
#[derive(Clone, Copy, Debug)]
pub struct Gaps {
    pub lids: f32,
    pub lips: f32,
    pub from: f32,
}

/// Upper and lower lids, upper and lower inner lips.
const LIDS: [[usize; 2]; 4] = [[37, 41], [38, 40], [43, 47], [44, 46]];
const LIPS: [[usize; 2]; 3] = [[61, 67], [62, 66], [63, 65]];

/// A trained network.
pub struct Trained {
    /// Its form.
    pub network: Network,
    /// Its numbers.
    pub parameters: Vec<f32>,
}

/// Parts that a batch is split into.
const PARTS: usize = 8;
/// Steps between checkpoints.
const CHECKPOINT: usize = 1000;

/// What a run goes on from.
struct State {
    step: usize,
    parameters: Vec<f32>,
    /// Adam's means of gradients and of their squares.
    first: Vec<f32>,
    second: Vec<f32>,
}

impl State {
    fn read(path: &Path, parameters: usize) -> Option<State> {
        let bytes = std::fs::read(path).ok()?;
        let (step, rest) = bytes.split_first_chunk::<8>()?;
        let floats: Vec<f32> = rest
            .as_chunks::<4>()
            .0
            .iter()
            .map(|b| f32::from_le_bytes(*b))
            .collect();
        if floats.len() != 3 * parameters {
            return None;
        }
        let mut parts = floats.chunks_exact(parameters).map(<[f32]>::to_vec);
        Some(State {
            step: u64::from_le_bytes(*step) as usize,
            parameters: parts.next()?,
            first: parts.next()?,
            second: parts.next()?,
        })
    }

    fn write(&self, path: &Path) -> Result<()> {
        let mut bytes = (self.step as u64).to_le_bytes().to_vec();
        for part in [&self.parameters, &self.first, &self.second] {
            part.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        }
        let fresh = path.with_extension("part");
        std::fs::write(&fresh, bytes).with_context(|| format!("writing {}", fresh.display()))?;
        std::fs::rename(&fresh, path).with_context(|| format!("writing {}", path.display()))
    }

    /// One step of AdamW down the gradient.
    fn descend(&mut self, gradient: &[f32], options: &Options) {
        let (b1, b2) = (0.9f32, 0.999f32);
        self.step += 1;
        let done = self.step as f32 / options.steps as f32;
        let rise = (self.step as f32 / options.warm_up as f32).min(1.0);
        let rate = options.rate * rise * 0.5 * (1.0 + (std::f32::consts::PI * done).cos());
        let (c1, c2) = (
            1.0 - b1.powi(self.step as i32),
            1.0 - b2.powi(self.step as i32),
        );
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((p, g), (m, v)) in self.parameters.iter_mut().zip(gradient).zip(moments) {
            *m = b1 * *m + (1.0 - b1) * g;
            *v = b2 * *v + (1.0 - b2) * g * g;
            *p -= rate * (*m / c1 / ((*v / c2).sqrt() + 1e-8) + options.decay * *p);
        }
    }
}

/// Working memory of one part of a batch.
struct Part {
    maps: Maps,
    work: (Maps, Scratch),
    gradient: Vec<f32>,
    /// Sum of losses after each head, and of weights.
    losses: Vec<f32>,
    weight: f32,
}

/// Trains on these faces (mirrors are made here); goes on from the checkpoint if there is one.
pub fn train(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    checkpoint: &Path,
) -> Result<Trained> {
    let network = Network::new(&options.sizes);
    println!("checkpoints in {}", checkpoint.display());
    println!(
        "network: {} parameters, {:.1} million multiply-adds",
        network.parameters,
        (network.graph.multiply_adds()
            + network
                .heads
                .iter()
                .map(|h| h.inputs * h.modes)
                .sum::<usize>()) as f32
            / 1e6
    );
    let draw = Draw::new(faces, options)?;
    let mut state = match State::read(checkpoint, network.parameters) {
        Some(state) => {
            println!("going on from step {}", state.step);
            state
        }
        None => {
            let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
            let examples = draw.crops(faces, mean, options, 64, &mut rng);
            State {
                step: 0,
                parameters: network.initial(mean, &examples, &mut rng),
                first: vec![0.0; network.parameters],
                second: vec![0.0; network.parameters],
            }
        }
    };
    let mut parts: Vec<Part> = (0..PARTS)
        .map(|_| Part {
            maps: network.graph.maps(),
            work: (network.graph.maps(), Scratch::default()),
            gradient: vec![0.0; network.parameters],
            losses: vec![],
            weight: 0.0,
        })
        .collect();
    let style = ProgressStyle::with_template("network {bar:30} {pos}/{len} {eta} {msg}");
    let bar = ProgressBar::new(options.steps as u64).with_style(style.expect("a valid template"));
    bar.set_position(state.step as u64);
    let mut running: Vec<f32> = vec![];
    while state.step < options.steps {
        let step = state.step;
        parts.par_iter_mut().enumerate().for_each(|(index, part)| {
            part.gradient.fill(0.0);
            part.losses = vec![0.0; network.heads.len()];
            part.weight = 0.0;
            for k in 0..options.batch / PARTS {
                let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
                rng.set_stream(
                    1 + (step * options.batch + index * (options.batch / PARTS) + k) as u64,
                );
                let (weight, sample) = draw.sample(faces, mean, options, &mut rng);
                let gaps = (step as f32 >= options.gaps.from * options.steps as f32)
                    .then_some(&options.gaps);
                learn(
                    &network,
                    &state.parameters,
                    &sample,
                    weight,
                    gaps,
                    part,
                    &mut rng,
                );
            }
        });
        let weight: f32 = parts.iter().map(|p| p.weight).sum();
        let losses = |k: usize| parts.iter().map(|p| p.losses[k]).sum::<f32>() / weight;
        let now: Vec<f32> = (0..network.heads.len()).map(losses).collect();
        running = match running.len() {
            0 => now,
            _ => running
                .iter()
                .zip(&now)
                .map(|(r, n)| 0.995 * r + 0.005 * n)
                .collect(),
        };
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
        let by = (5.0 / (norm / weight + 1e-9)).min(1.0) / weight;
        gradient.iter_mut().for_each(|g| *g *= by);
        state.descend(gradient, options);
        if state.step % 50 == 0 {
            bar.set_position(state.step as u64);
            bar.set_message(format!("mean error {running:.2?} px"));
        }
        if state.step % CHECKPOINT == 0 || state.step == options.steps {
            state.write(checkpoint)?;
            println!("step {}: mean error {running:.3?} px", state.step);
        }
    }
    bar.finish();
    Ok(Trained {
        network,
        parameters: state.parameters,
    })
}

/// Standardised crops as the network meets them in training.
pub fn examples(
    faces: &[Face],
    mean: &Shape,
    options: &Options,
    count: usize,
) -> Result<Vec<Vec<f32>>> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed ^ 2);
    Ok(Draw::new(faces, options)?.crops(faces, mean, options, count, &mut rng))
}

/// Which face comes next.
struct Draw {
    photographs: Vec<usize>,
    /// Running sums of the photographs' shares.
    sums: Vec<f32>,
    renders: Vec<usize>,
}

impl Draw {
    fn new(faces: &[Face], options: &Options) -> Result<Draw> {
        let of = |rendered: bool| {
            let chosen = |k: &usize| faces[*k].yaw_deg.is_some() == rendered;
            (0..faces.len()).filter(chosen).collect::<Vec<_>>()
        };
        let (photographs, renders) = (of(false), of(true));
        ensure!(!faces.is_empty(), "no faces to train on");
        let mut sum = 0.0;
        let sums = photographs
            .iter()
            .map(|k| {
                sum += 1.0 + options.turned * faces[*k].turn().abs();
                sum
            })
            .collect();
        Ok(Draw {
            photographs,
            sums,
            renders,
        })
    }

    fn crops(
        &self,
        faces: &[Face],
        mean: &Shape,
        options: &Options,
        count: usize,
        rng: &mut ChaCha8Rng,
    ) -> Vec<Vec<f32>> {
        let one = |_| self.sample(faces, mean, options, rng).1.crop;
        (0..count).map(one).collect()
    }

    /// A weight and a sample.
    fn sample(
        &self,
        faces: &[Face],
        mean: &Shape,
        options: &Options,
        rng: &mut ChaCha8Rng,
    ) -> (f32, Sample) {
        let rendered = match (self.photographs.is_empty(), self.renders.is_empty()) {
            (true, _) => true,
            (_, true) => false,
            _ => rng.random_range(0.0..1.0) < options.rendered,
        };
        let face = if rendered {
            self.renders[rng.random_range(0..self.renders.len())]
        } else {
            let at = rng.random_range(0.0..*self.sums.last().expect("photographs"));
            let k = self.sums.partition_point(|s| *s <= at);
            self.photographs[k.min(self.photographs.len() - 1)]
        };
        let face = &faces[face];
        let sample = sample(
            face,
            mean,
            &options.sizes,
            &options.start,
            &options.augment,
            rng,
        );
        (face.weight, sample)
    }
}

/// Adds one sample's gradient.
fn learn(
    network: &Network,
    parameters: &[f32],
    sample: &Sample,
    weight: f32,
    gaps: Option<&Gaps>,
    part: &mut Part,
    rng: &mut ChaCha8Rng,
) {
    part.maps[0].copy_from_slice(&sample.crop);
    let shake = || [0, 0].map(|_| normal(rng) * 0.5);
    let answer = network.forward(parameters, &mut part.maps, &mut part.work.1, shake);
    let n = sample.truth.len() as f32;
    let slopes: Vec<Vec<f32>> = answer
        .shapes
        .iter()
        .zip(&mut part.losses)
        .map(|(shape, loss)| {
            let pairs = shape.iter().zip(&sample.truth);
            let mut slopes: Vec<f32> = pairs
                .flat_map(|(p, t)| {
                    // The distance itself, rounded off at 0.1 px: labels have outliers.
                    let d = [p[0] - t[0], p[1] - t[1]];
                    let length = (d[0] * d[0] + d[1] * d[1] + 0.01).sqrt();
                    *loss += weight * length / n;
                    d.map(|v| weight * v / length / n)
                })
                .collect();
            // Landmarks alone leave closing lids and opening lips half way: most faces show
            // neither, and half a gap costs two points little.
            for (gaps, pairs) in gaps
                .iter()
                .flat_map(|g| [(g.lids, &LIDS[..]), (g.lips, &LIPS)])
            {
                for [a, b] in pairs {
                    let off = |k: usize| {
                        (shape[*a][k] - shape[*b][k]) - (sample.truth[*a][k] - sample.truth[*b][k])
                    };
                    let d = [off(0), off(1)];
                    let length = (d[0] * d[0] + d[1] * d[1] + 0.01).sqrt();
                    for k in 0..2 {
                        let slope = weight * gaps * d[k] / length / n;
                        slopes[2 * a + k] += slope;
                        slopes[2 * b + k] -= slope;
                    }
                }
            }
            slopes
        })
        .collect();
    part.weight += weight;
    network.backward(
        parameters,
        &part.maps,
        &answer,
        &slopes,
        &mut part.gradient,
        &mut part.work,
    );
}

impl Trained {
    /// One pass in `f32`: a guess in frame px in, the shape after each head out.
    pub fn run(&self, face: &Face, mean: &Shape, guess: &Shape) -> Vec<Shape> {
        let sizes = &self.network.sizes;
        let canonical = Similarity::fit(mean, guess).expect("a guess has extent");
        let to_canonical = Similarity {
            a: 1.0 / sizes.zoom,
            ..Similarity::IDENTITY
        };
        let to_frame = to_canonical.then(&canonical);
        let mut crop = cut_at(face, &to_frame, sizes.side);
        standardise(&mut crop);
        let mut maps = self.network.graph.maps();
        maps[0].copy_from_slice(&crop);
        let answer =
            self.network
                .forward(&self.parameters, &mut maps, &mut Scratch::default(), || {
                    [0.0; 2]
                });
        let shapes = answer.shapes.into_iter();
        shapes
            .map(|shape| shape.map(|p| to_frame.apply(p)))
            .collect()
    }
}
