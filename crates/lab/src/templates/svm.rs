//! Linear SVM templates and their calibration.

use super::descriptor::{KINDS, Patches, Placement, VALUES};
use indicatif::{ProgressBar, ProgressStyle};
use posewise::align::AlignModel;
use posewise::shape::LANDMARKS;
use posewise_train::faces::Face;
use posewise_train::verifier::platt;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Faces per view.
const FACES: usize = 5000;
/// Random negatives per face, this far away \[px\].
const NEGATIVES: usize = 6;
const FAR: (f32, f32) = (2.5, 9.0);
/// A response further than this from the landmark is a mistake to learn from \[px\].
const NEAR: f32 = 2.5;
/// Half the side of the window that is searched for mistakes and for corrections \[px\].
pub const REACH: i32 = 5;
/// The SVM's weight of errors, and passes over the samples.
const COST: f32 = 0.3;
const EPOCHS: usize = 6;

/// One template: probability = logistic(slope · (w·x) + offset), x a patch.
#[derive(Clone, Serialize, Deserialize)]
struct Template {
    /// [`VALUES`] numbers.
    weight: Vec<f32>,
    slope: f32,
    offset: f32,
}

/// Templates by view, landmark and descriptor.
#[derive(Serialize, Deserialize)]
pub struct Bank(Vec<Vec<[Template; KINDS]>>);

struct Example {
    patches: Patches,
    points: [[f32; 2]; LANDMARKS],
    seen: [bool; LANDMARKS],
    /// Only for calibration: every fifth person.
    held: bool,
}

type Labelled = ([f32; VALUES], bool);

impl Bank {
    /// Trains on faces, of each view at most [`FACES`].
    pub fn train(model: &AlignModel<'_>, faces: &[Face]) -> Bank {
        let views = views(model);
        let style = ProgressStyle::with_template("templates {bar:40} {pos}/{len} eta {eta}");
        let bar = ProgressBar::new((views * LANDMARKS) as u64);
        let bar = bar.with_style(style.expect("a template"));
        let bank = (0..views).map(|view| {
            let examples = examples(model, faces, view);
            let all = (0..LANDMARKS).into_par_iter().map(|k| {
                let trained = std::array::from_fn(|kind| template(&examples, k, kind));
                bar.inc(1);
                trained
            });
            all.collect()
        });
        Bank(bank.collect())
    }

    /// Whether it has this number of views, and templates of all landmarks.
    pub fn is_whole(&self, views: usize) -> bool {
        let template = |t: &Template| t.weight.len() == VALUES;
        let view = |view: &Vec<[Template; KINDS]>| {
            view.len() == LANDMARKS && view.iter().flatten().all(template)
        };
        self.0.len() == views && self.0.iter().all(view)
    }

    /// Product of the descriptors' probabilities at a point.
    pub fn response(&self, view: usize, k: usize, patches: &Patches, p: [f32; 2]) -> f32 {
        let kinds = self.0[view][k].iter().enumerate();
        kinds
            .map(|(kind, template)| {
                patches.at(kind, p).map_or(0.0, |patch| {
                    let score = template.slope * dot(&template.weight, &patch);
                    1.0 / (1.0 + (-score - template.offset).exp())
                })
            })
            .product()
    }
}

/// Views of a model, those of both sides once.
pub fn views(model: &AlignModel<'_>) -> usize {
    model.signed_views() / 2 + 1
}

/// The faces of a view; those towards the camera also in a mirror.
fn examples(model: &AlignModel<'_>, faces: &[Face], view: usize) -> Vec<Example> {
    let placements: Vec<(&Face, Placement)> = faces
        .iter()
        .filter_map(|face| Some((face, Placement::of(model, &face.landmarks)?)))
        .filter(|(_, placement)| placement.view == view)
        .collect();
    let step = placements.len().div_ceil(FACES).max(1);
    placements
        .into_par_iter()
        .step_by(step)
        .enumerate()
        .map(|(n, (face, placement))| {
            let placement = match view == 0 && n % 2 == 1 {
                true => placement.flipped(),
                false => placement,
            };
            Example {
                patches: Patches::cut(&face.picture, &placement),
                points: placement.points(&face.landmarks),
                seen: placement.marks(&face.visible),
                held: face.person % 5 == 4,
            }
        })
        .collect()
}

/// Trains one template, goes on with its mistakes, calibrates it on held-out people.
fn template(examples: &[Example], k: usize, kind: usize) -> Template {
    let mut rng = ChaCha8Rng::seed_from_u64((k * KINDS + kind) as u64);
    let mut samples: Vec<Labelled> = Vec::new();
    let mut held: Vec<Labelled> = Vec::new();
    for example in examples.iter().filter(|e| e.seen[k]) {
        let to = if example.held {
            &mut held
        } else {
            &mut samples
        };
        let p = example.points[k];
        to.extend(example.patches.at(kind, p).map(|patch| (patch, true)));
        for _ in 0..NEGATIVES {
            let angle = rng.random_range(0.0..std::f32::consts::TAU);
            let far = rng.random_range(FAR.0..FAR.1);
            let at = [p[0] + far * angle.cos(), p[1] + far * angle.sin()];
            to.extend(example.patches.at(kind, at).map(|patch| (patch, false)));
        }
    }
    let first = svm(&samples);
    for example in examples.iter().filter(|e| e.seen[k] && !e.held) {
        let score = |(dx, dy): (i32, i32)| {
            let at = [
                example.points[k][0] + dx as f32,
                example.points[k][1] + dy as f32,
            ];
            let patch = example.patches.at(kind, at)?;
            Some((dot(&first, &patch), patch))
        };
        let offsets = (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| (x, y)));
        let far = offsets.filter(|(x, y)| (*x as f32).hypot(*y as f32) > NEAR);
        let worst = far
            .filter_map(score)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, patch)| (patch, false));
        samples.extend(worst);
    }
    let weight = svm(&samples);
    let (slope, offset) = calibrated(&weight, &held);
    Template {
        weight: weight.to_vec(),
        slope,
        offset,
    }
}

/// L2-loss linear SVM by dual coordinate descent (Hsieh et al., ICML 2008); both classes weigh the
/// same. The patches have no mean, so there is no use for a bias but in the calibration.
fn svm(samples: &[Labelled]) -> [f32; VALUES] {
    let positives = samples.iter().filter(|s| s.1).count().max(1) as f32;
    let negatives = samples.len() as f32 - positives;
    let mut weight = [0.0f32; VALUES];
    let mut bias = 0.0f32;
    let mut alphas = vec![0.0f32; samples.len()];
    let mut order: Vec<usize> = (0..samples.len()).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..EPOCHS {
        for i in (1..order.len()).rev() {
            order.swap(i, rng.random_range(0..=i));
        }
        for &i in &order {
            let (x, label) = &samples[i];
            let (y, cost) = match label {
                true => (1.0, COST * negatives.max(1.0) / positives),
                false => (-1.0, COST),
            };
            let diagonal = 0.5 / cost;
            // Patches have unit length; the bias is one value more.
            let gradient = y * (dot(&weight, x) + bias) - 1.0 + diagonal * alphas[i];
            let alpha = (alphas[i] - gradient / (2.0 + diagonal)).max(0.0);
            let step = (alpha - alphas[i]) * y;
            alphas[i] = alpha;
            weight.iter_mut().zip(x).for_each(|(w, v)| *w += step * v);
            bias += step;
        }
    }
    weight
}

/// Slope and offset of the logistic that fits labels to scores.
fn calibrated(weight: &[f32; VALUES], samples: &[Labelled]) -> (f32, f32) {
    let scores: Vec<f32> = samples.iter().map(|(x, _)| dot(weight, x)).collect();
    let labels: Vec<bool> = samples.iter().map(|(_, y)| *y).collect();
    let ([slope, _], offset) = platt(&scores, &labels, None, None);
    (slope, offset)
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn svm_and_calibration_find_a_direction() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let samples: Vec<Labelled> = (0..600)
            .map(|i| {
                let label = i % 3 == 0;
                let mut x: [f32; VALUES] = std::array::from_fn(|_| rng.random_range(-0.1..0.1));
                x[7] += if label { 0.5 } else { -0.2 };
                (x, label)
            })
            .collect();
        let weight = svm(&samples);
        let scores: Vec<(f32, bool)> = samples.iter().map(|(x, y)| (dot(&weight, x), *y)).collect();
        let (slope, offset) = calibrated(&weight, &samples);
        let right = |(s, y): &&(f32, bool)| (slope * s + offset > 0.0) == *y;
        assert!(scores.iter().filter(right).count() > 590);
    }
}
