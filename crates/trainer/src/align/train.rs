//! Stochastic gradient descent (AdamW, Loshchilov and Hutter 2019) on crops that are never twice
//! the same.
//!
//! The same seed gives the same network on one kind of processor: a batch is split into a fixed
//! number of parts whose gradients are added in order.

use super::cover::covered;
use super::graph::{Maps, Scratch};
use super::network::{Network, Points, Sizes};
use super::samples::{Augment, Sample, Start, cut_at, sample, standardise};
use super::starts::normal;
use crate::faces::Face;
use anyhow::{Context, Result, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use posewise::align::{Shape, place};
use posewise::shape::LANDMARKS;
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
    /// Share of faces with something before them.
    pub covered: f32,
    /// How much more often a photograph of a face in profile is drawn than one from the front.
    pub turned: f32,
    /// How much more often a render of a face from the front is drawn than one in profile.
    pub front: f32,
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
            passes: 2,
            sizes: Sizes::default(),
            start: Start::default(),
            augment: Augment::default(),
            steps: 30_000,
            batch: 64,
            rendered: 0.4,
            covered: 0.0,
            turned: 3.0,
            front: 0.0,
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

impl Options {
    /// As these, for a network that has been trained with them and goes on with better labels.
    pub fn second(self) -> Options {
        Options {
            rate: 0.5 * self.rate,
            covered: 0.25,
            steps: self.steps * 4 / 5,
            gaps: Gaps {
                from: 0.3,
                ..self.gaps
            },
            ..self
        }
    }

    /// As these, for the global stage's second network: other numbers, better labels at once,
    /// turned heads more often.
    pub fn second_network(self) -> Options {
        Options {
            seed: self.seed ^ 0x2ed,
            covered: 0.25,
            turned: 2.0 * self.turned,
            steps: self.steps * 4 / 3,
            gaps: Gaps {
                from: 0.5,
                ..self.gaps
            },
            ..self
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
pub(super) const LIDS: [[usize; 2]; 4] = [[37, 41], [38, 40], [43, 47], [44, 46]];
const LIPS: [[usize; 2]; 3] = [[61, 67], [62, 66], [63, 65]];

impl Gaps {
    /// Pairs of landmarks, and what their gap weighs.
    pub fn pairs(&self) -> impl Iterator<Item = ([usize; 2], f32)> {
        let lids = LIDS.map(|pair| (pair, self.lids));
        lids.into_iter().chain(LIPS.map(|pair| (pair, self.lips)))
    }
}

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

/// Where samples come from.
pub trait Source: Sync {
    /// A sample.
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample;

    /// Pairs of points whose gap counts by itself, and what it weighs.
    fn gaps(&self, gaps: &Gaps) -> Vec<([usize; 2], f32)>;

    /// What the first answer begins with.
    fn offset(&self) -> Points;

    /// Some as the network meets them in training.
    fn samples(&self, count: usize, rng: &mut ChaCha8Rng) -> Vec<Sample> {
        (0..count).map(|_| self.draw(rng)).collect()
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
    println!("checkpoints in {}", checkpoint.display());
    let of_heads: usize = network.heads.iter().map(|h| h.inputs * h.modes).sum();
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
        None => {
            let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
            let samples = source.samples(64, &mut rng);
            let examples: Vec<_> = samples.into_iter().map(|s| s.crop).collect();
            State {
                step: 0,
                parameters: match initial {
                    Some(parameters) if parameters.len() == network.parameters => parameters,
                    _ => network.initial(&source.offset(), &examples, &mut rng),
                },
                first: vec![0.0; network.parameters],
                second: vec![0.0; network.parameters],
            }
        }
    };
    let gap_pairs = source.gaps(&options.gaps);
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
                let sample = source.draw(&mut rng);
                let late = step as f32 >= options.gaps.from * options.steps as f32;
                let gaps = if late { &gap_pairs[..] } else { &[] };
                learn(&network, &state.parameters, &sample, gaps, part, &mut rng);
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

/// Adds one sample's gradient.
fn learn(
    network: &Network,
    parameters: &[f32],
    sample: &Sample,
    gaps: &[([usize; 2], f32)],
    part: &mut Part,
    rng: &mut ChaCha8Rng,
) {
    part.maps[0].copy_from_slice(&sample.crop);
    let shake = || [0, 0].map(|_| normal(rng) * 0.5);
    let (maps, scratch) = (&mut part.maps, &mut part.work.1);
    let answer = network.forward(parameters, maps, scratch, &sample.start, shake);
    let n = sample.truth.len() as f32;
    let slopes: Vec<Vec<f32>> = answer
        .shapes
        .iter()
        .zip(&mut part.losses)
        .map(|(shape, loss)| {
            let pairs = shape.iter().zip(&sample.truth).zip(&sample.weights);
            let mut slopes: Vec<f32> = pairs
                .flat_map(|((p, t), weight)| {
                    // The distance itself, rounded off at 0.1 px: labels have outliers.
                    let d = [p[0] - t[0], p[1] - t[1]];
                    let length = (d[0] * d[0] + d[1] * d[1] + 0.01).sqrt();
                    *loss += weight * length / n;
                    d.map(|v| weight * v / length / n)
                })
                .collect();
            // Landmarks alone leave closing lids and opening lips half way: most faces show
            // neither, and half a gap costs two points little.
            for ([a, b], share) in gaps {
                let weight = share * sample.weights[*a].min(sample.weights[*b]);
                let off = |k: usize| {
                    (shape[*a][k] - shape[*b][k]) - (sample.truth[*a][k] - sample.truth[*b][k])
                };
                let d = [off(0), off(1)];
                let length = (d[0] * d[0] + d[1] * d[1] + 0.01).sqrt();
                for k in 0..2 {
                    let slope = weight * d[k] / length / n;
                    slopes[2 * a + k] += slope;
                    slopes[2 * b + k] -= slope;
                }
            }
            slopes
        })
        .collect();
    part.weight += sample.weights.iter().sum::<f32>() / n;
    network.backward(
        parameters,
        &part.maps,
        &answer,
        &slopes,
        &mut part.gradient,
        &mut part.work,
    );
}

/// Which face comes next.
pub struct Draw {
    photographs: Weighted,
    renders: Weighted,
    rendered: f32,
}

/// Indices that are drawn according to their weights.
struct Weighted {
    indices: Vec<usize>,
    /// Running sums of the weights.
    sums: Vec<f32>,
}

impl Weighted {
    fn new(indices: Vec<usize>, weight: impl Fn(usize) -> f32) -> Weighted {
        let mut sum = 0.0;
        let add = |k: &usize| {
            sum += weight(*k);
            sum
        };
        Weighted {
            sums: indices.iter().map(add).collect(),
            indices,
        }
    }

    fn next(&self, rng: &mut ChaCha8Rng) -> usize {
        let at = rng.random_range(0.0..*self.sums.last().expect("faces to draw from"));
        let k = self.sums.partition_point(|s| *s <= at);
        self.indices[k.min(self.indices.len() - 1)]
    }
}

impl Draw {
    /// Photographs of turned faces come more often, renders of turned ones less, and faces of
    /// interest more.
    pub fn new(faces: &[Face], options: &Options, interest: impl Fn(&Face) -> f32) -> Result<Draw> {
        ensure!(!faces.is_empty(), "no faces to train on");
        let of = |rendered: bool| {
            let chosen = |k: &usize| faces[*k].yaw_deg.is_some() == rendered;
            (0..faces.len()).filter(chosen).collect::<Vec<_>>()
        };
        Ok(Draw {
            photographs: Weighted::new(of(false), |k| {
                interest(&faces[k]) * (1.0 + options.turned * faces[k].turn().abs())
            }),
            renders: Weighted::new(of(true), |k| {
                let straight = 1.0 - faces[k].turn().abs();
                interest(&faces[k]) * (1.0 + options.front * straight * straight)
            }),
            rendered: options.rendered,
        })
    }

    /// The next face's index.
    pub fn next(&self, rng: &mut ChaCha8Rng) -> usize {
        let (photographs, renders) = (&self.photographs, &self.renders);
        match (photographs.indices.is_empty(), renders.indices.is_empty()) {
            (true, _) => renders.next(rng),
            (_, true) => photographs.next(rng),
            _ if rng.random_range(0.0..1.0) < self.rendered => renders.next(rng),
            _ => photographs.next(rng),
        }
    }
}

/// Whole faces.
pub struct Faces<'a> {
    pub faces: &'a [Face],
    pub mean: &'a Shape,
    pub options: &'a Options,
    pub draw: Draw,
}

impl Source for Faces<'_> {
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample {
        let mut face = &self.faces[self.draw.next(rng)];
        let options = self.options;
        let hidden;
        if rng.random_range(0.0..1.0) < options.covered {
            hidden = covered(face, &self.faces[self.draw.next(rng)], rng);
            face = &hidden;
        }
        let (start, augment) = (&options.start, &options.augment);
        sample(face, self.mean, &options.sizes, start, augment, rng)
    }

    fn gaps(&self, gaps: &Gaps) -> Vec<([usize; 2], f32)> {
        gaps.pairs().collect()
    }

    fn offset(&self) -> Points {
        let zoom = self.options.sizes.zoom;
        self.mean.iter().map(|p| p.map(|v| v * zoom)).collect()
    }
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

    /// One pass of a global stage in `f32`: a guess in frame px in, the landmarks out, as they are
    /// after so many of the network's answers.
    pub fn pass(&self, face: &Face, mean: &Shape, guess: &Shape, answers: usize) -> Shape {
        let sizes = &self.network.sizes;
        let Some(placed) = place(mean, guess, sizes.zoom, sizes.side) else {
            return *guess;
        };
        let mut crop = cut_at(face, &placed.centred_to_frame, sizes.side);
        standardise(&mut crop);
        let mut maps = self.network.graph.maps();
        maps[0].copy_from_slice(&crop);
        let start = vec![[0.0; 2]; LANDMARKS];
        let still = || [0.0; 2];
        let (parameters, scratch) = (&self.parameters, &mut Scratch::default());
        let answer = self
            .network
            .forward(parameters, &mut maps, scratch, &start, still);
        let points = answer.shapes[..answers].last();
        let points = points.expect("at least one answer");
        std::array::from_fn(|i| placed.centred_to_frame.apply(points[i]))
    }
}
