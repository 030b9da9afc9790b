//! Gentle boosting with a soft cascade, alternating with mining.

use std::path::Path;

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};
use rand::Rng;
use rayon::prelude::*;

use super::boost::{Planes, grow};
use super::cascade::{Cascade, UNIT, quantised};
use super::faces::Face;
use super::mine::{Ground, mine};
use super::options::{Options, rng_for};
use super::sample::{Jitter, PATCH, cut, disturb, window, with_view};
use crate::picture::Picture;

/// Share of positives that the whole cascade may lose in training, distributed over the trees.
const LOSS: f32 = 0.10;
/// Trees after which negatives are mined anew; then every 20.
const ROUNDS: [usize; 16] = [1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 33, 41, 50, 60, 72, 85];
/// Most windows tried in one round of mining.
const MOST_TRIES: usize = 10_000_000;

/// A face's share of the samples: turned and tilted heads are rare in photographs.
fn rarity(face: &Face) -> f64 {
    let yaw = face.truth.yaw.abs() as f64 * 90.0;
    1.0 + 3.0 * ((yaw - 12.0) / 25.0).clamp(0.0, 1.0)
}

/// Augmented patches of faces, drawn by rarity.
pub fn positives(faces: &[Face], count: usize, jitter: Jitter, seed: u64) -> Vec<u8> {
    let mut cumulated = Vec::with_capacity(faces.len());
    let mut total = 0.0;
    for face in faces {
        total += rarity(face);
        cumulated.push(total);
    }
    let patches: Vec<Vec<u8>> = (0..count)
        .into_par_iter()
        .map(|i| {
            let mut rng = rng_for(seed, 0x504F_5349, i as u64);
            let at = total * (i as f64 + rng.random::<f64>()) / count as f64;
            let face = &faces[cumulated.partition_point(|c| *c < at).min(faces.len() - 1)];
            let mut patch = with_view(face, &mut rng, |frame, truth, rng| {
                let window = window(&jitter.draw(truth, rng));
                let window = if rng.random_bool(0.5) {
                    window.mirrored()
                } else {
                    window
                };
                let mut patch = Vec::with_capacity(PATCH);
                cut(frame, &window, &mut patch);
                patch
            });
            disturb(&mut patch, &mut rng, true);
            patch
        })
        .collect();
    patches.concat()
}

struct Training<'a> {
    options: &'a Options,
    ground: Ground<'a>,
    positives: Vec<u8>,
    negatives: Vec<u8>,
    planes: Planes,
    sums: Vec<i32>,
    // Positives below a threshold; they get no weight, else they would outweigh the others.
    lost: Vec<bool>,
    cascade: Cascade,
}

impl Training<'_> {
    fn faces(&self) -> usize {
        self.positives.len() / PATCH
    }

    /// Keeps the negatives that still pass and adds mined ones; when too few are found, rejected
    /// ones are kept too.
    fn renew(&mut self, bar: &ProgressBar) {
        let flat = self.cascade.flat();
        let passing: Vec<bool> = self
            .negatives
            .par_chunks_exact(PATCH)
            .map(|patch| flat.passes_patch(patch))
            .collect();
        let (mut kept, mut spare) = (Vec::new(), Vec::new());
        for (patch, passes) in self.negatives.chunks_exact(PATCH).zip(&passing) {
            let to = if *passes { &mut kept } else { &mut spare };
            to.extend_from_slice(patch);
        }
        let wanted = self.options.negatives.saturating_sub(kept.len() / PATCH);
        let stage = self.cascade.trees.len() as u64;
        let seed = self.options.seed;
        let mined = mine(&self.ground, &self.cascade, wanted, MOST_TRIES, seed, stage);
        bar.suspend(|| {
            println!(
                "{stage} trees: {} negatives stay, {} new of {} tried: {:.2e} pass",
                kept.len() / PATCH,
                mined.patches.len() / PATCH,
                mined.tried,
                mined.passed as f64 / mined.tried.max(1) as f64,
            )
        });
        // New ones first: the oldest rejected ones are cut off.
        self.negatives = mined.patches;
        self.negatives.extend(kept);
        self.negatives.extend(spare);
        self.negatives.truncate(self.options.negatives * PATCH);
        let all = [self.positives.as_slice(), &self.negatives].concat();
        self.planes = Planes::new(&all);
        drop(all);
        self.sums = vec![0; self.planes.samples()];
        self.lost = vec![false; self.faces()];
        for i in 0..self.cascade.trees.len() {
            self.add(i);
            self.lose(i);
        }
    }

    fn add(&mut self, tree: usize) {
        let (tree, planes) = (&self.cascade.trees[tree], &self.planes);
        self.sums
            .par_iter_mut()
            .enumerate()
            .for_each(|(s, sum)| *sum += quantised(tree.leaves[tree.leaf(planes, s)][0]) as i32);
    }

    fn lose(&mut self, tree: usize) {
        let threshold = self.cascade.thresholds[tree];
        for (lost, sum) in self.lost.iter_mut().zip(&self.sums) {
            *lost |= *sum < threshold;
        }
    }

    fn one_tree(&mut self) {
        let faces = self.faces();
        let index = self.cascade.trees.len();
        let mut weights: Vec<f32> = self
            .sums
            .iter()
            .enumerate()
            .map(|(s, sum)| {
                let f = *sum as f32 * UNIT;
                match s < faces {
                    true if self.lost[s] => 0.0,
                    true => (-f).clamp(-20.0, 8.0).exp(),
                    false => f.clamp(-20.0, 8.0).exp(),
                }
            })
            .collect();
        let (p, n) = weights.split_at_mut(faces);
        for half in [p, n] {
            let total: f32 = half.iter().sum();
            half.iter_mut().for_each(|w| *w *= 0.5 / total.max(1e-20));
        }
        let samples: Vec<(f32, [f32; 1])> = weights
            .iter()
            .enumerate()
            .map(|(s, w)| (*w, [if s < faces { *w } else { -*w }]))
            .collect();
        let mut rng = rng_for(self.options.seed, 0x5452_4545, index as u64);
        let tree = grow(&self.planes, &samples, self.options.depth, &mut rng);
        self.cascade.trees.push(tree);
        self.add(index);
        let mut sums = self.sums[..faces].to_vec();
        // More loss in early trees: early rejection makes the cascade fast.
        let lost = LOSS * ((index + 1) as f32 / self.options.trees as f32).powf(0.35);
        let at = (lost * faces as f32) as usize;
        let (_, threshold, _) = sums.select_nth_unstable(at.min(faces - 1));
        self.cascade.thresholds.push(*threshold);
        self.lose(index);
    }
}

/// Trains the cascade; goes on from `cache` where an earlier run with these options stopped.
///
/// # Errors
/// When the cache cannot be written.
pub fn train(
    faces: &[Face],
    backgrounds: &[Picture],
    cache: &Path,
    options: &Options,
) -> Result<Cascade> {
    let name = format!(
        "detect-cascade-{}-x{}-{}-{}.json",
        options.seed, options.depth, options.positives, options.negatives
    );
    let checkpoint = cache.join(name);
    let mut cascade: Cascade = match std::fs::read(&checkpoint) {
        Ok(bytes) => serde_json::from_slice(&bytes)?,
        Err(_) => Cascade {
            depth: options.depth,
            ..Cascade::default()
        },
    };
    if cascade.trees.len() >= options.trees {
        cascade.trees.truncate(options.trees);
        cascade.thresholds.truncate(options.trees);
        return Ok(cascade);
    }
    let bar = ProgressBar::new(options.trees as u64).with_style(ProgressStyle::with_template(
        "detector {pos}/{len} trees [{elapsed} of {duration}] {wide_bar}",
    )?);
    let mut training = Training {
        options,
        ground: Ground::new(backgrounds, faces),
        positives: positives(faces, options.positives, Jitter::SCAN, options.seed),
        negatives: Vec::new(),
        planes: Planes::new(&[]),
        sums: Vec::new(),
        lost: Vec::new(),
        cascade,
    };
    training.renew(&bar);
    while training.cascade.trees.len() < options.trees {
        training.one_tree();
        let trees = training.cascade.trees.len();
        bar.set_position(trees as u64);
        if ROUNDS.contains(&trees) || (trees > 85 && trees % 20 == 5) {
            std::fs::write(&checkpoint, serde_json::to_vec(&training.cascade)?)?;
            training.renew(&bar);
        }
    }
    std::fs::write(&checkpoint, serde_json::to_vec(&training.cascade)?)?;
    bar.finish();
    Ok(training.cascade)
}
