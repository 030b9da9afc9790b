//! How far each landmark draws each vertex: the smoothest displacements that have the landmarks'
//! own there, and fade out far from them.

use super::surface::Surface;
use anyhow::{Context, Result};
use nalgebra::{Cholesky, DMatrix};
use posewise::shape::{LANDMARKS, MESH_PULLS, WHOLE_PULL};
use std::collections::BTreeMap;

/// See [`weights`].
const STIFF: f64 = 4.0;
const FADE: f64 = 0.005;
/// The fading grows by this from the depth of the eyes to that of the ears \[mm\], with its square.
/// What draws ears and temples is the jaw's contour, and where that is on a turned head says little
/// of them: they are nearer to where the fit has them.
const FADE_BEHIND: f64 = 3.0;
const BEHIND_MM: f64 = 60.0;

/// By vertex of `vertices`, whose first are the landmarks: which landmarks draw it, and how far in
/// parts of [`WHOLE_PULL`].
pub type Pulls = Vec<([u8; MESH_PULLS], [i8; MESH_PULLS])>;

pub fn pulls(surface: &Surface, vertices: &[u32]) -> Result<Pulls> {
    let weights = weights(surface, vertices)?;
    Ok((0..vertices.len())
        .map(|row| match row < LANDMARKS {
            true => {
                let mut of = ([0; MESH_PULLS], [0; MESH_PULLS]);
                (of.0[0], of.1[0]) = (row as u8, WHOLE_PULL);
                of
            }
            false => strongest(weights.row(row - LANDMARKS).iter().copied()),
        })
        .collect())
}

/// Displacements w of the vertices that are no landmarks by those of the landmarks, which make
/// `STIFF · Σ |bend|² + Σ |stretch|² + Σ fade · |w|²` least: how far a vertex is from the mean of
/// its neighbours, from each of them, and from where it is. Stretching alone would leave a spike at
/// each landmark, bending alone would swing beyond them.
fn weights(surface: &Surface, vertices: &[u32]) -> Result<DMatrix<f64>> {
    let n = vertices.len();
    let place: BTreeMap<u32, usize> = vertices.iter().copied().zip(0..).collect();
    let mut bend = DMatrix::<f64>::zeros(n, n);
    let mut energy = DMatrix::from_fn(n, n, |row, column| match row == column {
        true => fade(surface.point(vertices[row]).z.into()),
        false => 0.0,
    });
    for (row, vertex) in vertices.iter().enumerate() {
        let near = surface.neighbours(*vertex);
        let nearness =
            |other: &u32| 1.0 / f64::from(surface.point(*other).distance(surface.point(*vertex)));
        let total: f64 = near.iter().map(nearness).sum();
        bend[(row, row)] = -1.0;
        let share = 0.5 / near.len() as f64;
        for other in &near {
            let column = place[other];
            bend[(row, column)] = nearness(other) / total;
            energy[(row, row)] += share;
            energy[(column, column)] += share;
            energy[(row, column)] -= share;
            energy[(column, row)] -= share;
        }
    }
    energy += bend.transpose() * &bend * STIFF;
    let free = n - LANDMARKS;
    let within = energy
        .view((LANDMARKS, LANDMARKS), (free, free))
        .into_owned();
    let across = energy.view((LANDMARKS, 0), (free, LANDMARKS)).into_owned();
    let solved = Cholesky::new(within).context("the surface is in pieces")?;
    Ok(-solved.solve(&across))
}

/// How much a vertex at this depth of the head \[mm\] stays where it is.
fn fade(depth_mm: f64) -> f64 {
    FADE + FADE_BEHIND * (depth_mm / BEHIND_MM).clamp(0.0, 1.0).powi(2)
}

/// The strongest of a vertex's pulls, which together draw it as far as all do.
fn strongest(weights: impl Iterator<Item = f64>) -> ([u8; MESH_PULLS], [i8; MESH_PULLS]) {
    let mut all: Vec<(usize, f64)> = weights.enumerate().collect();
    let total: f64 = all.iter().map(|(_, w)| w).sum();
    all.sort_by(|(i, a), (j, b)| b.abs().total_cmp(&a.abs()).then(i.cmp(j)));
    all.truncate(MESH_PULLS);
    let kept: f64 = all.iter().map(|(_, w)| w).sum();
    let missing = (total - kept) / MESH_PULLS as f64;
    let quantised = |w: f64| (f64::from(WHOLE_PULL) * w).round().clamp(-127.0, 127.0);
    let landmarks = std::array::from_fn(|k| all[k].0 as u8);
    let mut pulls: [i8; MESH_PULLS] = std::array::from_fn(|k| quantised(all[k].1 + missing) as i8);
    // What rounding took.
    let sum: f64 = pulls.iter().map(|pull| f64::from(*pull)).sum();
    let rest = quantised(total) - sum;
    pulls[0] = (f64::from(pulls[0]) + rest).clamp(-127.0, 127.0) as i8;
    (landmarks, pulls)
}
