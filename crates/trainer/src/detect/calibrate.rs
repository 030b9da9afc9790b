//! Sets the cascade's thresholds once all trees are trained, from the windows of the scan's own
//! grid around labelled faces.

use posewise::detect::Detection;
use posewise::image::Frame;
use rand::Rng;
use rayon::prelude::*;

use super::cascade::{Cascade, Flat, UNIT};
use super::faces::Face;
use super::options::rng_for;
use super::sample::{window, with_view};

/// Windows on the grid around each face that must pass.
const SURVIVORS: usize = 3;
/// Share of these windows that all trees together may lose, and the power of the share of the trees
/// with which the loss grows: the first trees may lose most, because rejecting early is cheapest.
const LOSS: f32 = 0.01;
const LATENESS: f32 = 0.2;
/// How far the thresholds lie below the faces' sums, for people not seen in training.
const MARGIN: f32 = 0.12;

/// The cascade with the highest thresholds that still pass the best windows of nearly all faces on
/// the scan's grid (after Zhang and Viola's multiple-instance pruning, 2007). A quantile of these
/// windows is discarded: thresholds that pass them would pass too many false positives.
pub fn thresholds(cascade: &Cascade, faces: &[Face], discard_quantile: f32) -> Cascade {
    let flat = cascade.flat();
    let mut sums: Vec<Vec<i32>> = faces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(i, face)| {
            let mut rng = rng_for(2, 0x4341_4C49, i as u64);
            let grid = |frame: &Frame<'_>, truth: &Detection, rng: &mut _| {
                survivors(&flat, frame, truth, rng)
            };
            let all: Vec<Vec<i32>> = (0..2)
                .flat_map(|_| with_view(face, &mut rng, grid))
                .collect();
            all
        })
        .collect();
    let mut ends: Vec<i32> = sums.iter().filter_map(|s| s.last().copied()).collect();
    ends.sort_unstable();
    // Sums below the operating point of training (0) are faces only by chance.
    let least = *cascade.thresholds.last().unwrap_or(&0);
    let end = ends.get((discard_quantile * ends.len() as f32) as usize);
    let last = end.map_or(least, |end| least.max(*end));
    sums.retain(|sums| sums.last().is_some_and(|s| *s >= last));
    let mut out = cascade.clone();
    let all = sums.len();
    for tree in 0..cascade.trees.len() {
        // Windows already lost must not lower later thresholds.
        let mut at: Vec<i32> = sums.iter().map(|s| s[tree]).collect();
        let asked = (tree + 1) as f32 / cascade.trees.len() as f32;
        let lost = (LOSS * asked.powf(LATENESS) * all as f32) as usize;
        at.sort_unstable();
        let bound = at
            .get(lost.saturating_sub(all - at.len()))
            .copied()
            .unwrap_or(i32::MIN / 4);
        sums.retain(|s| s[tree] >= bound);
        out.thresholds[tree] = bound - (MARGIN / UNIT) as i32;
    }
    if let Some(t) = out.thresholds.last_mut() {
        *t = (*t).max(last);
    }
    out
}

/// Sums of the windows with the best final sums on a scan's grid of random phase.
fn survivors(
    flat: &Flat,
    frame: &Frame<'_>,
    truth: &Detection,
    rng: &mut rand_chacha::ChaCha8Rng,
) -> Vec<Vec<i32>> {
    let mut phase = || rng.random_range(-0.5f32..0.5);
    let (px, py, ps) = (phase(), phase(), phase());
    let mut all = Vec::new();
    for roll in [-30.0f32, 0.0, 30.0] {
        let roll = roll.to_radians();
        if (roll - truth.roll).abs() > 0.35 {
            continue;
        }
        for k in -1..=1 {
            let size = truth.size * 1.2f32.powf(k as f32 + ps);
            for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j))) {
                let at = Detection {
                    x: truth.x + 0.12 * size * (i as f32 + px),
                    y: truth.y + 0.12 * size * (j as f32 + py),
                    size,
                    roll,
                    ..*truth
                };
                all.push(flat.sums(frame, &window(&at)));
            }
        }
    }
    all.sort_by_key(|sums| std::cmp::Reverse(sums.last().copied()));
    all.truncate(SURVIVORS);
    all
}
