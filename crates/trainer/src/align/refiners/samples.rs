//! Samples for a refiner: crops around a start, disturbed, and where the landmarks belong.

use super::refiner::Refiner;
use super::starts::{STARTS, Start};
use crate::align::bend::{Bend, Cut};
use crate::align::network::Points;
use crate::align::options::{Aperture, Options};
use crate::align::samples::{Sample, disturb, standardise};
use crate::align::shut;
use crate::align::source::{Draw, Source};
use crate::align::starts::normal;
use crate::faces::{Face, ratio};
use posewise::align::place_refiner;
use posewise::math::Similarity;
use posewise::shape::MIRROR;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Weight of the error of a landmark that is hidden or whose label is unreliable; others have 1.
const HIDDEN: f32 = 0.15;
/// Ratio of height to width below which the labels of an eye's lids are unreliable in photographs:
/// annotators leave shut eyes half open. Renders have shut eyes with exact labels.
const NARROW: f32 = 0.2;
/// Standard deviations of the jitter of a start: logarithm of scale and roll \[rad\] of the crop,
/// shift of all points in canonical units, logarithm of their stretch along each axis, and shift of
/// each point in canonical units.
const CROP_JITTER: f32 = 0.04;
const SHIFT_JITTER: f32 = 0.6;
const STRETCH_JITTER: f32 = 0.06;
const POINT_JITTER: f32 = 0.25;

/// The faces that a refiner is trained on, and where it starts on them.
pub struct RefinerFaces<'a> {
    pub faces: &'a [Face],
    pub starts: &'a [[Start; STARTS]],
    pub options: &'a Options,
    pub draw: Draw,
    pub refiner: &'a Refiner,
}

impl RefinerFaces<'_> {
    /// The lids among an eye's landmarks, where their labels are unreliable.
    fn unreliable_lids(&self, face: &Face, [a, b, c, d, e, f]: [usize; 6]) -> Vec<usize> {
        let narrow = ratio(&face.landmarks, [a, d], &[[b, f], [c, e]]) < NARROW;
        match self.refiner.mirrored && narrow && !face.has_exact_lids {
            true => vec![b, c, e, f],
            false => vec![],
        }
    }

    /// Weights of the errors of these landmarks.
    fn weights(&self, face: &Face, landmarks: &[usize], mirrored: bool) -> Vec<f32> {
        let unreliable = match mirrored {
            false => self.unreliable_lids(face, [36, 37, 38, 39, 40, 41]),
            true => self.unreliable_lids(face, [45, 44, 43, 42, 47, 46]),
        };
        let weight = |k: &usize| match face.visible[*k] && !unreliable.contains(k) {
            _ if !face.known[*k] && !face.is_single_eye => 0.0,
            true => 1.0,
            false => HIDDEN,
        };
        landmarks.iter().map(weight).collect()
    }
}

/// The placement and these landmarks of a start, jittered.
fn jittered(start: &Start, landmarks: &[usize], rng: &mut ChaCha8Rng) -> (Similarity, Points) {
    let unit = start.to_frame.scale();
    let (scale, roll) = ((CROP_JITTER * normal(rng)).exp(), CROP_JITTER * normal(rng));
    let jitter = Similarity {
        a: scale * roll.cos(),
        b: scale * roll.sin(),
        tx: 0.0,
        ty: 0.0,
    };
    let to_frame = jitter.then(&start.to_frame);
    let mut points: Points = landmarks.iter().map(|k| start.shape[*k]).collect();
    let n = points.len() as f32;
    let centre = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f32>() / n);
    let shift = [0, 1].map(|_| SHIFT_JITTER * unit * normal(rng));
    let stretch = [0, 1].map(|_| (STRETCH_JITTER * normal(rng)).exp());
    for p in &mut points {
        for k in 0..2 {
            p[k] = centre[k]
                + shift[k]
                + stretch[k] * (p[k] - centre[k])
                + POINT_JITTER * unit * normal(rng);
        }
    }
    (to_frame, points)
}

impl Source for RefinerFaces<'_> {
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample {
        let index = self.draw.next(rng);
        let mut face = &self.faces[index];
        let mut start = self.starts[index][rng.random_range(0..STARTS)];
        let eyes_shut;
        if let Some(shut) = shut::sometimes(face, self.options.shut, rng) {
            eyes_shut = shut;
            start.follow(&face.landmarks, &eyes_shut.landmarks, rng);
            face = &eyes_shut;
        }
        let mirrored = !face.is_single_eye && rng.random_bool(0.5);
        let which = |k: &usize| if mirrored { MIRROR[*k] } else { *k };
        let landmarks: Vec<usize> = self.refiner.landmarks.iter().map(which).collect();
        let (to_frame, points) = jittered(&start, &landmarks, rng);
        let sizes = &self.options.sizes;
        let to_frame = place_refiner(&to_frame, &points, sizes.zoom).expect("points have extent");
        let bend = Bend::sometimes(self.options.bent, rng);
        let cut = Cut::new(to_frame, sizes.side, bend.as_ref());
        let mut crop = cut.crop(&face.picture, mirrored);
        disturb(&mut crop, sizes.side, &self.options.augment, rng);
        standardise(&mut crop);
        let side = if mirrored { -1.0 } else { 1.0 };
        let into = |p: [f32; 2]| {
            let [x, y] = cut.place(p);
            [side * x, y]
        };
        Sample {
            crop,
            start: points.iter().map(|p| into(*p)).collect(),
            truth: landmarks.iter().map(|k| into(face.landmarks[*k])).collect(),
            weights: self.weights(face, &landmarks, mirrored),
        }
    }

    fn aperture(&self, aperture: &Aperture) -> Vec<([usize; 2], f32)> {
        let local = |k: usize| self.refiner.landmarks.iter().position(|l| *l == k);
        aperture
            .pairs()
            .filter_map(|([a, b], weight)| Some(([local(a)?, local(b)?], weight)))
            .collect()
    }

    fn offset(&self) -> Points {
        vec![[0.0; 2]; self.refiner.landmarks.len()]
    }
}
