//! Moves landmarks to where the templates respond, alone or under a model of shapes.

use super::descriptor::{Patches, Placement};
use super::svm::{Bank, REACH};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use posewise::align::{AlignModel, Shape};
use posewise::shape::LANDMARKS;
use posewise_train::align::mean_aligned;
use posewise_train::faces::{Face, Picture};

/// Modes of the shape model.
const MODES: usize = 40;
/// Variance of the mean shift's kernel \[px²\].
const KERNEL: f32 = 4.0;
/// Rounds of the constrained fit.
const ROUNDS: usize = 3;
const COORDINATES: usize = 2 * LANDMARKS;

/// Principal modes of shapes in the canonical frame, and the four of similarities.
pub struct ShapeModes {
    /// Columns.
    basis: DMatrix<f32>,
    /// What a mode's squared weight costs: nothing for similarities.
    cost: Vec<f32>,
}

impl ShapeModes {
    /// Of labelled faces and their mirror images.
    pub fn fit(mean: &Shape, faces: &[Face]) -> ShapeModes {
        let mut covariance = DMatrix::<f32>::zeros(COORDINATES, COORDINATES);
        for face in faces {
            for shape in [face.landmarks, face.mirrored().landmarks] {
                let off = mean_aligned(&shape, mean).into_iter().zip(mean);
                let off: Vec<f32> = off.flat_map(|(p, m)| [p[0] - m[0], p[1] - m[1]]).collect();
                let off = DVector::from_vec(off);
                covariance.ger(0.5 / faces.len() as f32, &off, &off, 1.0);
            }
        }
        let eigen = SymmetricEigen::new(covariance);
        let mut order: Vec<usize> = (0..COORDINATES).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let n = (LANDMARKS as f32).sqrt();
        let mut columns: Vec<DVector<f32>> = vec![
            DVector::from_fn(COORDINATES, |i, _| f32::from(i % 2 == 0) / n),
            DVector::from_fn(COORDINATES, |i, _| f32::from(i % 2 == 1) / n),
            DVector::from_fn(COORDINATES, |i, _| mean[i / 2][i % 2]).normalize(),
            DVector::from_fn(COORDINATES, |i, _| match i % 2 {
                0 => -mean[i / 2][1],
                _ => mean[i / 2][0],
            })
            .normalize(),
        ];
        let mut cost = vec![0.0; columns.len()];
        for &k in order.iter().take(MODES) {
            columns.push(eigen.eigenvectors.column(k).into_owned());
            cost.push(1.0 / eigen.eigenvalues[k].max(1e-3));
        }
        ShapeModes {
            basis: DMatrix::from_columns(&columns),
            cost,
        }
    }

    /// The change of shape that comes nearest to the wanted shifts, each with a weight.
    fn project(&self, shifts: &[[f32; 2]], weights: &[f32]) -> Vec<[f32; 2]> {
        let wanted = DVector::from_iterator(COORDINATES, shifts.iter().flatten().copied());
        let weighted = DMatrix::from_fn(self.basis.nrows(), self.basis.ncols(), |r, c| {
            self.basis[(r, c)] * weights[r / 2]
        });
        let mut normal = self.basis.tr_mul(&weighted);
        for (k, cost) in self.cost.iter().enumerate() {
            normal[(k, k)] += cost + 1e-4;
        }
        let right = weighted.tr_mul(&wanted);
        let solved = normal.cholesky().map(|c| c.solve(&right));
        let moved = solved.map(|modes| &self.basis * modes);
        let moved = moved.unwrap_or_else(|| DVector::zeros(COORDINATES));
        moved.as_slice().as_chunks::<2>().0.to_vec()
    }
}

/// A way to correct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correction {
    /// Each landmark to the highest response near it.
    Peak,
    /// Each by the mean shift of its response map.
    MeanShift,
    /// By the mean shifts, as far as a change of shape follows them (regularised landmark mean
    /// shift, Saragih et al., IJCV 2011), weighted by the responses.
    Regularised,
}

impl Correction {
    /// All, with their names.
    pub fn all() -> [(&'static str, Correction); 3] {
        [
            ("peak of the response", Correction::Peak),
            ("mean shift", Correction::MeanShift),
            ("regularised mean shift", Correction::Regularised),
        ]
    }

    /// Moves a shape by `strength` of the correction.
    pub fn apply(
        self,
        (model, bank, modes): (&AlignModel<'_>, &Bank, &ShapeModes),
        picture: &Picture,
        shape: &mut Shape,
        strength: f32,
    ) {
        let rounds = match self {
            Correction::Regularised => ROUNDS,
            _ => 1,
        };
        for _ in 0..rounds {
            let Some(placement) = Placement::of(model, shape) else {
                return;
            };
            let patches = Patches::cut(picture, &placement);
            let mut points = placement.points(shape);
            let (shifts, weights): (Vec<[f32; 2]>, Vec<f32>) = points
                .iter()
                .enumerate()
                .map(|(k, p)| self.shift(bank, &placement, k, &patches, *p))
                .unzip();
            let shifts = match self {
                Correction::Regularised => {
                    let units: Vec<[f32; 2]> = shifts
                        .iter()
                        .map(|s| s.map(|v| v * Placement::unit()))
                        .collect();
                    let moved = modes.project(&units, &weights);
                    moved
                        .iter()
                        .map(|s| s.map(|v| v / Placement::unit()))
                        .collect()
                }
                _ => shifts,
            };
            for (p, s) in points.iter_mut().zip(&shifts) {
                *p = [p[0] + strength * s[0], p[1] + strength * s[1]];
            }
            *shape = placement.shape(&points);
        }
    }

    /// Where one landmark's response map pulls it \[crop px\], and how much it is to be believed.
    pub fn shift(
        self,
        bank: &Bank,
        placement: &Placement,
        k: usize,
        patches: &Patches,
        p: [f32; 2],
    ) -> ([f32; 2], f32) {
        let offsets = (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| (x, y)));
        let map: Vec<([f32; 2], f32)> = offsets
            .map(|(x, y)| {
                // Patches are cut at whole px.
                let [x, y] = [p[0].floor() + 0.5 + x as f32, p[1].floor() + 0.5 + y as f32];
                let at = [x, y];
                let off = [at[0] - p[0], at[1] - p[1]];
                (off, bank.response(placement.view, k, patches, at))
            })
            .collect();
        let peak = map.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((best, height)) = peak.copied().filter(|(_, height)| *height > 0.0) else {
            return ([0.0; 2], 0.0);
        };
        if self == Correction::Peak {
            return (best, height);
        }
        let mut sum = [0.0f32; 3];
        for (off, response) in &map {
            let square = off[0] * off[0] + off[1] * off[1];
            let weight = response * (-0.5 * square / KERNEL).exp();
            sum = [
                sum[0] + weight * off[0],
                sum[1] + weight * off[1],
                sum[2] + weight,
            ];
        }
        let total = sum[2].max(1e-9);
        ([sum[0] / total, sum[1] / total], height)
    }
}
