//! Fits the forest that moves a hit onto the face: boosted least squares on five numbers.

use std::path::Path;

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};
use posewise::detect::{Detection, REFINE_OUTPUTS};
use rand::Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::boost::{Node, Planes, Tree, grow};
use super::faces::Face;
use super::options::{Options, rng_for};
use super::sample::{Jitter, PATCH, cut, disturb, window, with_view};

/// One unit of a leaf, for all five outputs.
const UNIT: f32 = 1.0 / 4096.0;
/// Share of a tree's prediction that is added.
const SHRINK: f32 = 0.2;
/// How often the forest is applied.
const ROUNDS: usize = 2;
/// Makes the outputs comparable: reciprocals of their typical errors.
const SCALE: [f32; REFINE_OUTPUTS] = [14.0, 14.0, 10.0, 6.0, 3.0];

type Targets = [f32; REFINE_OUTPUTS];

/// The refining forest, leaves in natural units.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Forest {
    pub rounds: usize,
    pub depth: usize,
    pub trees: Vec<Tree>,
}

impl Forest {
    /// Nodes and leaves.
    pub fn flat(&self) -> (Vec<Node>, Vec<i16>) {
        let nodes = self.trees.iter().flat_map(|t| t.nodes.clone());
        let leaves = self.trees.iter().flat_map(|t| t.leaves.iter().flatten());
        let leaves = leaves.map(|l| (l / UNIT).round() as i16);
        (nodes.collect(), leaves.collect())
    }
}

/// The transform from `from` to `truth`, in the axes of `from`; and the yaw.
fn targets(from: &Detection, truth: &Detection) -> Targets {
    let (sin, cos) = from.roll.sin_cos();
    let (dx, dy) = (truth.x - from.x, truth.y - from.y);
    [
        (cos * dx + sin * dy) / from.size,
        (cos * dy - sin * dx) / from.size,
        (truth.size / from.size).ln(),
        truth.roll - from.roll,
        truth.yaw,
    ]
}

fn sample(faces: &[Face], options: &Options, index: u64) -> (Vec<u8>, Targets) {
    let mut rng = rng_for(options.seed, 0x5245_4649, index);
    let face = loop {
        let face = &faces[rng.random_range(0..faces.len())];
        // Every second draw prefers a large yaw.
        if rng.random_bool(0.5) || face.truth.yaw.abs() > rng.random_range(0.0..0.4) {
            break face;
        }
    };
    let (mut patch, targets) = with_view(face, &mut rng, |frame, truth, rng| {
        let mut jitter = Jitter::REFINE;
        if rng.random_bool(0.5) {
            jitter.shift *= 0.4;
            jitter.log_size *= 0.4;
            jitter.roll *= 0.4;
        }
        let from = jitter.draw(truth, rng);
        let mut targets = targets(&from, truth);
        let mut window = window(&from);
        if rng.random_bool(0.5) {
            window = window.mirrored();
            for output in [0, 3, 4] {
                targets[output] = -targets[output];
            }
        }
        let mut patch = Vec::with_capacity(PATCH);
        cut(frame, &window, &mut patch);
        (patch, targets)
    });
    disturb(&mut patch, &mut rng, true);
    (patch, targets)
}

/// Fits the forest; read from `cache` if it is there.
///
/// # Errors
/// When the cache cannot be written.
pub fn train(faces: &[Face], cache: &Path, options: &Options) -> Result<Forest> {
    let (trees, depth, count) = (
        options.refine_trees,
        options.refine_depth,
        options.refine_samples,
    );
    let name = format!(
        "detect-refine-{}-{trees}x{depth}-{count}-{}.json",
        options.seed,
        faces.len()
    );
    let checkpoint = cache.join(name);
    if let Ok(bytes) = std::fs::read(&checkpoint) {
        return Ok(serde_json::from_slice(&bytes)?);
    }
    let (patches, mut residuals): (Vec<Vec<u8>>, Vec<Targets>) = (0..count as u64)
        .into_par_iter()
        .map(|i| sample(faces, options, i))
        .unzip();
    let planes = Planes::new(&patches.concat());
    drop(patches);
    let mut forest = Forest {
        rounds: ROUNDS,
        depth,
        trees: Vec::new(),
    };
    let bar = ProgressBar::new(trees as u64).with_style(ProgressStyle::with_template(
        "refiner {pos}/{len} trees [{elapsed} of {duration}] {wide_bar} {msg}",
    )?);
    for index in 0..trees {
        let samples: Vec<(f32, Targets)> = residuals
            .iter()
            .map(|r| (1.0, std::array::from_fn(|k| r[k] * SCALE[k])))
            .collect();
        let mut rng = rng_for(options.seed, 0x5246_5452, index as u64);
        let mut tree = grow(&planes, &samples, depth, &mut rng);
        for leaf in &mut tree.leaves {
            for (value, scale) in leaf.iter_mut().zip(SCALE) {
                *value *= SHRINK / scale;
            }
        }
        residuals
            .par_iter_mut()
            .enumerate()
            .for_each(|(s, residual)| {
                let leaf = &tree.leaves[tree.leaf(&planes, s)];
                residual.iter_mut().zip(leaf).for_each(|(r, v)| *r -= v);
            });
        forest.trees.push(tree);
        bar.set_message(spread(&residuals));
        bar.inc(1);
    }
    bar.abandon();
    println!("refiner's residuals on its samples: {}", spread(&residuals));
    std::fs::write(&checkpoint, serde_json::to_vec(&forest)?)?;
    Ok(forest)
}

/// Root mean squares of the outputs.
fn spread(residuals: &[Targets]) -> String {
    (0..REFINE_OUTPUTS)
        .map(|k| {
            let sum: f32 = residuals.iter().map(|r| r[k] * r[k]).sum();
            format!("{:.3} ", (sum / residuals.len().max(1) as f32).sqrt())
        })
        .collect()
}
