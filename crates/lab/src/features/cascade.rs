//! A small linear cascade: training and evaluation.

use super::crop::FaceCrop;
use super::filters::principal;
use super::local::{Features, Kind};
use super::regression::{
    COORDINATES, INPUTS, Linear, Links, Normal, RIDGES, best_ridge, sets, solve,
};
use faer::Mat;
use posewise::align::Shape;
use posewise::image::Frame;
use posewise::math::Similarity;
use posewise_train::align::evaluate::{Accuracy, Boxes, nme};
use posewise_train::align::{StartShapes, jittered_box, mean_shape, start_from_box};
use posewise_train::faces::Face;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Stages of a cascade.
pub const STAGES: usize = 4;
/// Folds of people for predictions on faces that were not trained on.
const FOLDS: usize = 4;
/// Modes of shape that predictions may use beside similarity.
const SHAPE_MODES: usize = 60;
/// Crops that features are trained on.
const CROPS: usize = 400;

/// One regression on features.
struct Stage {
    features: Features,
    weights: Linear,
}

/// Training faces with a shape on each: where the stages so far have brought it.
#[derive(Clone)]
pub struct Training<'a> {
    faces: &'a [Face],
    /// Index of the face, shape.
    samples: Vec<(usize, Shape)>,
    mean: Shape,
    /// Directions that predictions may take, in columns: similarity and shape modes.
    basis: Mat<f32>,
    seed: u64,
}

impl<'a> Training<'a> {
    /// Starts on faces from boxes around them; renders have half as many.
    pub fn new(faces: &'a [Face], starts: &StartShapes, boxes: &Boxes, seed: u64) -> Self {
        let mean = mean_shape(faces);
        let samples = (0..faces.len())
            .flat_map(|f| {
                let count = match faces[f].yaw_deg {
                    None => boxes.count,
                    Some(_) => boxes.count.div_ceil(2),
                };
                let shapes = starts_on(&faces[f], starts, &Boxes { count, ..*boxes }, seed, f);
                shapes.into_iter().map(move |shape| (f, shape))
            })
            .collect();
        Training {
            faces,
            samples,
            mean,
            basis: basis(faces, &mean),
            seed,
        }
    }

    /// Starts in all.
    pub fn samples(&self) -> usize {
        self.samples.len()
    }

    fn face(&self, sample: usize) -> &'a Face {
        &self.faces[self.samples[sample].0]
    }

    fn crop(&self, sample: usize, step: f32) -> FaceCrop {
        FaceCrop::at(self.face(sample), &self.mean, &self.samples[sample].1, step)
    }

    /// Where the landmarks should go, in canonical units.
    fn target(&self, sample: usize) -> Vec<f32> {
        let (face, shape) = (self.face(sample), &self.samples[sample].1);
        let canonical = Similarity::fit(&self.mean, shape).expect("a shape has extent");
        let back = canonical.inverse().expect("a shape has extent");
        let pairs = face.landmarks.iter().zip(shape);
        pairs
            .flat_map(|(to, from)| {
                let (to, from) = (back.apply(*to), back.apply(*from));
                [to[0] - from[0], to[1] - from[1]]
            })
            .collect()
    }

    fn fold(&self, sample: usize) -> usize {
        self.face(sample).person as usize % FOLDS
    }

    /// Products of features and targets by fold; the features beside them.
    fn normals(&self, features: &Features) -> (Vec<Vec<f32>>, Vec<Normal>) {
        let samples = (0..self.samples.len()).into_par_iter();
        let x: Vec<Vec<f32>> = samples
            .map(|n| features.of(&self.crop(n, features.step)))
            .collect();
        let y: Vec<Vec<f32>> = (0..x.len()).map(|n| self.target(n)).collect();
        let normals = (0..FOLDS).into_par_iter().map(|fold| {
            let of: Vec<_> = (0..x.len()).filter(|n| self.fold(*n) == fold).collect();
            let mut normal = Normal::new(INPUTS, COORDINATES);
            for block in of.chunks(1024) {
                let rows = block
                    .iter()
                    .map(|n| (&x[*n][..], &y[*n][..], self.face(*n).weight));
                normal.add(&rows.collect::<Vec<_>>());
            }
            normal
        });
        let normals = normals.collect();
        (x, normals)
    }

    /// Trains one stage and moves the shapes by its out-of-fold predictions.
    fn stage(&mut self, kind: Kind, links: Links, index: usize) -> Stage {
        let began = std::time::Instant::now();
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ ((index as u64) << 32));
        let mut drawn = || rng.random_range(0..self.samples.len());
        let crops: Vec<FaceCrop> = (0..CROPS)
            .map(|_| self.crop(drawn(), kind.step(index)))
            .collect();
        let features = Features::fit(kind, index, &crops, &mut rng);
        let empty = || Normal::new(INPUTS, COORDINATES);
        let sum = |normals: &[Normal], but: usize| {
            let others = (0..FOLDS).filter(|f| *f != but);
            others.fold(empty(), |sum, f| sum.merge(&normals[f]))
        };
        let (x, normals) = self.normals(&features);
        let train = sum(&normals, 0);
        let sets = sets(links, &train, &normals[0]);
        let ridge = best_ridge(&RIDGES, &sets, &train, &normals[0]);
        for fold in 0..FOLDS {
            let weights = solve(&sum(&normals, fold), &sets, ridge).within(&self.basis);
            let of: Vec<usize> = (0..x.len()).filter(|n| self.fold(*n) == fold).collect();
            let moved: Vec<Shape> = of
                .par_iter()
                .map(|n| moved(&self.mean, &self.samples[*n].1, &weights, &x[*n]))
                .collect();
            for (n, shape) in of.into_iter().zip(moved) {
                self.samples[n].1 = shape;
            }
        }
        let errors = self
            .samples
            .iter()
            .map(|(f, shape)| nme(&self.faces[*f], shape, 0));
        eprintln!(
            "    stage {}: {:.2} % out of fold, ridge {ridge}, {:.0?}",
            index + 1,
            errors.sum::<f32>() / self.samples.len() as f32,
            began.elapsed()
        );
        Stage {
            weights: solve(&sum(&normals, FOLDS), &sets, ridge).within(&self.basis),
            features,
        }
    }
}

/// The shape after one step.
fn moved(mean: &Shape, shape: &Shape, weights: &Linear, x: &[f32]) -> Shape {
    let canonical = Similarity::fit(mean, shape).expect("a shape has extent");
    let prediction = weights.of(x);
    std::array::from_fn(|i| {
        let [dx, dy] = canonical.apply_vector([prediction[2 * i], prediction[2 * i + 1]]);
        [shape[i][0] + dx, shape[i][1] + dy]
    })
}

/// Starts on a face, as [`posewise_train::align::evaluate`] draws them.
pub(super) fn starts_on(
    face: &Face,
    starts: &StartShapes,
    boxes: &Boxes,
    seed: u64,
    index: usize,
) -> Vec<Shape> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index as u64);
    (0..boxes.count)
        .map(|_| {
            let views = starts.views();
            let (at, size, roll) = jittered_box(&views, &face.landmarks, &boxes.jitter, &mut rng);
            let turn = face.turn() + 0.2 * rng.random_range(-1.0f32..1.0);
            let start = views.initial_shape(turn).expect("there is a start shape");
            start_from_box(&start, at, size, roll)
        })
        .collect()
}

/// Orthonormal directions of similarity and of the largest variation of shapes.
fn basis(faces: &[Face], mean: &Shape) -> Mat<f32> {
    let spread = |map: fn([f32; 2]) -> [f32; 2]| -> Vec<f64> {
        let flat = mean.iter().flat_map(|p| map(*p)).map(f64::from);
        let flat: Vec<f64> = flat.collect();
        let norm = flat.iter().map(|v| v * v).sum::<f64>().sqrt();
        flat.iter().map(|v| v / norm).collect()
    };
    let mut columns = vec![
        spread(|p| p),
        spread(|[x, y]| [-y, x]),
        spread(|_| [1.0, 0.0]),
        spread(|_| [0.0, 1.0]),
    ];
    let rows: Vec<Vec<f64>> = faces
        .iter()
        .map(|face| {
            let aligned = Similarity::fit(&face.landmarks, mean).expect("a face has extent");
            let points = face.landmarks.iter().zip(mean);
            let mut row: Vec<f64> = points
                .flat_map(|(p, m)| {
                    let p = aligned.apply(*p);
                    [(p[0] - m[0]) as f64, (p[1] - m[1]) as f64]
                })
                .collect();
            for column in &columns {
                let along: f64 = row.iter().zip(column).map(|(a, b)| a * b).sum();
                row.iter_mut()
                    .zip(column)
                    .for_each(|(v, c)| *v -= along * c);
            }
            row
        })
        .collect();
    let a = Mat::from_fn(COORDINATES, rows.len(), |i, n| {
        rows[n][i] * (faces[n].weight as f64).sqrt()
    });
    let (_, vectors) = principal(&(&a * a.transpose()));
    columns.extend((0..SHAPE_MODES).map(|m| (0..COORDINATES).map(|i| vectors[(i, m)]).collect()));
    Mat::from_fn(COORDINATES, columns.len(), |i, c| columns[c][i] as f32)
}

/// A trained cascade.
pub struct Cascade {
    mean: Shape,
    stages: Vec<Stage>,
}

impl Cascade {
    /// Trains all stages; the last two use the links `late`.
    pub fn train(mut training: Training<'_>, kind: Kind, late: Links) -> Cascade {
        let stages = (0..STAGES)
            .map(|index| {
                let links = if index + 2 < STAGES {
                    Links::Global
                } else {
                    late
                };
                training.stage(kind, links, index)
            })
            .collect();
        Cascade {
            mean: training.mean,
            stages,
        }
    }

    /// The shape in a frame, from one near it. `None` if the shape has no extent.
    pub fn run(&self, frame: &Frame<'_>, mut shape: Shape) -> Option<Shape> {
        for stage in &self.stages {
            let canonical = Similarity::fit(&self.mean, &shape)?;
            canonical.inverse()?;
            let crop = FaceCrop::placed(frame, &canonical, &shape, stage.features.step);
            let x = stage.features.of(&crop);
            shape = moved(&self.mean, &shape, &stage.weights, &x);
        }
        shape
            .iter()
            .flatten()
            .all(|v| v.is_finite())
            .then_some(shape)
    }

    /// Errors on faces from boxes.
    pub fn evaluate(&self, faces: &[Face], starts: &StartShapes, boxes: &Boxes) -> Accuracy {
        let rows: Vec<_> = faces
            .par_iter()
            .enumerate()
            .flat_map_iter(|(index, face)| {
                let shapes = starts_on(face, starts, boxes, 7, index);
                shapes.into_iter().map(move |mut shape| {
                    for stage in &self.stages {
                        let crop = FaceCrop::at(face, &self.mean, &shape, stage.features.step);
                        let x = stage.features.of(&crop);
                        shape = moved(&self.mean, &shape, &stage.weights, &x);
                    }
                    (shape, nme(face, &shape, 0), nme(face, &shape, 17))
                })
            })
            .collect();
        Accuracy::of(&rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise_metrics::BoxJitter;
    use posewise_train::faces::Picture;

    /// A face of dark dots where its landmarks are.
    fn dots(person: u32, rng: &mut ChaCha8Rng) -> Face {
        let mut luma = vec![200u8; 128 * 128];
        let landmarks: Shape = std::array::from_fn(|i| {
            let angle = i as f32 * 0.37;
            let radius = 8.0 + 0.5 * i as f32;
            let [x, y] = [angle.cos(), angle.sin()].map(|v| 64.0 + radius * v);
            [x, y].map(|v| v + rng.random_range(-1.0..1.0f32))
        });
        for [x, y] in landmarks {
            for (v, u) in (0..9).map(|k| (k / 3, k % 3)) {
                let at = (y.round() as usize + v - 1) * 128 + x.round() as usize + u - 1;
                luma[at] = 40;
            }
        }
        let size = [128; 2];
        Face {
            person,
            yaw_deg: Some(0.0),
            is_render: true,
            has_exact_lids: true,
            ..Face::new(Picture { size, luma }, landmarks)
        }
    }

    #[test]
    fn a_stage_moves_starts_closer() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let faces: Vec<Face> = (0..60).map(|p| dots(p, &mut rng)).collect();
        let boxes = Boxes {
            jitter: BoxJitter {
                shift: 0.05,
                log_size: 0.05,
                roll: 0.05,
            },
            count: 4,
        };
        let starts = StartShapes::fit(&faces, &mean_shape(&faces), &[0.0]);
        let mut training = Training::new(&faces[..50], &starts, &boxes, 1);
        let mut cascade = Cascade {
            mean: training.mean,
            stages: vec![],
        };
        let before = cascade.evaluate(&faces[50..], &starts, &boxes);
        cascade
            .stages
            .push(training.stage(Kind::Hog, Links::Global, 0));
        let after = cascade.evaluate(&faces[50..], &starts, &boxes);
        assert!(after.nme68 < 0.6 * before.nme68, "{before:?} {after:?}");
    }
}
