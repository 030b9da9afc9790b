//! Trains the verifier (section `VRFY`): linear classifiers on the cascade's features, calibrated
//! to probabilities on people that they were not trained on (Platt 1999).
//!
//! Per landmark and view, support vector machines decide whether the landmark is correct and
//! whether it is visible. Per view, one of all features separates faces from the rest.

mod linear;
mod platt;
mod samples;

pub use platt::platt;
pub use samples::candidates;

use crate::faces::{Face, Picture};
use crate::ridge::Linear;
use anyhow::Result;
use linear::{Example, cross_fitted};
use posewise::align::AlignModel;
use posewise::detect::DetectorModel;
use posewise::shape::LANDMARKS;
use posewise::verifier::{Verifier, first_prediction};
use posewise_format::SectionWriter;
use posewise_metrics::{auc, calibration_error};
use rayon::prelude::*;
use samples::Sample;

/// Weight of the squared norm beside the mean loss: the values with the least log loss on unseen
/// people of the research model's training data, of two per decade. The log loss is flat there.
const FACE_RIDGE: f32 = 0.03;
const CORRECT_RIDGE: f32 = 0.001;
const VISIBLE_RIDGE: f32 = 0.003;
const CONTEXT_RIDGE: f32 = 0.03;
/// Largest logit of the face that the landmarks' classifiers are calibrated with.
const MAX_FACE_LOGIT: f32 = 12.0;

/// Trains the classifiers of faces, and of correct and visible landmarks, for every view.
pub fn train(
    model: &AlignModel<'_>,
    detector: &DetectorModel<'_>,
    faces: &[Face],
    empty: &[Picture],
    seed: u64,
) -> Result<SectionWriter> {
    let samples = samples::collect(model, detector, faces, empty, seed);
    let views = model.signed_views();
    let mut out = SectionWriter::new(Verifier::TAG);
    out.scalar(model.features() as u32).scalar(views as u32);
    for view in 0..views {
        let samples: Vec<&Sample> = samples.iter().filter(|s| s.view == view).collect();
        println!("verifier: view {view}, {} fits", samples.len());
        let logits = train_face(&samples, &mut out)?;
        train_correct(&samples, &logits, model.features(), &mut out)?;
        train_visible(&samples, model.features(), &mut out)?;
    }
    Ok(out)
}

/// A classifier with its calibration.
struct Calibrated {
    classifier: Linear,
    /// Slopes of the score and of the face's logit.
    slopes: [f32; 2],
    offset: f32,
    /// Of samples of unseen people.
    logits: Vec<f32>,
    labels: Vec<bool>,
}

impl Calibrated {
    /// Of examples with these labels; the face's logits count beside the scores, if there are any.
    fn new(
        examples: &[Example<'_>],
        labels: Vec<bool>,
        ridge: f32,
        weights: Option<&[f32]>,
        face_logits: Option<&[f32]>,
    ) -> Result<Self> {
        let (classifier, scores) = cross_fitted(examples, ridge)?;
        let (slopes, offset) = platt(&scores, &labels, weights, face_logits);
        let of_face = |k: usize| face_logits.map_or(0.0, |face| face[k] * slopes[1]);
        let scores = scores.iter().enumerate();
        Ok(Calibrated {
            classifier,
            slopes,
            offset,
            logits: scores
                .map(|(k, score)| score * slopes[0] + of_face(k) + offset)
                .collect(),
            labels,
        })
    }

    fn scale(&self) -> f32 {
        self.classifier.scale * self.slopes[0]
    }

    fn bias(&self) -> f32 {
        self.classifier.bias * self.slopes[0] + self.offset
    }
}

/// The face's classifier of one view; returns the logits of samples of unseen people.
fn train_face(samples: &[&Sample], out: &mut SectionWriter) -> Result<Vec<f32>> {
    let weights = balanced(samples);
    let rows = samples.iter().zip(&weights);
    let examples: Vec<Example<'_>> = rows
        .map(|(s, &weight)| Example {
            weight,
            ..s.example(&s.features, s.face)
        })
        .collect();
    let labels: Vec<bool> = samples.iter().map(|s| s.face).collect();
    let face = Calibrated::new(&examples, labels, FACE_RIDGE, Some(&weights), None)?;
    report("face", std::slice::from_ref(&face));
    out.scalar(face.scale()).scalar(face.bias());
    out.array(&face.classifier.weight);
    Ok(face.logits)
}

/// Weights of samples of one view, with which what is no well-fitted face weighs no more than such
/// faces. In profile it has five times their weight otherwise, and profiles that are tracked well
/// count as no faces.
fn balanced(samples: &[&Sample]) -> Vec<f32> {
    let sum = |of_faces: bool| -> f32 {
        let some = samples.iter().filter(|s| s.face == of_faces);
        some.map(|s| s.weight).sum()
    };
    let [faces, others] = [true, false].map(sum);
    let share = (faces / others.max(f32::MIN_POSITIVE)).min(1.0);
    let weight = |s: &&Sample| if s.face { s.weight } else { share * s.weight };
    samples.iter().map(weight).collect()
}

/// The classifiers of correct landmarks, of one view.
fn train_correct(
    samples: &[&Sample],
    face_logits: &[f32],
    features: usize,
    out: &mut SectionWriter,
) -> Result<()> {
    let known = samples.iter().zip(face_logits);
    let known = known.filter(|(s, _)| !s.correct.is_empty());
    let (samples, face_logits): (Vec<&Sample>, Vec<f32>) = known
        .map(|(s, l)| (*s, l.clamp(-MAX_FACE_LOGIT, MAX_FACE_LOGIT)))
        .unzip();
    let landmarks = (0..LANDMARKS)
        .into_par_iter()
        .map(|landmark| {
            let labelled = samples.iter().zip(&face_logits);
            let labelled = labelled.filter_map(|(s, l)| Some((*s, *l, s.correct[landmark]?)));
            let (samples, rest): (Vec<&Sample>, Vec<(f32, bool)>) = labelled
                .map(|(s, logit, label)| (s, (logit, label)))
                .unzip();
            let (face_logits, labels): (Vec<f32>, Vec<bool>) = rest.into_iter().unzip();
            let examples = own_examples(&samples, &labels, landmark, features);
            Calibrated::new(&examples, labels, CORRECT_RIDGE, None, Some(&face_logits))
        })
        .collect::<Result<Vec<_>>>()?;
    report("landmark correct", &landmarks);
    let classifiers = landmarks.iter().map(|l| &l.classifier);
    out.array(&all_weights(classifiers));
    out.array(&landmarks.iter().map(Calibrated::scale).collect::<Vec<_>>());
    out.array(&landmarks.iter().map(Calibrated::bias).collect::<Vec<_>>());
    out.array(&landmarks.iter().map(|l| l.slopes[1]).collect::<Vec<_>>());
    Ok(())
}

/// The classifiers of visible landmarks, of one view: from a landmark's own features, then from all
/// landmarks' first predictions.
fn train_visible(samples: &[&Sample], features: usize, out: &mut SectionWriter) -> Result<()> {
    let known = samples.iter().filter(|s| !s.visible.is_empty());
    let samples: Vec<&Sample> = known.copied().collect();
    let labels =
        |landmark: usize| -> Vec<bool> { samples.iter().map(|s| s.visible[landmark]).collect() };
    let first = (0..LANDMARKS)
        .into_par_iter()
        .map(|landmark| {
            let labels = labels(landmark);
            let examples = own_examples(&samples, &labels, landmark, features);
            cross_fitted(&examples, VISIBLE_RIDGE)
        })
        .collect::<Result<Vec<_>>>()?;
    let predictions: Vec<Vec<i8>> = (0..samples.len())
        .map(|k| first.iter().map(|f| first_prediction(f.1[k])).collect())
        .collect();
    let context = (0..LANDMARKS)
        .into_par_iter()
        .map(|landmark| {
            let labels = labels(landmark);
            let rows = samples.iter().zip(&predictions).zip(&labels);
            let examples: Vec<Example<'_>> = rows
                .map(|((s, predictions), label)| s.example(predictions, *label))
                .collect();
            Calibrated::new(&examples, labels, CONTEXT_RIDGE, None, None)
        })
        .collect::<Result<Vec<_>>>()?;
    report("landmark visible", &context);
    out.array(&all_weights(first.iter().map(|f| &f.0)));
    out.array(&first.iter().map(|f| f.0.scale).collect::<Vec<_>>());
    out.array(&first.iter().map(|f| f.0.bias).collect::<Vec<_>>());
    out.array(&all_weights(context.iter().map(|c| &c.classifier)));
    out.array(&context.iter().map(Calibrated::scale).collect::<Vec<_>>());
    out.array(&context.iter().map(Calibrated::bias).collect::<Vec<_>>());
    Ok(())
}

/// Examples of one landmark from the features that were read there.
fn own_examples<'s>(
    samples: &[&'s Sample],
    labels: &[bool],
    landmark: usize,
    features: usize,
) -> Vec<Example<'s>> {
    let own = landmark * features..(landmark + 1) * features;
    let rows = samples.iter().zip(labels);
    rows.map(|(s, label)| s.example(&s.features[own.clone()], *label))
        .collect()
}

fn all_weights<'l>(classifiers: impl Iterator<Item = &'l Linear>) -> Vec<i8> {
    classifiers.flat_map(|c| c.weight.clone()).collect()
}

/// Prints how well classifiers separate the labels of unseen people, and how well their
/// probabilities agree with frequencies.
fn report(what: &str, classifiers: &[Calibrated]) {
    let pairs = classifiers
        .iter()
        .flat_map(|c| c.logits.iter().zip(&c.labels));
    let probability =
        |(logit, label): (&f32, &bool)| (1.0 / (1.0 + f64::from(-logit).exp()), *label);
    let pairs: Vec<(f64, bool)> = pairs.map(probability).collect();
    let right = |(p, label): &(f64, bool)| if *label { *p } else { 1.0 - p };
    let loss: f64 = pairs.iter().map(|pair| -right(pair).max(1e-9).ln()).sum();
    println!(
        "verifier: {what}: area under the ROC {:.4}, log loss {:.4}, calibration error {:.3}",
        auc(&pairs).unwrap_or(f64::NAN),
        loss / pairs.len() as f64,
        calibration_error(&pairs).unwrap_or(f64::NAN),
    );
}
