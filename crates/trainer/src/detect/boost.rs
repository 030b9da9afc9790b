//! Grows one regression tree of pixel comparisons by weighted least squares.

use posewise::detect::GRID;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::sample::PATCH;

/// Comparisons drawn for a node.
const DRAWN: usize = 700;
/// Samples on which a tree's comparisons are chosen; its leaves are fitted on all.
const CHOSEN: usize = 10_000;
/// Samples transposed at a time: their rows stay in the nearest cache.
const BLOCK: usize = 64;

/// Patches, one plane per pixel of the grid, so that a comparison reads two rows.
pub struct Planes {
    samples: usize,
    luma: Vec<u8>,
}

impl Planes {
    /// Transposes patches that lie one after the other.
    pub fn new(patches: &[u8]) -> Self {
        let samples = patches.len() / PATCH;
        let mut luma = vec![0; samples * PATCH];
        if samples > 0 {
            luma.par_chunks_mut(samples * GRID)
                .enumerate()
                .for_each(|(block, planes)| {
                    for (b, rows) in patches.chunks(PATCH * BLOCK).enumerate() {
                        for (j, plane) in planes.chunks_exact_mut(samples).enumerate() {
                            let values = rows.iter().skip(block * GRID + j).step_by(PATCH);
                            plane[b * BLOCK..]
                                .iter_mut()
                                .zip(values)
                                .for_each(|(p, v)| *p = *v);
                        }
                    }
                });
        }
        Planes { samples, luma }
    }

    /// Number of patches.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// The planes of some samples, which may repeat.
    fn subset(&self, chosen: &[u32]) -> Planes {
        let mut luma = vec![0; chosen.len() * PATCH];
        luma.par_chunks_mut(chosen.len())
            .enumerate()
            .for_each(|(pixel, to)| {
                let from = self.plane(pixel as u16);
                to.iter_mut()
                    .zip(chosen)
                    .for_each(|(v, s)| *v = from[*s as usize]);
            });
        Planes {
            samples: chosen.len(),
            luma,
        }
    }

    fn plane(&self, pixel: u16) -> &[u8] {
        &self.luma[pixel as usize * self.samples..][..self.samples]
    }
}

/// Two patch pixels, and by how much the first must be brighter.
pub type Node = [u16; 3];

/// Margins drawn for a comparison: without one, noise decides in flat regions.
const MARGINS: [u16; 7] = [0, 2, 5, 9, 15, 25, 40];

/// The comparison of a node.
pub fn brighter(first: u8, second: u8, margin: u16) -> bool {
    first as u16 > second as u16 + margin
}

/// A complete tree with `K` numbers to a leaf; nodes breadth first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tree {
    pub nodes: Vec<Node>,
    pub leaves: Vec<Vec<f32>>,
}

impl Tree {
    /// The leaf that a sample reaches.
    pub fn leaf(&self, planes: &Planes, sample: usize) -> usize {
        let mut at = 0;
        while at < self.nodes.len() {
            let [a, b, margin] = self.nodes[at];
            let (first, second) = (planes.plane(a)[sample], planes.plane(b)[sample]);
            at = 2 * at + 1 + usize::from(brighter(first, second, margin));
        }
        at - self.nodes.len()
    }
}

/// A weight and weight × target.
pub type Weighted<const K: usize> = (f32, [f32; K]);

/// Grows a tree of `depth`. Samples are chosen for growing by their weight, for leaves all count.
pub fn grow<const K: usize>(
    planes: &Planes,
    samples: &[Weighted<K>],
    depth: usize,
    rng: &mut ChaCha8Rng,
) -> Tree {
    let chosen = choose(samples, rng);
    let few = planes.subset(&chosen);
    let targets: Vec<[f32; K]> = chosen
        .iter()
        .map(|s| {
            let (w, r) = &samples[*s as usize];
            r.map(|r| r / w.max(1e-30))
        })
        .collect();
    let mut nodes = Vec::with_capacity((1 << depth) - 1);
    let mut parts: Vec<Vec<u32>> = vec![(0..few.samples as u32).collect()];
    for _ in 0..depth {
        let mut next = Vec::with_capacity(2 * parts.len());
        for part in &parts {
            let [a, b, margin] = split(&few, &targets, part, rng);
            nodes.push([a, b, margin]);
            let (pa, pb) = (few.plane(a), few.plane(b));
            let (right, left): (Vec<u32>, Vec<u32>) = part
                .iter()
                .partition(|s| brighter(pa[**s as usize], pb[**s as usize], margin));
            next.push(left);
            next.push(right);
        }
        parts = next;
    }
    let mut tree = Tree {
        nodes,
        leaves: Vec::new(),
    };
    tree.leaves = leaves(planes, samples, &tree, 1 << depth);
    tree
}

/// Weighted means of all samples in each leaf, shrunk towards zero where a leaf has little weight.
fn leaves<const K: usize>(
    planes: &Planes,
    samples: &[Weighted<K>],
    tree: &Tree,
    count: usize,
) -> Vec<Vec<f32>> {
    let at: Vec<usize> = (0..samples.len())
        .into_par_iter()
        .with_min_len(1024)
        .map(|s| tree.leaf(planes, s))
        .collect();
    let all: f32 = samples.iter().map(|s| s.0).sum();
    let prior = 2e-4 * all / count as f32;
    let mut sums = vec![(prior, [0.0; K]); count];
    for (leaf, (w, r)) in at.iter().zip(samples) {
        sums[*leaf].0 += w;
        sums[*leaf].1.iter_mut().zip(r).for_each(|(s, r)| *s += r);
    }
    sums.iter()
        .map(|(w, r)| r.iter().map(|r| r / w).collect())
        .collect()
}

/// Samples in proportion to their weights, in order (systematic resampling).
fn choose<const K: usize>(samples: &[Weighted<K>], rng: &mut ChaCha8Rng) -> Vec<u32> {
    let all: f64 = samples.iter().map(|s| s.0 as f64).sum();
    let count = CHOSEN.min(samples.len());
    let step = all / count as f64;
    let mut next = step * rng.random::<f64>();
    let (mut sum, mut chosen) = (0.0, Vec::with_capacity(count));
    for (i, (w, _)) in samples.iter().enumerate() {
        sum += *w as f64;
        while next < sum && chosen.len() < count {
            chosen.push(i as u32);
            next += step;
        }
    }
    chosen
}

/// Two pixels, often near each other: distant pairs catch shading, near ones edges.
fn draw(rng: &mut ChaCha8Rng) -> Node {
    let first = rng.random_range(0..PATCH);
    loop {
        let second = if rng.random_bool(0.5) {
            let near = |at: usize, rng: &mut ChaCha8Rng| {
                (at as i32 + rng.random_range(-8..=8)).clamp(0, GRID as i32 - 1) as usize
            };
            near(first / GRID, rng) * GRID + near(first % GRID, rng)
        } else {
            rng.random_range(0..PATCH)
        };
        if second != first {
            let margin = MARGINS[rng.random_range(0..MARGINS.len())];
            return [first as u16, second as u16, margin];
        }
    }
}

/// The comparison that explains the most of the targets' variance in `part`.
fn split<const K: usize>(
    planes: &Planes,
    targets: &[[f32; K]],
    part: &[u32],
    rng: &mut ChaCha8Rng,
) -> Node {
    let drawn: Vec<Node> = (0..DRAWN).map(|_| draw(rng)).collect();
    let compact: Vec<[f32; K]> = part.iter().map(|s| targets[*s as usize]).collect();
    drawn
        .par_iter()
        .with_min_len(50)
        .map(|pair| (gain(planes, &compact, part, *pair), *pair))
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))
        .map_or([0, 1, 0], |(_, pair)| pair)
}

/// Sum over both children of |sum of targets|² / count.
fn gain<const K: usize>(
    planes: &Planes,
    targets: &[[f32; K]],
    part: &[u32],
    [a, b, margin]: Node,
) -> f32 {
    let (pa, pb) = (planes.plane(a), planes.plane(b));
    let (mut count, mut above, mut all) = (0.0f32, [0.0f32; K], [0.0f32; K]);
    for (s, target) in part.iter().zip(targets) {
        let s = *s as usize;
        let weight = f32::from(u8::from(brighter(pa[s], pb[s], margin)));
        count += weight;
        for k in 0..K {
            above[k] += weight * target[k];
            all[k] += target[k];
        }
    }
    let rest = part.len() as f32 - count;
    let square = |sums: &[f32; K]| sums.iter().map(|v| v * v).sum::<f32>();
    let darker: [f32; K] = std::array::from_fn(|k| all[k] - above[k]);
    let share = |sums: &[f32; K], count: f32| {
        if count > 0.0 {
            square(sums) / count
        } else {
            0.0
        }
    };
    share(&above, count) + share(&darker, rest)
}
