//! What a stage sees of a landmark: four kinds of local features, all reduced to the same number.

use super::rbm;
use crate::faces::Face;
use faer::{Mat, Side};
use ndarray::{Array1, Array2, Axis};
use posewise::align::Shape;
use posewise::image::{Crop, warp};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use rand_chacha::ChaCha8Rng;

/// Features per landmark after reduction.
pub const OUTPUTS: usize = 24;
/// Side of the patches that filters see.
const PATCH: usize = 16;
/// Hidden units of the RBM.
const HIDDEN: usize = 64;
/// What crops cover, in canonical units; a face's box is 64 wide.
const COVER: f32 = 96.0;
/// Distance and side of the histograms' cells by stage, in canonical units; what all kinds see is as
/// wide as three cells.
const CELLS: [(f32, f32); 4] = [(8.0, 13.0), (7.0, 13.0), (6.0, 11.0), (5.0, 9.0)];
const ORIENTATIONS: usize = 8;

/// Kind of local features.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Gradient histograms of 3×3 cells.
    Hog,
    /// Whitened principal components of patches, squashed.
    Pca,
    /// Hidden units of a restricted Boltzmann machine.
    Rbm,
    /// The same, then tuned for the stage's regression by gradients.
    Refined,
}

impl Kind {
    /// Canonical units per crop px.
    pub fn step(self, stage: usize) -> f32 {
        let (distance, side) = CELLS[stage];
        match self {
            Kind::Hog => 1.0,
            _ => (2.0 * distance + side) / PATCH as f32,
        }
    }
}

/// A face as a stage sees it: upright and in its size, by the shape that is to be corrected.
pub struct Look {
    /// Row-major luma.
    pub crop: Vec<f32>,
    /// Side of the crop.
    pub side: usize,
    /// The shape in crop px.
    pub points: Shape,
}

impl Look {
    /// Looks at a face, `step` canonical units a px.
    pub fn at(face: &Face, mean: &Shape, shape: &Shape, step: f32) -> Look {
        let canonical = Similarity::fit(mean, shape).expect("a shape has extent");
        let side = (COVER / step).ceil() as usize;
        let corner = -(side as f32 - 1.0) / 2.0 * step;
        let to_frame = Similarity {
            a: step,
            b: 0.0,
            tx: corner,
            ty: corner,
        }
        .then(&canonical);
        let mut crop = Crop::new();
        warp(&face.picture.frame(), &to_frame, side, &mut crop);
        let back = to_frame.inverse().expect("a shape has extent");
        Look {
            crop: crop.luma().iter().map(|v| *v as f32).collect(),
            side,
            points: shape.map(|p| back.apply(p)),
        }
    }

    /// Patches around the landmarks, a row each, of mean 0 and deviation 1 (less where there is no
    /// contrast).
    pub fn patches(&self) -> Array2<f32> {
        let mut patches = Array2::zeros((LANDMARKS, PATCH * PATCH));
        let last = self.side as i32 - 1;
        for (mut row, [x, y]) in patches.rows_mut().into_iter().zip(self.points) {
            let half = (PATCH as f32 - 1.0) / 2.0;
            let (x, y) = (x - half, y - half);
            let (u, v) = (x.floor(), y.floor());
            let (fx, fy) = (x - u, y - v);
            let at = |i: i32, j: i32| {
                let (i, j) = (i.clamp(0, last), j.clamp(0, last));
                self.crop[j as usize * self.side + i as usize]
            };
            for (k, pixel) in row.iter_mut().enumerate() {
                let (i, j) = (u as i32 + (k % PATCH) as i32, v as i32 + (k / PATCH) as i32);
                let upper = at(i, j) * (1.0 - fx) + at(i + 1, j) * fx;
                let lower = at(i, j + 1) * (1.0 - fx) + at(i + 1, j + 1) * fx;
                *pixel = upper * (1.0 - fy) + lower * fy;
            }
            let mean = row.mean().expect("a patch has pixels");
            row -= mean;
            let deviation = (row.dot(&row) / row.len() as f32).sqrt();
            row /= deviation + 4.0;
        }
        patches
    }

    /// Gradient histograms: 3×3 cells, each the mean over a box; the root of each share.
    fn histograms(&self, distance: f32, side: f32) -> Array2<f32> {
        let sums = Integral::of_gradients(&self.crop, self.side);
        let mut out = Array2::zeros((LANDMARKS, 9 * ORIENTATIONS));
        for (mut row, [x, y]) in out.rows_mut().into_iter().zip(self.points) {
            for cell in 0..9 {
                let x = x + (cell % 3) as f32 * distance - distance - side / 2.0 + 0.5;
                let y = y + (cell / 3) as f32 * distance - distance - side / 2.0 + 0.5;
                let [a, b] = [sums.at(x, y), sums.at(x + side, y)];
                let [c, d] = [sums.at(x, y + side), sums.at(x + side, y + side)];
                for o in 0..ORIENTATIONS {
                    row[cell * ORIENTATIONS + o] = (a[o] + d[o] - b[o] - c[o]).max(0.0);
                }
            }
            // One grey level per px in each cell, so that noise alone is not a feature.
            let total = row.sum() + 9.0 * side * side;
            row.mapv_inplace(|v| (v / total).sqrt());
        }
        out
    }
}

/// Sums of gradients by orientation over all px above and to the left.
struct Integral {
    sums: Vec<[f32; ORIENTATIONS]>,
    side: usize,
}

impl Integral {
    fn of_gradients(luma: &[f32], side: usize) -> Integral {
        let width = side + 1;
        let mut sums = vec![[0.0; ORIENTATIONS]; width * width];
        for y in 0..side {
            let mut row = [0.0; ORIENTATIONS];
            for x in 0..side {
                let at = |x: usize, y: usize| luma[y * side + x];
                let dx = (at((x + 1).min(side - 1), y) - at(x.saturating_sub(1), y)) / 2.0;
                let dy = (at(x, (y + 1).min(side - 1)) - at(x, y.saturating_sub(1))) / 2.0;
                let turn = dy.atan2(dx) / std::f32::consts::TAU;
                let bin = turn.rem_euclid(1.0) * ORIENTATIONS as f32;
                let (low, share) = (bin as usize % ORIENTATIONS, bin.fract());
                let length = dx.hypot(dy);
                row[low] += length * (1.0 - share);
                row[(low + 1) % ORIENTATIONS] += length * share;
                let above = sums[y * width + x + 1];
                sums[(y + 1) * width + x + 1] = std::array::from_fn(|o| row[o] + above[o]);
            }
        }
        Integral { sums, side }
    }

    /// The sum up to a place between px.
    fn at(&self, x: f32, y: f32) -> [f32; ORIENTATIONS] {
        let last = self.side as f32;
        let (x, y) = (x.clamp(0.0, last), y.clamp(0.0, last));
        let (u, v) = (x as usize, y as usize);
        let (fx, fy) = (x - u as f32, y - v as f32);
        let (u1, v1) = ((u + 1).min(self.side), (v + 1).min(self.side));
        let [a, b, c, d] =
            [(u, v), (u1, v), (u, v1), (u1, v1)].map(|(u, v)| &self.sums[v * (self.side + 1) + u]);
        std::array::from_fn(|o| {
            (a[o] * (1.0 - fx) + b[o] * fx) * (1.0 - fy) + (c[o] * (1.0 - fx) + d[o] * fx) * fy
        })
    }
}

/// Filters on a patch: sigmoid(bias + weightsᵀ·patch), shared by all landmarks.
#[derive(Clone)]
pub struct Filters {
    /// A column per output.
    pub weights: Array2<f32>,
    /// Of each output.
    pub bias: Array1<f32>,
}

impl Filters {
    /// Outputs for patches in rows.
    pub fn of(&self, patches: &Array2<f32>) -> Array2<f32> {
        let mut out = patches.dot(&self.weights);
        out += &self.bias;
        out.mapv_inplace(sigmoid);
        out
    }
}

/// 1 / (1 + e⁻ᶻ)
pub fn sigmoid(z: f32) -> f32 {
    1.0 / (1.0 + (-z).exp())
}

enum Raw {
    Hog(f32, f32),
    Filters(Filters),
}

/// The features of one stage: raw ones and what reduces them to [`OUTPUTS`].
pub struct Features {
    raw: Raw,
    /// Of the raw features.
    pub mean: Array1<f32>,
    /// A column per output; outputs have a mean square of 1.
    pub reduction: Array2<f32>,
    /// Canonical units per px of the crops.
    pub step: f32,
}

impl Features {
    /// Learns a stage's features (not refined yet) from looks.
    pub fn fit(kind: Kind, stage: usize, looks: &[Look], rng: &mut ChaCha8Rng) -> Features {
        let patches = || stacked(looks.iter().map(Look::patches));
        let raw = match kind {
            Kind::Hog => Raw::Hog(CELLS[stage].0, CELLS[stage].1),
            Kind::Pca => Raw::Filters(whitening(&patches())),
            _ => Raw::Filters(rbm::train(
                &patches(),
                HIDDEN,
                &rbm::Options::default(),
                rng,
            )),
        };
        let raw_rows = stacked(looks.iter().map(|look| raw_of(&raw, look)));
        let mean = raw_rows.mean_axis(Axis(0)).expect("there are looks");
        let (_, vectors) = principal(&covariance(&raw_rows, &mean));
        let reduction =
            Array2::from_shape_fn((mean.len(), OUTPUTS), |(i, o)| vectors[(i, o)] as f32);
        let mut features = Features {
            raw,
            mean,
            reduction,
            step: kind.step(stage),
        };
        features.rescale(looks);
        features
    }

    /// The filters, of kinds that have some.
    pub fn filters(&mut self) -> Option<&mut Filters> {
        match &mut self.raw {
            Raw::Hog(..) => None,
            Raw::Filters(filters) => Some(filters),
        }
    }

    /// Makes outputs 1 in the mean square over these looks.
    pub fn rescale(&mut self, looks: &[Look]) {
        let raw_rows = stacked(looks.iter().map(|look| raw_of(&self.raw, look)));
        self.mean = raw_rows.mean_axis(Axis(0)).expect("there are looks");
        let out = (raw_rows - &self.mean).dot(&self.reduction);
        let square = out.iter().map(|v| (*v as f64).powi(2)).sum::<f64>() / out.len() as f64;
        self.reduction /= square.sqrt() as f32;
    }

    /// Features of a look, landmark after landmark.
    pub fn of(&self, look: &Look) -> Vec<f32> {
        let raw = raw_of(&self.raw, look) - &self.mean;
        raw.dot(&self.reduction).into_iter().collect()
    }
}

fn raw_of(raw: &Raw, look: &Look) -> Array2<f32> {
    match raw {
        Raw::Hog(distance, side) => look.histograms(*distance, *side),
        Raw::Filters(filters) => filters.of(&look.patches()),
    }
}

fn stacked(parts: impl Iterator<Item = Array2<f32>>) -> Array2<f32> {
    let parts: Vec<_> = parts.collect();
    let views: Vec<_> = parts.iter().map(|part| part.view()).collect();
    ndarray::concatenate(Axis(0), &views).expect("parts are equally wide")
}

fn covariance(rows: &Array2<f32>, mean: &Array1<f32>) -> Mat<f64> {
    let centred = rows - mean;
    let sum = centred.t().dot(&centred);
    Mat::from_fn(mean.len(), mean.len(), |i, j| {
        sum[(i, j)] as f64 / rows.nrows() as f64
    })
}

/// Eigenvalues of a symmetric matrix and its eigenvectors in columns, largest first.
pub fn principal(matrix: &Mat<f64>) -> (Vec<f64>, Mat<f64>) {
    let eigen = matrix
        .self_adjoint_eigen(Side::Lower)
        .expect("a symmetric matrix has eigenvalues");
    let (n, values) = (matrix.nrows(), eigen.S().column_vector());
    let vectors = Mat::from_fn(n, n, |i, j| eigen.U()[(i, n - 1 - j)]);
    ((0..n).map(|j| values[n - 1 - j]).collect(), vectors)
}

/// The first principal components, brought to a deviation of 1.
fn whitening(patches: &Array2<f32>) -> Filters {
    let mean = patches.mean_axis(Axis(0)).expect("there are patches");
    let (values, vectors) = principal(&covariance(patches, &mean));
    let weights = Array2::from_shape_fn((mean.len(), OUTPUTS), |(i, o)| {
        (vectors[(i, o)] / values[o].sqrt().max(1e-6)) as f32
    });
    let bias = -mean.dot(&weights);
    Filters { weights, bias }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(luma: impl Fn(usize, usize) -> f32) -> Look {
        let side = 64;
        Look {
            crop: (0..side * side).map(|k| luma(k % side, k / side)).collect(),
            side,
            points: [[31.5; 2]; LANDMARKS],
        }
    }

    #[test]
    fn histograms_of_a_constant_patch_are_zero() {
        let flat = look(|_, _| 93.0).histograms(8.0, 13.0);
        assert!(flat.iter().all(|v| *v == 0.0));
    }

    #[test]
    fn histograms_tell_the_direction_of_a_slope() {
        let slope = look(|x, _| 3.0 * x as f32).histograms(8.0, 13.0);
        let (along, across) = (
            slope[(0, 4 * ORIENTATIONS)],
            slope[(0, 4 * ORIENTATIONS + 2)],
        );
        assert!(along > 0.1 && across < 1e-3, "{along} {across}");
    }

    #[test]
    fn whitened_components_have_unit_deviation() {
        let mut rng = <ChaCha8Rng as rand::SeedableRng>::seed_from_u64(3);
        let rows = Array2::from_shape_simple_fn((4000, 30), || crate::align::normal(&mut rng));
        let mixed = &rows * &Array1::from_shape_fn(30, |i| 1.0 + i as f32);
        let filters = whitening(&mixed);
        let out = mixed.dot(&filters.weights) + &filters.bias;
        for column in out.columns() {
            assert!((column.std(0.0) - 1.0).abs() < 0.01 && column.mean().unwrap().abs() < 0.01);
        }
    }
}
