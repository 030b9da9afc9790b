//! A face as a stage sees it, and the raw local features of that: patches and gradient histograms.

use super::filters::Filters;
use ndarray::{Array2, ArrayViewMut1};
use posewise::align::{Shape, mirror};
use posewise::image::{Crop, Frame, warp};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use posewise_train::faces::Face;

/// Side of the patches that filters see \[crop px\].
pub const PATCH: usize = 16;
/// What crops cover, in canonical units; a face's box is 64 wide.
const COVER: f32 = 96.0;
/// Side of the windows of filters that are pooled \[crop px\], and number of these filters.
pub const WINDOW: usize = 6;
pub const UNITS: usize = 16;
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
        let canonical = Similarity::fit(mean, shape).expect("a shape has extent");
        FaceCrop::placed(&face.picture.frame(), &canonical, shape, step)
    }

    /// The crop of a frame where `canonical` puts the canonical frame, `step` canonical units a px.
    pub fn placed(frame: &Frame<'_>, canonical: &Similarity, shape: &Shape, step: f32) -> FaceCrop {
        let side = (COVER / step).ceil() as usize;
        let corner = -(side as f32 - 1.0) / 2.0 * step;
        let to_frame = Similarity {
            a: step,
            b: 0.0,
            tx: corner,
            ty: corner,
        }
        .then(canonical);
        let mut crop = Crop::new();
        warp(frame, &to_frame, side, &mut crop);
        let back = to_frame.inverse().expect("a shape has extent");
        FaceCrop {
            crop: crop.luma().iter().map(|v| *v as f32).collect(),
            side,
            points: shape.map(|p| back.apply(p)),
        }
    }

    /// The face in a mirror.
    pub fn mirrored(mut self) -> FaceCrop {
        let last = self.side as f32 - 1.0;
        let rows = self.crop.chunks_exact_mut(self.side);
        rows.for_each(<[f32]>::reverse);
        self.points = mirror(&self.points).map(|[x, y]| [last + x, y]);
        self
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
            standardise(&mut row);
        }
        patches
    }

    /// Windows of [`WINDOW`] px at all places, a row each, of mean 0 and deviation 1 (less where
    /// there is no contrast).
    pub fn windows(&self) -> Array2<f32> {
        let places = self.places();
        let mut windows = Array2::zeros((places * places, WINDOW * WINDOW));
        for (place, mut row) in windows.rows_mut().into_iter().enumerate() {
            let (x, y) = (place % places, place / places);
            for (k, pixel) in row.iter_mut().enumerate() {
                *pixel = self.crop[(y + k / WINDOW) * self.side + x + k % WINDOW];
            }
            standardise(&mut row);
        }
        windows
    }

    /// Places of a window along a side.
    fn places(&self) -> usize {
        self.side + 1 - WINDOW
    }

    /// Outputs of [`UNITS`] filters on windows, pooled: 3×3 cells as those of the histograms, the
    /// root of each mean.
    pub fn pooled(&self, filters: &Filters, distance: f32, side: f32) -> Array2<f32> {
        let outputs = filters.of(&self.windows());
        let rows = outputs.rows().into_iter();
        let outputs: Vec<[f32; UNITS]> = rows.map(|row| std::array::from_fn(|o| row[o])).collect();
        let sums = Integral::of(&outputs, self.places());
        let middle = (WINDOW as f32 - 1.0) / 2.0;
        let points = self.points.map(|p| p.map(|v| v - middle));
        let mut out = Array2::zeros((LANDMARKS, 9 * UNITS));
        for (mut row, point) in out.rows_mut().into_iter().zip(points) {
            for cell in 0..9 {
                let sum = sums.cell(point, cell, distance, side);
                for (o, v) in sum.into_iter().enumerate() {
                    row[cell * UNITS + o] = (v / (side * side)).sqrt();
                }
            }
        }
        out
    }

    /// Gradient histograms: 3×3 cells, each the mean over a box; the root of each share.
    pub fn histograms(&self, distance: f32, side: f32) -> Array2<f32> {
        let sums = Integral::of(&gradients(&self.crop, self.side), self.side);
        let mut out = Array2::zeros((LANDMARKS, 9 * ORIENTATIONS));
        for (mut row, point) in out.rows_mut().into_iter().zip(self.points) {
            for cell in 0..9 {
                let sum = sums.cell(point, cell, distance, side);
                for (o, v) in sum.into_iter().enumerate() {
                    row[cell * ORIENTATIONS + o] = v;
                }
            }
            // One grey level per px in each cell, so that noise alone is not a feature.
            let total = row.sum() + 9.0 * side * side;
            row.mapv_inplace(|v| (v / total).sqrt());
        }
        out
    }
}

/// Makes the mean 0 and the deviation 1, less where there is no contrast.
fn standardise(row: &mut ArrayViewMut1<'_, f32>) {
    let mean = row.mean().expect("a patch has pixels");
    *row -= mean;
    let deviation = (row.dot(row) / row.len() as f32).sqrt();
    *row /= deviation + 4.0;
}

/// Length of the gradient of each px by orientation.
fn gradients(luma: &[f32], side: usize) -> Vec<[f32; ORIENTATIONS]> {
    let at = |x: usize, y: usize| luma[y * side + x];
    let gradient = |k: usize| {
        let (x, y) = (k % side, k / side);
        let dx = (at((x + 1).min(side - 1), y) - at(x.saturating_sub(1), y)) / 2.0;
        let dy = (at(x, (y + 1).min(side - 1)) - at(x, y.saturating_sub(1))) / 2.0;
        let turn = dy.atan2(dx) / std::f32::consts::TAU;
        let bin = turn.rem_euclid(1.0) * ORIENTATIONS as f32;
        let (low, share) = (bin as usize % ORIENTATIONS, bin.fract());
        let length = dx.hypot(dy);
        let mut lengths = [0.0; ORIENTATIONS];
        lengths[low] = length * (1.0 - share);
        lengths[(low + 1) % ORIENTATIONS] += length * share;
        lengths
    };
    (0..side * side).map(gradient).collect()
}

/// Sums of what each px has over all px above and to the left.
struct Integral<const N: usize> {
    sums: Vec<[f32; N]>,
    side: usize,
}

impl<const N: usize> Integral<N> {
    fn of(values: &[[f32; N]], side: usize) -> Integral<N> {
        let width = side + 1;
        let mut sums = vec![[0.0; N]; width * width];
        for y in 0..side {
            let mut row = [0.0; N];
            for x in 0..side {
                let here = &values[y * side + x];
                row.iter_mut().zip(here).for_each(|(r, v)| *r += v);
                let above = sums[y * width + x + 1];
                sums[(y + 1) * width + x + 1] = std::array::from_fn(|o| row[o] + above[o]);
            }
        }
        Integral { sums, side }
    }

    /// The sum over one of 3×3 cells around a point.
    fn cell(&self, [x, y]: [f32; 2], cell: usize, distance: f32, side: f32) -> [f32; N] {
        let x = x + (cell % 3) as f32 * distance - distance - side / 2.0 + 0.5;
        let y = y + (cell / 3) as f32 * distance - distance - side / 2.0 + 0.5;
        let [a, b] = [self.at(x, y), self.at(x + side, y)];
        let [c, d] = [self.at(x, y + side), self.at(x + side, y + side)];
        std::array::from_fn(|o| (a[o] + d[o] - b[o] - c[o]).max(0.0))
    }

    /// The sum up to a place between px.
    fn at(&self, x: f32, y: f32) -> [f32; N] {
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

    #[test]
    fn a_mirror_image_is_seen_as_the_face_that_it_shows() {
        let face = crop(|x, y| (3 * x + (x * y) % 7) as f32);
        let mirrored = crop(|x, y| (3 * (63 - x) + ((63 - x) * y) % 7) as f32);
        assert_eq!(face.mirrored().crop, mirrored.crop);
    }

    #[test]
    fn pooled_filters_are_means_over_cells() {
        let filters = Filters {
            weights: Array2::zeros((WINDOW * WINDOW, UNITS)),
            bias: ndarray::Array1::zeros(UNITS),
        };
        let pooled = crop(|x, _| 3.0 * x as f32).pooled(&filters, 6.0, 8.0);
        // The probability of a unit without weights is one half.
        let half = 0.5f32.sqrt();
        assert!(pooled.iter().all(|v| (v - half).abs() < 1e-3));
    }
}
