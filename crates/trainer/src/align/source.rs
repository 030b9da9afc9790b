//! Where a network's samples come from.

use super::bend::Bend;
use super::cover::{covered, cut_off};
use super::network::Points;
use super::options::{Aperture, Options};
use super::samples::{Predict, Sample, sample};
use super::shut;
use crate::faces::Face;
use anyhow::{Result, ensure};
use posewise::align::Shape;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Where samples come from.
pub trait Source: Sync {
    /// A sample.
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample;

    /// A sample whose crop may lie where an earlier prediction puts it.
    fn draw_again(&self, _predict: &mut Predict<'_>, rng: &mut ChaCha8Rng) -> Sample {
        self.draw(rng)
    }

    /// Pairs of points whose distance counts by itself, and its weight.
    fn aperture(&self, aperture: &Aperture) -> Vec<([usize; 2], f32)>;

    /// What the first prediction begins with.
    fn offset(&self) -> Points;

    /// Some as the network meets them in training.
    fn samples(&self, count: usize, rng: &mut ChaCha8Rng) -> Vec<Sample> {
        (0..count).map(|_| self.draw(rng)).collect()
    }
}

/// Which face comes next.
pub struct Draw {
    photographs: Weighted,
    renders: Weighted,
    rendered: f32,
}

/// Indices that are drawn according to their weights.
struct Weighted {
    indices: Vec<usize>,
    /// Running sums of the weights.
    sums: Vec<f32>,
}

impl Weighted {
    fn new(indices: Vec<usize>, weight: impl Fn(usize) -> f32) -> Weighted {
        let mut sum = 0.0;
        let add = |k: &usize| {
            sum += weight(*k);
            sum
        };
        Weighted {
            sums: indices.iter().map(add).collect(),
            indices,
        }
    }

    fn next(&self, rng: &mut ChaCha8Rng) -> usize {
        let at = rng.random_range(0.0..*self.sums.last().expect("faces to draw from"));
        let k = self.sums.partition_point(|s| *s <= at);
        self.indices[k.min(self.indices.len() - 1)]
    }
}

impl Draw {
    /// Photographs of turned faces come more often, renders of turned ones less, and faces of
    /// interest more.
    pub fn new(faces: &[Face], options: &Options, interest: impl Fn(&Face) -> f32) -> Result<Draw> {
        ensure!(!faces.is_empty(), "no faces to train on");
        let of = |rendered: bool| {
            let chosen = |k: &usize| faces[*k].is_render == rendered;
            (0..faces.len()).filter(chosen).collect::<Vec<_>>()
        };
        Ok(Draw {
            photographs: Weighted::new(of(false), |k| {
                faces[k].share
                    * interest(&faces[k])
                    * (1.0 + options.turned * faces[k].turn().abs())
            }),
            renders: Weighted::new(of(true), |k| {
                let straight = 1.0 - faces[k].turn().abs();
                interest(&faces[k]) * (1.0 + options.front * straight * straight)
            }),
            rendered: options.rendered,
        })
    }

    /// The next face's index.
    pub fn next(&self, rng: &mut ChaCha8Rng) -> usize {
        let (photographs, renders) = (&self.photographs, &self.renders);
        match (photographs.indices.is_empty(), renders.indices.is_empty()) {
            (true, _) => renders.next(rng),
            (_, true) => photographs.next(rng),
            _ if rng.random_range(0.0..1.0) < self.rendered => renders.next(rng),
            _ => photographs.next(rng),
        }
    }
}

/// Whole faces.
pub struct Faces<'a> {
    pub faces: &'a [Face],
    pub mean: &'a Shape,
    pub options: &'a Options,
    pub draw: Draw,
}

impl Faces<'_> {
    fn sample(&self, predict: Option<&mut Predict<'_>>, rng: &mut ChaCha8Rng) -> Sample {
        let mut face = &self.faces[self.draw.next(rng)];
        let options = self.options;
        let (eyes_shut, hidden, cut);
        if let Some(shut) = shut::sometimes(face, options.shut, rng) {
            eyes_shut = shut;
            face = &eyes_shut;
        }
        if rng.random_range(0.0..1.0) < options.occluded {
            hidden = covered(face, &self.faces[self.draw.next(rng)], rng);
            face = &hidden;
        }
        if rng.random_range(0.0..1.0) < options.cut_off {
            cut = cut_off(face, rng);
            face = &cut;
        }
        let bend = Bend::sometimes(options.bent, rng);
        sample(face, self.mean, options, bend, predict, rng)
    }
}

impl Source for Faces<'_> {
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample {
        self.sample(None, rng)
    }

    fn draw_again(&self, predict: &mut Predict<'_>, rng: &mut ChaCha8Rng) -> Sample {
        self.sample(Some(predict), rng)
    }

    fn aperture(&self, aperture: &Aperture) -> Vec<([usize; 2], f32)> {
        aperture.pairs().collect()
    }

    fn offset(&self) -> Points {
        let zoom = self.options.sizes.zoom;
        self.mean.iter().map(|p| p.map(|v| v * zoom)).collect()
    }
}
