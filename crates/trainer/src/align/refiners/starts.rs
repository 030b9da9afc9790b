//! Where refiners start on every face, in training.

use crate::align::each;
use crate::align::evaluate::start_of;
use crate::align::starts::{jittered_box, start_from_box};
use crate::faces::Face;
use crate::single_eyes::Single;
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use posewise_metrics::BoxJitter;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Starts per face, each from another jittered box.
pub const STARTS: usize = 2;
/// Iterations of the global stage from a box.
const ITERATIONS: usize = 3;
/// Mean error above which a result is discarded \[% of the face's scale\].
const LOST: f32 = 12.0;

/// Where a refiner starts.
#[derive(Clone, Copy)]
pub struct Start {
    /// Canonical frame → frame px, by the global stage's result.
    pub to_frame: Similarity,
    /// The result of the stages so far.
    pub shape: Shape,
}

impl Start {
    /// At a shape that the global stage found.
    fn at(model: &AlignModel<'_>, shape: Shape) -> Start {
        let to_frame = Similarity::fit(model.mean(), &shape);
        Start {
            to_frame: to_frame.expect("a shape has extent"),
            shape,
        }
    }

    /// Moves the landmarks that move from one label to another, by part of the way: the stages
    /// before this refiner find lids that move, though not to the end.
    pub fn follow(&mut self, from: &Shape, to: &Shape, rng: &mut ChaCha8Rng) {
        let part = rng.random_range(0.0..1.0f32);
        for ((at, from), to) in self.shape.iter_mut().zip(from).zip(to) {
            *at = [0, 1].map(|k| at[k] + part * (to[k] - from[k]));
        }
    }

    /// The face and the starts of a single eye.
    pub fn of_single(model: &AlignModel<'_>, single: Single) -> (Face, [Start; STARTS]) {
        let start = Start::at(model, single.found);
        (single.face, [start; STARTS])
    }
}

/// The global stage's results on every face, from boxes as a detector gives them; the label where
/// a result is discarded.
pub fn starts(model: &AlignModel<'_>, faces: &[Face]) -> Vec<[Start; STARTS]> {
    let ends = ends(model, faces).into_iter();
    ends.zip(faces)
        .map(|(ends, face)| ends.map(|end| Start::at(model, end.unwrap_or(face.landmarks))))
        .collect()
}

/// A model's results on every face, from boxes as a detector gives them; `None` for one that is far
/// from the label.
pub fn ends(model: &AlignModel<'_>, faces: &[Face]) -> Vec<[Option<Shape>; STARTS]> {
    each(faces, 11, |_, face, rng, work| {
        [(); STARTS].map(|()| {
            let (views, jitter) = (model.views(), &BoxJitter::DETECTOR);
            let (at, size, roll) = jittered_box(&views, &face.landmarks, jitter, rng);
            let start = start_of(model, face.turn());
            let mut shape = start_from_box(&start, at, size, roll);
            let ran = model.run(&face.picture.frame(), ITERATIONS, &mut shape, work);
            let pairs = shape.iter().zip(&face.landmarks);
            let sum: f32 = pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
            let lost = 100.0 * sum / LANDMARKS as f32 > LOST * face.scale();
            (ran && !lost).then_some(shape)
        })
    })
}

/// Moves the starts by the refiners of a model.
pub fn advance(model: &AlignModel<'_>, faces: &[Face], starts: &mut [[Start; STARTS]]) {
    faces.par_iter().zip(starts).for_each_init(
        || Box::new(Workspace::new()),
        |work, (face, starts)| {
            for start in starts {
                let before = start.shape;
                if !model.run(&face.picture.frame(), 0, &mut start.shape, work) {
                    start.shape = before;
                }
            }
        },
    );
}
