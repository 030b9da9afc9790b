//! Trains the tile network on random tiles that are never twice the same; a run goes on from its
//! checkpoint.
//!
//! The same seed gives the same network on one kind of processor: a batch is split into a fixed
//! number of parts whose gradients are added in order.

use super::loss::Losses;
use super::maker::draw;
use super::network::{Network, Work};
use super::normalise;
use super::options::{Options, rng_for};
use super::pictures::Pictures;
use super::state::State;
use super::tile::{Tile, standardise};
use anyhow::{Result, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use rand::Rng;
use rayon::prelude::*;
use std::path::Path;

/// Parts that a batch is split into; each is normalised by itself.
const PARTS: usize = 4;
/// Parts over which the moments of the averaged parameters are measured at the end.
const SETTLING: usize = 40;
/// Steps between checkpoints, and between messages.
const CHECKPOINT: usize = 250;
const MESSAGE: usize = 50;
/// Largest norm of a batch's mean gradient; a longer one is shortened.
const MAX_NORM: f32 = 5.0;
/// Share of tiles that are repeated because the network found a face where there is none, and how
/// many of them are kept.
const REPEATED: f64 = 0.2;
const REPEATED_KEPT: usize = 4096;
/// Purposes of random numbers.
const INITIAL: u64 = 0x494E_4954;
const TILES: u64 = 0x5449_4C45;
const REPEATS: u64 = 0x5245_5045;

/// Working memory of one part of a batch.
struct Part {
    works: Vec<Work>,
    gradient: Vec<f32>,
    losses: Losses,
    /// Numbers of tiles to repeat.
    repeat: Vec<u64>,
}

/// The tile of a number.
pub fn numbered(pictures: &Pictures, options: &Options, number: u64) -> Tile {
    draw(pictures, &mut rng_for(options.seed, TILES, number))
}

/// Trains a network and returns its parameters, without normalisation. A new run starts from the
/// parameters `before` of a network without normalisation, if there are some.
pub fn train(
    network: &Network,
    pictures: &Pictures,
    checkpoint: &Path,
    options: &Options,
    before: Option<Vec<f32>>,
) -> Result<Vec<f32>> {
    println!(
        "{} parameters, {:.2} million multiply-adds; checkpoints in {}",
        network.parameters,
        network.multiply_adds() as f32 / 1e6,
        checkpoint.display()
    );
    let all = *normalise::places(network).last().expect("places");
    let mut parts: Vec<Part> = (0..PARTS)
        .map(|_| Part::new(network, all, options))
        .collect();
    let mut state = State::read(checkpoint, all).unwrap_or_else(|| {
        State::new(match before {
            Some(before) => normalised(network, pictures, before, &mut parts[0].works, options),
            None => {
                let mut parameters = network.initial(&mut rng_for(options.seed, INITIAL, 0));
                parameters.resize(all, 1.0);
                parameters
            }
        })
    });
    let style = ProgressStyle::with_template("detector {bar:30} {pos}/{len} {eta} {msg}");
    let bar = ProgressBar::new(options.steps as u64).with_style(style.expect("a valid template"));
    let mut repeated: Vec<u64> = vec![];
    let mut sum = Losses::default();
    while state.step < options.steps {
        let numbers = numbers(&state, &repeated, options);
        run_batch(network, &state, pictures, options, &numbers, &mut parts);
        keep_repeated(&mut repeated, &parts, &state, options);
        let now = parts
            .iter()
            .fold(Losses::default(), |sum, p| sum.plus(&p.losses));
        state.descend(&mean_gradient(&mut parts, &now)?, options);
        sum = sum.plus(&now);
        if state.step.is_multiple_of(MESSAGE) {
            bar.set_position(state.step as u64);
            bar.set_message(message(&sum, options));
        }
        if state.step.is_multiple_of(CHECKPOINT) || state.step == options.steps {
            state.write(checkpoint)?;
            println!("step {}: {}", state.step, message(&sum, options));
        }
        if state.step.is_multiple_of(MESSAGE) {
            sum = Losses::default();
        }
    }
    bar.finish();
    Ok(settled(
        network,
        pictures,
        &state.average,
        &mut parts[0].works,
        options,
    ))
}

impl Part {
    fn new(network: &Network, parameters: usize, options: &Options) -> Part {
        Part {
            works: (0..options.batch / PARTS).map(|_| network.work()).collect(),
            gradient: vec![0.0; parameters],
            losses: Losses::default(),
            repeat: vec![],
        }
    }
}

/// Numbers of a batch's tiles: new ones, and some that are repeated.
fn numbers(state: &State, repeated: &[u64], options: &Options) -> Vec<u64> {
    let mut rng = rng_for(options.seed, REPEATS, 2 * state.step as u64);
    let number = |k: u64| match !repeated.is_empty() && rng.random_bool(REPEATED) {
        true => repeated[rng.random_range(0..repeated.len())],
        false => (state.step * options.batch) as u64 + k,
    };
    (0..options.batch as u64).map(number).collect()
}

/// Computes each part's gradient and losses.
fn run_batch(
    network: &Network,
    state: &State,
    pictures: &Pictures,
    options: &Options,
    numbers: &[u64],
    parts: &mut [Part],
) {
    let each = options.batch / PARTS;
    let batches = parts.par_iter_mut().zip(numbers.par_chunks(each));
    batches.for_each(|(part, numbers)| {
        part.gradient.fill(0.0);
        part.losses = Losses::default();
        part.repeat.clear();
        let tiles = numbers.iter().map(|n| numbered(pictures, options, *n));
        let tiles: Vec<Tile> = tiles.collect();
        for (work, tile) in part.works.iter_mut().zip(&tiles) {
            standardise(&tile.luma, &mut work.maps[0]);
        }
        let moments = normalise::forward(network, &state.parameters, &mut part.works);
        for ((work, tile), number) in part.works.iter_mut().zip(&tiles).zip(numbers) {
            let (out, by_out) = (work.maps.last(), work.by_maps.last_mut());
            let (out, by_out) = out.zip(by_out).expect("maps");
            if part.losses.add(&tile.cells, out, by_out) {
                part.repeat.push(*number);
            }
        }
        let (works, gradient) = (&mut part.works, &mut part.gradient);
        normalise::backward(network, &state.parameters, works, &moments, gradient);
    });
}

/// Keeps the numbers of tiles with false positives, in place of random others when there are many.
fn keep_repeated(repeated: &mut Vec<u64>, parts: &[Part], state: &State, options: &Options) {
    let mut rng = rng_for(options.seed, REPEATS, 2 * state.step as u64 + 1);
    for number in parts.iter().flat_map(|p| &p.repeat) {
        if repeated.len() < REPEATED_KEPT {
            repeated.push(*number);
        } else {
            repeated[rng.random_range(0..REPEATED_KEPT)] = *number;
        }
    }
}

/// The batch's mean gradient per face, the parts added in order, no longer than [`MAX_NORM`].
fn mean_gradient(parts: &mut [Part], losses: &Losses) -> Result<Vec<f32>> {
    let scale = 1.0 / (losses.faces + 2.0);
    let mut gradient = vec![0.0f32; parts[0].gradient.len()];
    for part in parts {
        let both = gradient.iter_mut().zip(&part.gradient);
        both.for_each(|(g, p)| *g += scale * p);
    }
    let squares: f64 = gradient.iter().map(|g| f64::from(*g).powi(2)).sum();
    let norm = squares.sqrt() as f32;
    ensure!(norm.is_finite(), "the detector's gradient is not finite");
    let by = (MAX_NORM / (norm + 1e-9)).min(1.0);
    gradient.iter_mut().for_each(|g| *g *= by);
    Ok(gradient)
}

fn message(sum: &Losses, options: &Options) -> String {
    let faces = sum.faces.max(1.0);
    format!(
        "positive {:.3} negative {:.3} boxes {:.3} found {:.3} false {:.3}",
        sum.positive / faces,
        sum.negative / faces,
        sum.boxes / faces,
        sum.found / faces,
        sum.false_tiles / (MESSAGE * options.batch) as f32
    )
}

/// Parameters with normalisation that compute what these compute without it, on some tiles: layer
/// by layer, its factors and biases undo the moments of its sums.
fn normalised(
    network: &Network,
    pictures: &Pictures,
    mut parameters: Vec<f32>,
    works: &mut [Work],
    options: &Options,
) -> Vec<f32> {
    let places = normalise::places(network);
    parameters.resize(*places.last().expect("places"), 1.0);
    for (k, work) in works.iter_mut().enumerate() {
        let number = u64::MAX - 1_000_000 - k as u64;
        let tile = numbered(pictures, options, number);
        standardise(&tile.luma, &mut work.maps[0]);
    }
    let tiles: Vec<Vec<f32>> = works.iter().map(|w| w.maps[0].clone()).collect();
    for (k, layer) in network.layers.iter().enumerate() {
        if !layer.has_relu() {
            continue;
        }
        for (work, tile) in works.iter_mut().zip(&tiles) {
            work.maps[0].copy_from_slice(tile);
        }
        let moments = normalise::forward(network, &parameters, works);
        let [mean, inverse] = &moments[k];
        for (c, (mean, inverse)) in mean.iter().zip(inverse).enumerate() {
            parameters[places[k] + c] = 1.0 / inverse;
            layer.parameters_mut(&mut parameters).1[c] += mean;
        }
    }
    parameters
}

/// The parameters of the network without normalisation, whose moments are measured anew.
fn settled(
    network: &Network,
    pictures: &Pictures,
    parameters: &[f32],
    works: &mut [Work],
    options: &Options,
) -> Vec<f32> {
    let mut sums: normalise::Moments = vec![];
    for part in 0..SETTLING {
        for (k, work) in works.iter_mut().enumerate() {
            let number = u64::MAX - (part * 1000 + k) as u64;
            let tile = numbered(pictures, options, number);
            standardise(&tile.luma, &mut work.maps[0]);
        }
        // Means of the mean and of the variance.
        let moments = normalise::forward(network, parameters, works);
        for (k, [mean, inverse]) in moments.into_iter().enumerate() {
            if sums.len() <= k {
                sums.push([vec![0.0; mean.len()], vec![0.0; mean.len()]]);
            }
            let share = 1.0 / SETTLING as f32;
            let [means, variances] = &mut sums[k];
            means
                .iter_mut()
                .zip(&mean)
                .for_each(|(s, v)| *s += share * v);
            let both = variances.iter_mut().zip(&inverse);
            both.for_each(|(s, v)| *s += share / (v * v));
        }
    }
    for [_, variances] in &mut sums {
        variances.iter_mut().for_each(|v| *v = 1.0 / v.sqrt());
    }
    normalise::folded(network, parameters, &sums)
}
