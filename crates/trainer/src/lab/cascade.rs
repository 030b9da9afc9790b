//! Cascades of ridge regressions on local features, each stage trained on what the stages before
//! it answer for people that they were not trained on.

use super::features::{Features, Kind, Look, OUTPUTS, principal};
use super::rbm;
use crate::align::{Accuracy, Boxes, StartShapes};
use crate::align::{evaluate::nme, jittered_box, mean_shape, start_from_box};
use crate::faces::Face;
use crate::ridge;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use ndarray::Array1;
use posewise::align::Shape;
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::ops::Range;

/// Stages of a cascade.
pub const STAGES: usize = 4;
const FOLDS: usize = 4;
const SHAPE_MODES: usize = 60;
const COORDINATES: usize = 2 * LANDMARKS;
const INPUTS: usize = LANDMARKS * OUTPUTS;
/// Weights of |w|² in the ridge, of which each stage takes the best on a fold.
const RIDGES: [f32; 6] = [3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0];
/// Looks that features are learnt from, and samples that they are refined on.
const LOOKS: usize = 400;
const REFINED_ON: usize = 5000;

/// What a landmark's displacement is predicted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Links {
    /// All landmarks' features.
    Global,
    /// Its own features.
    Own,
    /// Its own and those of the landmarks that help most beside them, on a fold; so many in all.
    Best(usize),
}

/// Sums over samples of products of features (a constant 1 among them) and displacements.
pub struct Normal {
    xx: Mat<f32>,
    xy: Mat<f32>,
    yy: Vec<f64>,
    weight: f64,
}

/// Features that predict some of the outputs.
type Set = (Vec<usize>, Range<usize>);

impl Normal {
    fn new(inputs: usize, outputs: usize) -> Normal {
        Normal {
            xx: Mat::zeros(inputs + 1, inputs + 1),
            xy: Mat::zeros(inputs + 1, outputs),
            yy: vec![0.0; outputs],
            weight: 0.0,
        }
    }

    fn merge(mut self, other: &Normal) -> Normal {
        self.xx += &other.xx;
        self.xy += &other.xy;
        self.yy.iter_mut().zip(&other.yy).for_each(|(a, b)| *a += b);
        self.weight += other.weight;
        self
    }

    /// Adds samples: features, displacements, weight.
    fn add(&mut self, samples: &[(&[f32], &[f32], f32)]) {
        let inputs = self.xx.nrows() - 1;
        let a = Mat::from_fn(inputs + 1, samples.len(), |i, n| {
            let (x, _, w) = samples[n];
            w.sqrt() * x.get(i).unwrap_or(&1.0)
        });
        let b = Mat::from_fn(samples.len(), self.yy.len(), |n, o| {
            samples[n].1[o] * samples[n].2.sqrt()
        });
        ridge::accumulate(&mut self.xx, &mut self.xy, &a, &b);
        for (_, y, w) in samples {
            let squares = y.iter().map(|v| (v * v * w) as f64);
            self.yy.iter_mut().zip(squares).for_each(|(s, v)| *s += v);
            self.weight += *w as f64;
        }
    }

    fn products(&self, inputs: &[usize]) -> Mat<f64> {
        Mat::from_fn(inputs.len(), inputs.len(), |i, j| {
            let (i, j) = (inputs[i], inputs[j]);
            self.xx[(i.max(j), i.min(j))] as f64
        })
    }

    /// Weights of one set that minimise mean squared error plus `ridge`·|w|², the bias last.
    fn solve(&self, (inputs, outputs): &Set, ridge: f32) -> Mat<f64> {
        let mut xx = self.products(inputs);
        for i in 0..inputs.len() - 1 {
            xx[(i, i)] += ridge as f64 * self.weight;
        }
        let xy = Mat::from_fn(inputs.len(), outputs.len(), |i, o| {
            self.xy[(inputs[i], outputs.start + o)] as f64
        });
        xx.llt(Side::Lower).expect("a ridge is positive").solve(&xy)
    }

    /// Squared error of such weights, summed over the outputs, mean over the samples.
    fn error(&self, (inputs, outputs): &Set, weights: &Mat<f64>) -> f64 {
        let product = self.products(inputs) * weights;
        let mut sum: f64 = self.yy[outputs.clone()].iter().sum();
        for o in 0..outputs.len() {
            for (i, input) in inputs.iter().enumerate() {
                let xy = self.xy[(*input, outputs.start + o)] as f64;
                sum += weights[(i, o)] * (product[(i, o)] - 2.0 * xy);
            }
        }
        sum / self.weight
    }
}

/// The features that predict each output.
fn sets(links: Links, train: &Normal, held: &Normal) -> Vec<Set> {
    let of = |landmarks: &[usize], j: usize| -> Set {
        let inputs = landmarks
            .iter()
            .flat_map(|l| l * OUTPUTS..(l + 1) * OUTPUTS);
        (inputs.chain([INPUTS]).collect(), 2 * j..2 * j + 2)
    };
    let each = (0..LANDMARKS).into_par_iter();
    match links {
        Links::Global => vec![((0..=INPUTS).collect(), 0..COORDINATES)],
        Links::Own => each.map(|j| of(&[j], j)).collect(),
        Links::Best(count) => each
            .map(|j| {
                let mut others: Vec<(f64, usize)> = (0..LANDMARKS)
                    .filter(|i| *i != j)
                    .map(|i| {
                        let set = of(&[j, i], j);
                        (held.error(&set, &train.solve(&set, RIDGES[1])), i)
                    })
                    .collect();
                others.sort_by(|a, b| a.0.total_cmp(&b.0));
                let best = others.iter().take(count - 1).map(|(_, i)| *i);
                of(&[j].into_iter().chain(best).collect::<Vec<_>>(), j)
            })
            .collect(),
    }
}

/// The weight of |w|² that leaves the smallest error on what was held out.
fn best_ridge(sets: &[Set], train: &Normal, held: &Normal) -> f32 {
    let error = |ridge: f32| -> f64 {
        let each = sets.par_iter();
        each.map(|set| held.error(set, &train.solve(set, ridge)))
            .sum()
    };
    let errors = RIDGES.map(|ridge| (error(ridge), ridge));
    let best = errors.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    best.expect("there are ridges").1
}

/// Weights of all sets in one matrix, its answers projected on `basis`.
fn solve(normal: &Normal, sets: &[Set], ridge: f32, basis: &Mat<f32>) -> Mat<f32> {
    let mut all = Mat::<f32>::zeros(INPUTS + 1, COORDINATES);
    let solved: Vec<_> = sets.par_iter().map(|s| normal.solve(s, ridge)).collect();
    for ((inputs, outputs), weights) in sets.iter().zip(&solved) {
        for (o, output) in outputs.clone().enumerate() {
            for (i, input) in inputs.iter().enumerate() {
                all[(*input, output)] = weights[(i, o)] as f32;
            }
        }
    }
    (&all * basis) * basis.transpose()
}

/// One regression on features.
struct Stage {
    features: Features,
    weights: Mat<f32>,
}

/// Training faces with a shape on each: where the stages so far have brought it.
#[derive(Clone)]
pub struct Training<'a> {
    faces: &'a [Face],
    /// Index of the face, shape.
    samples: Vec<(usize, Shape)>,
    mean: Shape,
    starts: &'a StartShapes,
    /// Directions that answers may take, in columns: similarity and shape modes.
    basis: Mat<f32>,
    seed: u64,
}

impl<'a> Training<'a> {
    /// Starts on faces from boxes around them; renders have half as many.
    pub fn new(faces: &'a [Face], starts: &'a StartShapes, boxes: &Boxes, seed: u64) -> Self {
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
            starts,
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

    fn look(&self, sample: usize, step: f32) -> Look {
        Look::at(self.face(sample), &self.mean, &self.samples[sample].1, step)
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
            .map(|n| features.of(&self.look(n, features.step)))
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

    /// Trains one stage and moves the shapes by its out-of-fold answers.
    fn stage(&mut self, kind: Kind, links: Links, index: usize) -> Stage {
        let began = std::time::Instant::now();
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ ((index as u64) << 32));
        let mut drawn = || rng.random_range(0..self.samples.len());
        let looks: Vec<Look> = (0..LOOKS)
            .map(|_| self.look(drawn(), kind.step(index)))
            .collect();
        let mut features = Features::fit(kind, index, &looks, &mut rng);
        let empty = || Normal::new(INPUTS, COORDINATES);
        let sum = |normals: &[Normal], but: usize| {
            let others = (0..FOLDS).filter(|f| *f != but);
            others.fold(empty(), |sum, f| sum.merge(&normals[f]))
        };
        let (mut x, mut normals) = self.normals(&features);
        if kind == Kind::Refined {
            let all: Vec<Set> = vec![((0..=INPUTS).collect(), 0..COORDINATES)];
            let ridge = best_ridge(&all, &sum(&normals, 0), &normals[0]);
            let weights = solve(&sum(&normals, FOLDS), &all, ridge, &self.basis);
            let chosen: Vec<usize> = (0..REFINED_ON.min(x.len()))
                .map(|_| rng.random_range(0..x.len()))
                .collect();
            let examples: Vec<rbm::Example> = chosen
                .into_par_iter()
                .map(|n| {
                    let look = self.look(n, features.step);
                    (look.patches(), Array1::from(self.target(n)))
                })
                .collect();
            let errors = rbm::refine(&mut features, &weights, 3, &examples, &mut rng);
            println!("    refined: error {:.4} to {:.4}", errors[0], errors[1]);
            features.rescale(&looks);
            (x, normals) = self.normals(&features);
        }
        let train = sum(&normals, 0);
        let sets = sets(links, &train, &normals[0]);
        let ridge = best_ridge(&sets, &train, &normals[0]);
        for fold in 0..FOLDS {
            let weights = solve(&sum(&normals, fold), &sets, ridge, &self.basis);
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
        println!(
            "    stage {}: {:.2} % out of fold, ridge {ridge}, {:.0?}",
            index + 1,
            errors.sum::<f32>() / self.samples.len() as f32,
            began.elapsed()
        );
        Stage {
            weights: solve(&sum(&normals, FOLDS), &sets, ridge, &self.basis),
            features,
        }
    }
}

/// The shape after one step.
fn moved(mean: &Shape, shape: &Shape, weights: &Mat<f32>, x: &[f32]) -> Shape {
    let canonical = Similarity::fit(mean, shape).expect("a shape has extent");
    let answer = ridge::outputs(weights, |column| {
        column.iter().zip(x).map(|(w, x)| w * x).sum()
    });
    std::array::from_fn(|i| {
        let [dx, dy] = canonical.apply_vector([answer[2 * i], answer[2 * i + 1]]);
        [shape[i][0] + dx, shape[i][1] + dy]
    })
}

/// Starts on a face, as [`crate::align::evaluate`] draws them.
fn starts_on(
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
pub struct Cascade<'a> {
    mean: Shape,
    starts: &'a StartShapes,
    stages: Vec<Stage>,
}

impl<'a> Cascade<'a> {
    /// Trains all stages; the last two look as `late` says.
    pub fn train(mut training: Training<'a>, kind: Kind, late: Links) -> Cascade<'a> {
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
            starts: training.starts,
            stages,
        }
    }

    /// Errors on faces from boxes.
    pub fn evaluate(&self, faces: &[Face], boxes: &Boxes) -> Accuracy {
        let rows: Vec<_> = faces
            .par_iter()
            .enumerate()
            .flat_map_iter(|(index, face)| {
                let starts = starts_on(face, self.starts, boxes, 7, index);
                starts.into_iter().map(move |mut shape| {
                    for stage in &self.stages {
                        let look = Look::at(face, &self.mean, &shape, stage.features.step);
                        let x = stage.features.of(&look);
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
    use crate::align::Jitter;
    use crate::faces::Picture;
    use std::sync::Arc;

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
        Face {
            picture: Arc::new(Picture {
                size: [128; 2],
                luma,
            }),
            landmarks,
            person,
            yaw_deg: Some(0.0),
            weight: 1.0,
            visible: [true; LANDMARKS],
        }
    }

    #[test]
    fn a_stage_moves_starts_closer() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let faces: Vec<Face> = (0..60).map(|p| dots(p, &mut rng)).collect();
        let boxes = Boxes {
            jitter: Jitter {
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
            starts: &starts,
            stages: vec![],
        };
        let before = cascade.evaluate(&faces[50..], &boxes);
        cascade
            .stages
            .push(training.stage(Kind::Hog, Links::Global, 0));
        let after = cascade.evaluate(&faces[50..], &boxes);
        assert!(after.nme68 < 0.6 * before.nme68, "{before:?} {after:?}");
    }
}
