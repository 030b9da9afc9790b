//! Training of the cascade that moves a head (thesis 5.1, 5.2), on labelled faces to which the 3D
//! face is fitted first.
//!
//! There are two rounds. In the first, starts are drawn around the fitted heads. The cascade then
//! tracks clips, and in the second round half of the starts are off as tracked frames were.

use super::face_model::FaceModel;
use super::head_cascade::{HeadCascade, Look, Stage, VIEWS, View};
use super::own_errors::OwnErrors;
use super::person::Sketch;
use super::state::{RIGID, SIZE, State};
use crate::features::local::{FaceCrop, Features, Kind};
use crate::features::regression::{
    COORDINATES, INPUTS, Links, Normal, Set, best_ridge, sets, solve,
};
use anyhow::Result;
use glam::Quat;
use posewise::Intrinsics;
use posewise::shape::LANDMARKS;
use posewise_metrics::landmarks::INNER;
use posewise_train::align::normal;
use posewise_train::faces::Face;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

/// Stages.
const STAGES: usize = 4;
/// The last stages, whose landmarks are predicted from some only, and from how many (R).
const LATE: usize = 2;
const LINKS: usize = 8;
/// Folds of people for predictions on faces that were not learned from.
const FOLDS: usize = 3;
/// Weights of |w|² in the ridge, over the features' mean square, of which each stage takes the best
/// on a fold. The author's published code has the first.
const RIDGES: [f32; 5] = [0.005, 0.03, 0.1, 0.3, 1.0];
/// Crops that features are learned from; tests need fewer.
const CROPS: usize = if cfg!(test) { 100 } else { 400 };
/// Starts on a face, and how many of them are drawn in the second round too: clips in which heads
/// move slowly do not show all that a frame can be off.
const STARTS: usize = 4;
const STILL_DRAWN: usize = 2;
/// How far from its middle a view learns from starts \[deg\]. Chosen, as the numbers above.
const REACH_DEG: f32 = 20.0;
/// Standard deviations of the first round's starts: rotation \[rad\], sideways and depth \[mm\],
/// units. Chosen.
const DRAWN: [f64; 4] = [0.1, 8.0, 25.0, 0.2];
/// Standard deviation of what the identity is off there, in standard deviations of its modes: the
/// first frame does not show its depth. Chosen.
const IDENTITY: f64 = 0.4;
/// Assumed distance of the camera \[mm\], and width of a face: labels do not tell.
const DISTANCE_MM: f32 = 800.0;
const FACE_MM: f32 = 150.0;

/// A labelled face with the head that was fitted to it.
struct Subject<'a> {
    face: &'a Face,
    identity: Vec<f64>,
    camera: Intrinsics,
    state: State,
}

/// A head on a face, and where the stages so far have brought it.
struct Sample<'a> {
    subject: usize,
    head: Sketch<'a>,
    start: State,
    state: State,
}

/// Trains a cascade; `clips`, which lie beside their truth, are tracked between the rounds.
pub fn train(
    model: &FaceModel,
    faces: &[Face],
    clips: &[PathBuf],
    kind: Kind,
    seed: u64,
) -> Result<HeadCascade> {
    let subjects: Vec<Subject<'_>> = faces
        .par_iter()
        .filter_map(|face| subject(model, face))
        .collect();
    let round = |errors: Option<&OwnErrors>| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut training = Training {
            samples: drawn(model, &subjects, errors, &mut rng),
            subjects: &subjects,
            rng,
        };
        eprintln!("  {} starts", training.samples.len());
        let stages = (0..STAGES).map(|index| training.stage(kind, index));
        HeadCascade {
            stages: stages.collect(),
        }
    };
    let errors = OwnErrors::of(model, &round(None), clips)?;
    Ok(round(Some(&errors)))
}

/// The head that fits a face's labels.
fn subject<'a>(model: &FaceModel, face: &'a Face) -> Option<Subject<'a>> {
    let [width, height] = face.picture.size.map(|side| side as f32 - 1.0);
    let focal = face.width() * DISTANCE_MM / FACE_MM;
    let camera = Intrinsics::new(focal, focal, width / 2.0, height / 2.0);
    let (identity, state) = model.fit_identity(camera, &face.landmarks).ok()?;
    Some(Subject {
        face,
        identity,
        camera,
        state,
    })
}

/// States off the fitted ones.
fn drawn<'a>(
    model: &'a FaceModel,
    subjects: &[Subject<'_>],
    errors: Option<&OwnErrors>,
    rng: &mut ChaCha8Rng,
) -> Vec<Sample<'a>> {
    let mut samples = Vec::new();
    for (index, subject) in subjects.iter().enumerate() {
        for start in 0..STARTS {
            let (state, off) = match errors {
                Some(errors) if start >= STILL_DRAWN => errors.start(&subject.state, rng),
                _ => far(subject, rng),
            };
            let pairs = subject.identity.iter().zip(off);
            let identity: Vec<f64> = pairs.map(|(w, off)| w + off).collect();
            samples.push(Sample {
                subject: index,
                head: model.sketch(subject.camera, &identity),
                start: state,
                state,
            });
        }
    }
    samples
}

/// A state that is drawn around the fitted one, and what the identity is off.
fn far(subject: &Subject<'_>, rng: &mut ChaCha8Rng) -> (State, Vec<f64>) {
    let modes = subject.identity.iter();
    let off = modes.map(|_| IDENTITY * f64::from(normal(rng))).collect();
    let [rotation, sideways, depth, unit] = DRAWN;
    let wide = rng.random_range(0.2..1.5);
    let mut step = [unit; SIZE];
    step[..RIGID].copy_from_slice(&[rotation, rotation, rotation, sideways, sideways, depth]);
    let step = step.map(|s| s * wide * f64::from(normal(rng)));
    (subject.state.moved(&step), off)
}

struct Training<'a> {
    subjects: &'a [Subject<'a>],
    samples: Vec<Sample<'a>>,
    rng: ChaCha8Rng,
}

impl<'a> Training<'a> {
    fn face(&self, sample: &Sample<'_>) -> &'a Face {
        self.subjects[sample.subject].face
    }

    fn crop(&self, sample: &Sample<'_>, look: &Look, step: f32) -> FaceCrop {
        look.crop(&self.face(sample).picture.frame(), step)
    }

    fn fold(&self, sample: usize) -> usize {
        self.face(&self.samples[sample]).person as usize % FOLDS
    }

    /// Trains one stage and moves the heads by its predictions on faces that these were not
    /// learned from.
    fn stage(&mut self, kind: Kind, index: usize) -> Stage {
        let began = Instant::now();
        let step = kind.step(index);
        let crops: Vec<FaceCrop> = (0..CROPS)
            .map(|_| {
                let sample = &self.samples[self.rng.random_range(0..self.samples.len())];
                self.crop(sample, &Look::at(&sample.head, &sample.state), step)
            })
            .collect();
        let features = Features::fit(kind, index, &crops, &mut self.rng);
        let looks: Vec<Look> = (self.samples.par_iter())
            .map(|sample| Look::at(&sample.head, &sample.state))
            .collect();
        let pairs = self.samples.par_iter().zip(&looks);
        let x: Vec<Vec<f32>> = pairs
            .map(|(sample, look)| features.of(&self.crop(sample, look, step)))
            .collect();
        let links = match index + LATE < STAGES {
            true => Links::Global,
            false => Links::Best(LINKS),
        };
        let mut predicted: Vec<Vec<f32>> = vec![Vec::new(); x.len()];
        let views: Vec<View> = (0..VIEWS.len())
            .map(|view| self.view(view, &looks, &x, links, &mut predicted))
            .collect();
        let moved = self.samples.par_iter().zip(&looks).zip(&predicted);
        let moved: Vec<State> = moved
            .map(|((sample, look), predicted)| {
                let shape = look.moved(predicted);
                let left = &views[look.view()].left;
                let found = look.settled(&sample.head, &sample.start, &shape, left);
                found.unwrap_or(sample.state)
            })
            .collect();
        for (sample, state) in self.samples.iter_mut().zip(moved) {
            sample.state = state;
        }
        eprintln!("    stage {}, {:.0?}", index + 1, began.elapsed());
        self.report(&looks);
        Stage { features, views }
    }

    /// The regression of a view; predicts for the samples that are nearest to it.
    fn view(
        &self,
        view: usize,
        looks: &[Look],
        x: &[Vec<f32>],
        links: Links,
        predicted: &mut [Vec<f32>],
    ) -> View {
        let near = |n: &usize| {
            looks[*n].view() == view || (looks[*n].yaw_deg - VIEWS[view]).abs() <= REACH_DEG
        };
        let members: Vec<usize> = (0..x.len()).filter(near).collect();
        let y = |n: usize| looks[n].displacements(&self.face(&self.samples[n]).landmarks);
        let of_fold = |fold: usize| {
            let mut normal = Normal::new(INPUTS, COORDINATES);
            let of: Vec<usize> = (members.iter().copied())
                .filter(|n| self.fold(*n) == fold)
                .collect();
            for block in of.chunks(1024) {
                let y: Vec<Vec<f32>> = block.iter().map(|n| y(*n)).collect();
                let rows = block.iter().zip(&y);
                let rows = rows.map(|(n, y)| {
                    let weight = self.face(&self.samples[*n]).weight;
                    (&x[*n][..], &y[..], weight)
                });
                normal.add(&rows.collect::<Vec<_>>());
            }
            normal
        };
        let normals: Vec<Normal> = (0..FOLDS).into_par_iter().map(of_fold).collect();
        let sum = |but: usize| {
            let others = (0..FOLDS).filter(|fold| *fold != but);
            let empty = Normal::new(INPUTS, COORDINATES);
            others.fold(empty, |sum, fold| sum.merge(&normals[fold]))
        };
        let train = sum(0);
        let sets: Vec<Set> = sets(links, &train, &normals[0]);
        let ridge = best_ridge(&RIDGES, &sets, &train, &normals[0]);
        let mut squares = [0.0f64; LANDMARKS];
        let mut count = 0;
        for fold in 0..FOLDS {
            let weights = solve(&sum(fold), &sets, ridge);
            for n in &members {
                if self.fold(*n) != fold || looks[*n].view() != view {
                    continue;
                }
                predicted[*n] = weights.of(&x[*n]);
                let y = y(*n);
                for (k, square) in squares.iter_mut().enumerate() {
                    let off = |c: usize| f64::from(predicted[*n][2 * k + c] - y[2 * k + c]);
                    *square += off(0).powi(2) + off(1).powi(2);
                }
                count += 1;
            }
        }
        let left = squares.map(|s| (s / f64::from(count.max(1))).sqrt() as f32);
        eprintln!(
            "      view {view}: {} samples, ridge {ridge}, inner landmarks {:.2} units off",
            members.len(),
            left[INNER..].iter().sum::<f32>() / (LANDMARKS - INNER) as f32
        );
        View {
            weights: solve(&sum(FOLDS), &sets, ridge),
            left: left.to_vec(),
        }
    }

    /// Says how far the heads are from those that were fitted to the labels.
    fn report(&self, looks: &[Look]) {
        for view in 0..VIEWS.len() {
            let of = self.samples.iter().zip(looks);
            let of: Vec<&Sample<'_>> = of
                .filter(|(_, look)| look.view() == view)
                .map(|(sample, _)| sample)
                .collect();
            let off = |state: &State, sample: &Sample<'_>| {
                let truth = &self.subjects[sample.subject].state.rotation;
                let turn = Quat::from_mat3(&(state.rotation * truth.transpose()));
                turn.to_scaled_axis().length().to_degrees()
            };
            let mean = |of_state: &dyn Fn(&Sample<'_>) -> State| {
                let all = of.iter().map(|s| off(&of_state(s), s));
                all.sum::<f32>() / of.len().max(1) as f32
            };
            eprintln!(
                "      view {view}: {:.2}° off, at the start {:.2}°",
                mean(&|s| s.state),
                mean(&|s| s.start)
            );
        }
    }
}
