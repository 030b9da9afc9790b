//! Errors of a finished cascade on labelled faces, by the core's own code.

use super::each::each;
use super::starts::{jittered_box, start_from_box};
use super::train::Trained;
use crate::faces::Face;
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::shape::LANDMARKS;
use posewise_metrics::landmarks::nme_percent;
use posewise_metrics::{BoxJitter, mean, median};
use rand::Rng;
use serde::{Deserialize, Serialize};

/// Errors in % of the inter-ocular distance.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Accuracy {
    /// Mean over starts of the mean over 68 points.
    pub nme68: f32,
    /// Its median.
    pub nme68_median: f32,
    /// Mean over the inner 51.
    pub nme51: f32,
    /// Share of starts that end above 10 %.
    pub failure: f32,
}

/// Mean point error in % of the inter-ocular distance, over points `from..68`.
pub fn nme(face: &Face, shape: &Shape, from: usize) -> f32 {
    mean_error(face, shape, from..LANDMARKS, face.inter_ocular())
}

/// Mean error of some landmarks in % of a unit \[px\].
pub fn mean_error(
    face: &Face,
    shape: &Shape,
    landmarks: impl Iterator<Item = usize>,
    unit: f32,
) -> f32 {
    nme_percent(landmarks.map(|k| (face.landmarks[k], shape[k])), unit)
}

/// The initial shape for a turn (−1 … 1).
pub fn start_of(model: &AlignModel<'_>, turn: f32) -> Shape {
    model
        .views()
        .initial_shape(turn)
        .expect("a model has an initial shape")
}

/// Where evaluation starts: boxes around the truth, jittered as by a detector.
#[derive(Clone, Copy, Debug)]
pub struct Boxes {
    /// How far off.
    pub jitter: BoxJitter,
    /// Per face.
    pub count: usize,
}

/// Runs the cascade from boxes, and `rounds` more iterations from its own result as in tracking.
pub fn evaluate(
    model: &AlignModel<'_>,
    faces: &[Face],
    boxes: &Boxes,
    rounds: usize,
) -> Vec<(Shape, f32, f32)> {
    let iterations = model.iterations() + rounds;
    from_boxes(model, faces, boxes, |face, shape, work| {
        model.run(&face.picture.frame(), iterations, shape, work);
    })
}

/// The same for the global stage alone, in `f32`, with its first `heads` heads.
pub fn evaluate_float(
    model: &AlignModel<'_>,
    trained: &Trained,
    heads: usize,
    faces: &[Face],
    boxes: &Boxes,
) -> Vec<(Shape, f32, f32)> {
    from_boxes(model, faces, boxes, |face, shape, _| {
        for _ in 0..model.iterations() {
            *shape = trained.iterate(face, model.mean(), shape, heads);
        }
    })
}

fn from_boxes(
    model: &AlignModel<'_>,
    faces: &[Face],
    boxes: &Boxes,
    run: impl Fn(&Face, &mut Shape, &mut Workspace) + Sync,
) -> Vec<(Shape, f32, f32)> {
    let rows = each(faces, 7, |_, face, rng, work| {
        let row = |_| {
            let (views, jitter) = (model.views(), &boxes.jitter);
            let (at, size, roll) = jittered_box(&views, &face.landmarks, jitter, rng);
            let turn = face.turn() + 0.2 * rng.random_range(-1.0f32..1.0);
            let mut shape = start_from_box(&start_of(model, turn), at, size, roll);
            run(face, &mut shape, work);
            (shape, nme(face, &shape, 0), nme(face, &shape, 17))
        };
        (0..boxes.count).map(row).collect::<Vec<_>>()
    });
    rows.into_iter().flatten().collect()
}

impl Accuracy {
    /// Summary of [`evaluate`]'s rows.
    pub fn of(rows: &[(Shape, f32, f32)]) -> Accuracy {
        let nme68: Vec<f64> = rows.iter().map(|r| f64::from(r.1)).collect();
        let nme51: Vec<f64> = rows.iter().map(|r| f64::from(r.2)).collect();
        let shown = |value: Option<f64>| value.unwrap_or(f64::NAN) as f32;
        Accuracy {
            nme68: shown(mean(&nme68)),
            nme68_median: shown(median(&nme68)),
            nme51: shown(mean(&nme51)),
            failure: nme68.iter().filter(|e| **e > 10.0).count() as f32 / rows.len() as f32,
        }
    }
}
