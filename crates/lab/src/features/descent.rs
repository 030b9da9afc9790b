//! Supervised descent on gradient histograms (Xiong and De la Torre 2013) with the settings of the
//! aligner that the thesis' author published: github.com/tntrung/sdm_face_alignment. Only numbers
//! are taken from there.

use super::canvas::{Canvas, NUMBERS, Place};
use super::regression::COORDINATES;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use posewise::align::Shape;
use posewise::image::Frame;
use posewise::shape::LANDMARKS;
use posewise_metrics::landmarks::bounds;
use posewise_train::faces::Face;
use rayon::prelude::*;

/// Regressions of a cascade.
const STAGES: usize = 5;
/// What |w|² weighs against the sum of squared errors: 1 / (2 C) with the cost C = 0.005 that the
/// author gives to a linear support vector regression without a margin, which is a ridge.
const RIDGE: f32 = 100.0;

/// A shape stretched so that its box is that of another one.
pub fn stretched(shape: &Shape, to: &Shape) -> Shape {
    let (from, to) = (bounds(shape), bounds(to));
    let scale = [0, 1].map(|k| (to[k + 2] - to[k]) / (from[k + 2] - from[k]));
    shape.map(|p| [0, 1].map(|k| (p[k] - from[k]) * scale[k] + to[k]))
}

/// A cascade of regressions without constants: weights by stage, a row per number of a histogram, a
/// column per coordinate, in widths and heights of the shape's box.
pub struct Descent {
    stages: Vec<Mat<f32>>,
}

impl Descent {
    /// Trains on faces with a start each \[frame px\]. The canvas is placed around the start.
    pub fn train(samples: &[(&Face, Shape)]) -> Descent {
        let places: Vec<Place> = samples.iter().map(|(_, s)| Place::around(s)).collect();
        let of = |shape: fn(&(&Face, Shape)) -> Shape| -> Vec<Shape> {
            let pairs = samples.iter().zip(&places);
            pairs.map(|(s, place)| place.inward(&shape(s))).collect()
        };
        let (mut shapes, truths) = (of(|s| s.1), of(|s| s.0.landmarks));
        let stages = (0..STAGES).map(|index| {
            let began = std::time::Instant::now();
            let rows: Vec<Vec<f32>> = (samples.par_iter().zip(&places).zip(&shapes))
                .map(|(((face, _), place), shape)| {
                    Canvas::new(&face.picture.frame(), place).histograms(shape)
                })
                .collect();
            let features = Mat::from_fn(rows.len(), LANDMARKS * NUMBERS, |n, i| rows[n][i]);
            let targets: Vec<[f32; COORDINATES]> = (shapes.iter().zip(&truths))
                .map(|(shape, truth)| {
                    let size = size_of(shape);
                    std::array::from_fn(|k| {
                        (truth[k / 2][k % 2] - shape[k / 2][k % 2]) / size[k % 2]
                    })
                })
                .collect();
            let targets = Mat::from_fn(targets.len(), COORDINATES, |n, k| targets[n][k]);
            let weights = ridge(&features, &targets);
            let moves = &features * &weights;
            for (n, shape) in shapes.iter_mut().enumerate() {
                *shape = moved(shape, |k| moves[(n, k)]);
            }
            eprintln!("    stage {}: {:.0?}", index + 1, began.elapsed());
            weights
        });
        Descent {
            stages: stages.collect(),
        }
    }

    /// The shape in a frame, from one near it.
    pub fn run(&self, frame: &Frame<'_>, start: &Shape) -> Shape {
        let place = Place::around(start);
        let canvas = Canvas::new(frame, &place);
        let mut shape = place.inward(start);
        for weights in &self.stages {
            let features = canvas.histograms(&shape);
            let step = |k: usize| -> f32 {
                let pairs = weights.col(k).iter().zip(&features);
                pairs.map(|(w, x)| w * x).sum()
            };
            shape = moved(&shape, step);
        }
        place.outward(&shape)
    }
}

/// Width and height of a shape's box.
fn size_of(shape: &Shape) -> [f32; 2] {
    let [left, top, right, bottom] = bounds(shape);
    [right - left, bottom - top]
}

/// A shape after a step, by coordinate, in parts of its box.
fn moved(shape: &Shape, step: impl Fn(usize) -> f32) -> Shape {
    let size = size_of(shape);
    let at = |i: usize, k: usize| shape[i][k] + step(2 * i + k) * size[k];
    std::array::from_fn(|i| [at(i, 0), at(i, 1)])
}

/// Weights that minimise the squared error plus [`RIDGE`]·|w|², by the samples' products: there
/// are fewer samples than features.
fn ridge(features: &Mat<f32>, targets: &Mat<f32>) -> Mat<f32> {
    let mut products = features * features.transpose();
    for n in 0..products.nrows() {
        products[(n, n)] += RIDGE;
    }
    let solver = products.llt(Side::Lower).expect("a ridge is positive");
    features.transpose() * solver.solve(targets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise_train::faces::Picture;

    /// A face of dark dots where its landmarks are, `at` px from the middle.
    fn dots(at: [f32; 2]) -> Face {
        let mut luma = vec![200u8; 160 * 160];
        let landmarks: Shape = std::array::from_fn(|i| {
            let (angle, radius) = (i as f32 * 0.37, 8.0 + 0.5 * i as f32);
            let [x, y] = [angle.cos(), angle.sin()].map(|v| 80.0 + radius * v);
            [x + at[0], y + at[1]]
        });
        for [x, y] in landmarks {
            for (v, u) in (0..9).map(|k| (k / 3, k % 3)) {
                luma[(y.round() as usize + v - 1) * 160 + x.round() as usize + u - 1] = 40;
            }
        }
        let size = [160; 2];
        Face::new(Picture { size, luma }, landmarks)
    }

    #[test]
    fn moves_starts_closer() {
        let faces: Vec<Face> = (0..40)
            .map(|k| dots([(k % 7) as f32 - 3.0, (k % 5) as f32 - 2.0]))
            .collect();
        let start = dots([0.0; 2]).landmarks;
        let samples: Vec<(&Face, Shape)> = faces[..35].iter().map(|f| (f, start)).collect();
        let descent = Descent::train(&samples);
        for face in &faces[35..] {
            let found = descent.run(&face.picture.frame(), &start);
            let off = |shape: &Shape| (shape[0][0] - face.landmarks[0][0]).abs();
            assert!(
                off(&found) < 0.5f32.max(0.5 * off(&start)),
                "{}",
                off(&found)
            );
        }
    }

    #[test]
    fn stretching_meets_the_other_box() {
        let (a, b) = (dots([0.0; 2]).landmarks, dots([5.0, -3.0]).landmarks);
        let wide = b.map(|[x, y]| [3.0 * x, y]);
        let found = bounds(&stretched(&a, &wide));
        let pairs = found.iter().zip(bounds(&wide));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-3));
    }
}
