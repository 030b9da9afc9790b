//! A face as a stage sees it, and the raw local features of that: patches and gradient histograms.

use ndarray::Array2;
use posewise::align::Shape;
use posewise::image::{Crop, Frame, warp};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use posewise_train::faces::Face;

/// Side of the patches that filters see \[crop px\].
pub const PATCH: usize = 16;
/// What crops cover, in canonical units; a face's box is 64 wide.
const COVER: f32 = 96.0;
/// Orientations of a gradient histogram.
const ORIENTATIONS: usize = 8;

/// A face as a stage sees it, upright and in its size, by the shape that is to be corrected.
pub struct FaceCrop {
    /// Row-major luma.
    pub crop: Vec<f32>,
    /// Side of the crop.
    pub side: usize,
    /// The shape in crop px.
    pub points: Shape,
}

impl FaceCrop {
    /// The crop of a face, `step` canonical units a px.
    pub fn at(face: &Face, mean: &Shape, shape: &Shape, step: f32) -> FaceCrop {
        FaceCrop::of_frame(&face.picture.frame(), mean, shape, step)
    }

    /// The same of a frame.
    pub fn of_frame(frame: &Frame<'_>, mean: &Shape, shape: &Shape, step: f32) -> FaceCrop {
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
        warp(frame, &to_frame, side, &mut crop);
        let back = to_frame.inverse().expect("a shape has extent");
        FaceCrop {
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
    pub fn histograms(&self, distance: f32, side: f32) -> Array2<f32> {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn crop(luma: impl Fn(usize, usize) -> f32) -> FaceCrop {
        let side = 64;
        FaceCrop {
            crop: (0..side * side).map(|k| luma(k % side, k / side)).collect(),
            side,
            points: [[31.5; 2]; LANDMARKS],
        }
    }

    #[test]
    fn histograms_of_a_constant_patch_are_zero() {
        let flat = crop(|_, _| 93.0).histograms(8.0, 13.0);
        assert!(flat.iter().all(|v| *v == 0.0));
    }

    #[test]
    fn histograms_show_the_direction_of_a_slope() {
        let slope = crop(|x, _| 3.0 * x as f32).histograms(8.0, 13.0);
        let (along, across) = (
            slope[(0, 4 * ORIENTATIONS)],
            slope[(0, 4 * ORIENTATIONS + 2)],
        );
        assert!(along > 0.1 && across < 1e-3, "{along} {across}");
    }
}
