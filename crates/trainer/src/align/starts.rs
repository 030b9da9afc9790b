//! Initial shapes of the cascade, at work and in training.

use super::mean::align;
use crate::faces::Face;
use posewise::align::{Shape, Views, mirror};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use posewise_metrics::{BoxJitter, FaceBox};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Start shapes by amount of turn, in the canonical frame.
pub struct StartShapes {
    /// Mean shapes of the faces near each turn, turned to the image right.
    pub shapes: Vec<Shape>,
    /// Their turns, rising from 0.
    pub turns: Vec<f32>,
}

impl StartShapes {
    /// Mean shapes around `turns`, mirrors of left-turned faces included.
    pub fn fit(faces: &[Face], mean: &Shape, turns: &[f32]) -> StartShapes {
        let mean_of = |index: usize| {
            let mut sum = [[0.0f64; 2]; LANDMARKS];
            let mut n = 0.0;
            for face in faces
                .iter()
                .filter(|f| index_of(turns, f.turn().abs()) == index)
            {
                let aligned = align(&face.landmarks, mean);
                let other = mirror(&aligned);
                // The view towards the camera is its own mirror.
                let (own, opposite) = match (index, face.turn() < 0.0) {
                    (0, _) => (1.0, 1.0),
                    (_, left) => (if left { 0.0 } else { 1.0 }, if left { 1.0 } else { 0.0 }),
                };
                for (s, (p, q)) in sum.iter_mut().zip(aligned.iter().zip(&other)) {
                    s[0] += own * p[0] as f64 + opposite * q[0] as f64;
                    s[1] += own * p[1] as f64 + opposite * q[1] as f64;
                }
                n += own + opposite;
            }
            if n == 0.0 {
                *mean
            } else {
                sum.map(|[x, y]| [(x / n) as f32, (y / n) as f32])
            }
        };
        StartShapes {
            shapes: (0..turns.len()).map(mean_of).collect(),
            turns: turns.to_vec(),
        }
    }

    /// The core's view of them.
    pub fn views(&self) -> Views<'_> {
        Views {
            shapes: &self.shapes,
            yaws: &self.turns,
        }
    }
}

fn index_of(turns: &[f32], turn: f32) -> usize {
    let distance = |i: &usize| (turns[*i] - turn).abs();
    (0..turns.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .expect("at least one turn")
}

/// The detector's box of a shape: centre, side (the larger of width and height) of the upright box
/// after turning back by `roll`, and `roll` \[rad\], by which the most similar start shape is
/// turned.
pub fn face_box(views: &Views<'_>, shape: &Shape) -> ([f32; 2], f32, f32) {
    box_at(shape, views.of(shape).expect("a face has extent").roll)
}

fn box_at(shape: &Shape, roll: f32) -> ([f32; 2], f32, f32) {
    let back = Similarity {
        a: roll.cos(),
        b: -roll.sin(),
        tx: 0.0,
        ty: 0.0,
    };
    let upright = shape.map(|p| back.apply(p));
    let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
    for p in upright {
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let forth = back.inverse().expect("a rotation");
    let centre = forth.apply([(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0]);
    (centre, (high[0] - low[0]).max(high[1] - low[1]), roll)
}

/// Puts an upright canonical start shape into a detector's box.
pub fn start_from_box(start: &Shape, centre: [f32; 2], size: f32, roll: f32) -> Shape {
    let ([cx, cy], side, _) = box_at(start, 0.0);
    let (scale, [tx, ty]) = (size / side, centre);
    let turn = Similarity {
        a: scale * roll.cos(),
        b: scale * roll.sin(),
        tx,
        ty,
    };
    start.map(|[x, y]| turn.apply([x - cx, y - cy]))
}

/// The detector's box of a shape ([`face_box`]), as far off as `jitter` says.
pub fn jittered_box(
    views: &Views<'_>,
    shape: &Shape,
    jitter: &BoxJitter,
    rng: &mut ChaCha8Rng,
) -> ([f32; 2], f32, f32) {
    let (centre, size, roll) = face_box(views, shape);
    let truth = FaceBox { centre, size, roll };
    let FaceBox { centre, size, roll } = jitter.apply(&truth, || normal(rng));
    (centre, size, roll)
}

/// A standard normal number.
pub fn normal(rng: &mut ChaCha8Rng) -> f32 {
    let u: f32 = rng.random_range(1e-7..1.0);
    let v: f32 = rng.random_range(0.0..std::f32::consts::TAU);
    (-2.0 * u.ln()).sqrt() * v.cos()
}
