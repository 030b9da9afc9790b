//! The few numbers that are taken of each refiner: those directions of what its last head reads in
//! which weights are best predicted, by ridge regression.

use super::outputs::targets;
use super::shots::Shot;
use crate::ridge::accumulate;
use anyhow::{Context, Result};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::{DMatrix, SymmetricEigen};
use posewise::align::Workspace;
use posewise::image::{Frame, FrameLayout};
use posewise::shape::FITTED_NAMES;
use posewise::track::Model;
use posewise_format::SectionWriter;
use rayon::prelude::*;

/// Weight of the squared norm beside the mean squared error.
const RIDGE: f32 = 0.25;
/// Inputs are divided by this.
const UNIT: f32 = 64.0;
/// Largest mean error of the inner landmarks, of the box's side.
const MOST_OFF: f32 = 0.05;
/// Persons of one block of sums.
const BLOCK: usize = 8;

/// Fitted weights of a side that are told apart from what is wanted, by refiner.
const BESIDE: [&[&str]; 3] = [
    &["eyeBlinkRight", "eyeWideRight", "browDownRight"],
    &["jawOpen", "mouthSmileRight", "mouthPucker", "mouthFunnel"],
    &["eyeBlinkRight", "eyeWideRight"],
];
/// Outputs that a refiner sees something of.
const OF_REFINER: [&[usize]; 3] = [&[7, 11], &[0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11], &[7]];
/// How much these count.
const BESIDE_WEIGHT: f32 = 0.3;

/// What is taken of one refiner.
#[derive(Clone)]
pub struct View {
    inputs: usize,
    rows: Vec<Vec<i8>>,
    scales: Vec<f32>,
}

impl View {
    /// Writes it.
    pub fn write(&self, out: &mut SectionWriter) {
        out.scalar(self.rows.len() as u32)
            .scalar(self.inputs as u32);
        if !self.rows.is_empty() {
            out.array(&self.rows.concat()).array(&self.scales);
        }
    }
}

/// What the refiners' last heads have read on a picture: plain and mirrored.
type Reads = [[Vec<u8>; 2]; 3];

fn reads(model: &Model<'_>, shot: &Shot, work: &mut Workspace) -> Option<Reads> {
    let [width, height] = shot.picture.size;
    let layout = FrameLayout::grey(width, height);
    let frame = Frame::new(&layout, &shot.picture.luma).ok()?;
    let mut shape = shot.landmarks;
    let mut reads = Reads::default();
    let align = model.align();
    for _ in 0..2 {
        align
            .iterate(&frame, &mut shape, posewise::align::Networks::All, work)
            .then_some(())?;
    }
    let look = &mut |refiner: usize, mirror: bool, read: &[u8]| {
        reads[refiner][usize::from(mirror)] = read.to_vec();
    };
    align
        .refine_with(&frame, &mut shape, work, look)
        .then_some(())?;
    let size = shot.landmarks.iter().map(|p| p[1]).fold(0.0, f32::max)
        - shot.landmarks.iter().map(|p| p[1]).fold(f32::MAX, f32::min);
    let off =
        (shape.iter().zip(&shot.landmarks).skip(17)).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    (off.sum::<f32>() / 51.0 < MOST_OFF * size).then_some(reads)
}

/// The targets of a refiner's run on a side.
fn wanted(shot: &Shot, refiner: usize, left: bool) -> Vec<f32> {
    let beside = BESIDE[refiner].iter().map(|name| {
        let name = match left {
            true => name.replace("Right", "Left"),
            false => name.to_string(),
        };
        let at = FITTED_NAMES.iter().position(|n| *n == name);
        at.map_or(0.0, |at| BESIDE_WEIGHT * shot.fitted[at])
    });
    let targets = targets(&shot.seen, left);
    let own = targets.iter().enumerate();
    let own = own.filter(|(k, _)| OF_REFINER[refiner].contains(k));
    own.map(|(_, target)| *target).chain(beside).collect()
}

/// Sums over the pictures of persons, each person's mean taken off.
struct Sums {
    xx: Mat<f32>,
    xy: Mat<f32>,
    count: f32,
}

/// Trains what is `taken` of each refiner.
pub fn train(
    model: &Model<'_>,
    shots: &[Shot],
    taken: &[usize; 3],
    is_held_out: impl Fn(u32) -> bool + Sync,
) -> Result<Vec<View>> {
    let seen: Vec<(&Shot, Reads)> = shots
        .par_iter()
        .filter(|shot| !is_held_out(shot.person))
        .map_init(
            || Box::new(Workspace::new()),
            |work, shot| Some((shot, reads(model, shot, work)?)),
        )
        .flatten()
        .collect();
    let persons: Vec<&[(&Shot, Reads)]> = seen.chunk_by(|a, b| a.0.person == b.0.person).collect();
    (0..taken.len())
        .map(|refiner| {
            let inputs = seen.first().context("nothing is seen")?.1[refiner][0].len();
            if taken[refiner] == 0 {
                return Ok(View {
                    inputs,
                    rows: vec![],
                    scales: vec![],
                });
            }
            view(&persons, refiner, inputs, taken[refiner])
        })
        .collect()
}

fn view(
    persons: &[&[(&Shot, Reads)]],
    refiner: usize,
    inputs: usize,
    taken: usize,
) -> Result<View> {
    let outputs = wanted(persons[0][0].0, refiner, false).len();
    let sums = persons
        .par_chunks(BLOCK)
        .fold(
            || Sums {
                xx: Mat::zeros(inputs, inputs),
                xy: Mat::zeros(inputs, outputs),
                count: 0.0,
            },
            |mut sums, persons| {
                let (mut xs, mut ys) = (Vec::new(), Vec::new());
                for (person, mirror) in persons.iter().flat_map(|p| [(p, false), (p, true)]) {
                    let x = |(_, reads): &(&Shot, Reads)| -> Vec<f32> {
                        let read = &reads[refiner][usize::from(mirror)];
                        read.iter().map(|v| f32::from(*v) / UNIT).collect()
                    };
                    let y = |(shot, _): &(&Shot, Reads)| wanted(shot, refiner, mirror);
                    centred(person.iter().map(x).collect(), &mut xs);
                    centred(person.iter().map(y).collect(), &mut ys);
                }
                let a = Mat::from_fn(inputs, xs.len(), |i, n| xs[n][i]);
                let b = Mat::from_fn(xs.len(), outputs, |n, o| ys[n][o]);
                accumulate(&mut sums.xx, &mut sums.xy, &a, &b);
                sums.count += xs.len() as f32;
                sums
            },
        )
        .reduce_with(|mut a, b| {
            a.xx += &b.xx;
            a.xy += &b.xy;
            a.count += b.count;
            a
        })
        .context("nothing is seen")?;
    let xx = Mat::<f64>::from_fn(inputs, inputs, |i, j| {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        let ridge = if i == j { RIDGE * sums.count } else { 0.0 };
        f64::from(sums.xx[(row, column)] + ridge)
    });
    let xy = Mat::<f64>::from_fn(inputs, outputs, |i, j| f64::from(sums.xy[(i, j)]));
    let solution = xx.llt(Side::Lower).ok().context("ridge system")?.solve(&xy);
    // The principal components of what is predicted.
    let by = DMatrix::from_fn(inputs, outputs, |i, j| solution[(i, j)]);
    let with = DMatrix::from_fn(inputs, outputs, |i, j| xy[(i, j)]);
    let predicted = by.transpose() * with;
    let predicted = (&predicted + predicted.transpose()) * 0.5;
    let eigen = SymmetricEigen::new(predicted);
    let mut order: Vec<usize> = (0..outputs).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let mut out = View {
        inputs,
        rows: vec![],
        scales: vec![],
    };
    for k in order.into_iter().take(taken) {
        let column = &by * eigen.eigenvectors.column(k);
        let largest = column.iter().fold(1e-12f64, |m, v| m.max(v.abs()));
        let scale = largest / 127.0;
        out.rows
            .push(column.iter().map(|v| (v / scale).round() as i8).collect());
        out.scales.push(scale as f32 / UNIT);
    }
    Ok(out)
}

/// Adds rows of which their mean is taken off.
fn centred(rows: Vec<Vec<f32>>, to: &mut Vec<Vec<f32>>) {
    let n = rows.len() as f32;
    let mean: Vec<f32> = (0..rows[0].len())
        .map(|k| rows.iter().map(|row| row[k]).sum::<f32>() / n)
        .collect();
    to.extend((rows.iter()).map(|row| row.iter().zip(&mean).map(|(v, m)| v - m).collect()));
}
