//! Linear classifiers per view on the cascade's features (section `VRFY`).
//!
//! The face classifier reads the features of all landmarks and separates aligned faces from
//! everything else. One classifier per landmark reads the features of that landmark and decides
//! whether it is right. Visibility has two stages: a first prediction from the landmark's own
//! features, then a second one from the first predictions of all landmarks, because an occluder
//! mostly covers neighbours too. A fitted logistic function calibrates the outputs (Platt 1999).
//! Weights are `i8`, sums are integers.

use super::Confidence;
use crate::math::sigmoid;
use crate::shape::LANDMARKS;
use posewise_format::{Blob, ModelError};

/// A checked view of section `VRFY`.
#[derive(Clone, Copy, Debug)]
pub struct Verifier<'m> {
    features: usize,
    views: [Option<ViewWeights<'m>>; MAX_VIEWS],
}

/// The classifiers of one signed view. Each output is `scale · (weights · inputs) + bias`.
#[derive(Clone, Copy, Debug)]
struct ViewWeights<'m> {
    /// The face classifier, `[68][features]`.
    face: &'m [i8],
    face_scale: f32,
    face_bias: f32,
    /// One classifier per landmark, `[68][features]`.
    landmark: &'m [i8],
    landmark_scale: &'m [f32],
    landmark_bias: &'m [f32],
    /// Weight of the face's logit in each landmark's logit.
    landmark_face: &'m [f32],
    /// Visibility, first stage: `[68][features]`.
    visible: &'m [i8],
    visible_scale: &'m [f32],
    visible_bias: &'m [f32],
    /// Visibility, second stage: `[68][68]`, from the first predictions.
    context: &'m [i8],
    context_scale: &'m [f32],
    context_bias: &'m [f32],
}

/// Capacity: signed views (frontal, and three to each side).
const MAX_VIEWS: usize = 7;

/// First predictions are counted in these fractions, so that ±2.6 fit a byte.
const PREDICTION_UNITS: f32 = 48.0;

impl<'m> Verifier<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"VRFY";

    /// Reads and checks the section; `features` per landmark and signed `views` are those of the
    /// cascade. The section holds `features, views: u32`, then for each view the fields of a
    /// `ViewWeights`: `face_scale` and `face_bias` first, the others in their order.
    ///
    /// # Errors
    /// When the section is missing or too short, or its sizes differ from the cascade's.
    pub fn open(blob: &Blob<'m>, features: usize, views: usize) -> Result<Self, ModelError> {
        let s = &mut blob.section(&Self::TAG)?;
        s.count(features, features, "features differ from the cascade's")?;
        s.count(
            views,
            views.min(MAX_VIEWS),
            "views differ from the cascade's",
        )?;
        let mut verifier = Verifier {
            features,
            views: [None; MAX_VIEWS],
        };
        for view in verifier.views.iter_mut().take(views) {
            let (face_scale, face_bias) = (s.f32()?, s.f32()?);
            *view = Some(ViewWeights {
                face: s.i8s(LANDMARKS * features)?,
                face_scale,
                face_bias,
                landmark: s.i8s(LANDMARKS * features)?,
                landmark_scale: s.f32s(LANDMARKS)?,
                landmark_bias: s.f32s(LANDMARKS)?,
                landmark_face: s.f32s(LANDMARKS)?,
                visible: s.i8s(LANDMARKS * features)?,
                visible_scale: s.f32s(LANDMARKS)?,
                visible_bias: s.f32s(LANDMARKS)?,
                context: s.i8s(LANDMARKS * LANDMARKS)?,
                context_scale: s.f32s(LANDMARKS)?,
                context_bias: s.f32s(LANDMARKS)?,
            });
        }
        Ok(verifier)
    }

    /// Evaluates the features of an alignment (`[68][features]`) by the classifiers of its signed
    /// view ([`crate::align::Workspace::view`]). All probabilities are 0 for an unknown view.
    pub fn evaluate(&self, features: &[i8], view: usize) -> Confidence {
        let Some(weights) = self.views.get(view) else {
            return Confidence::NONE;
        };
        let Some(weights) = weights else {
            return Confidence::NONE;
        };
        let logit = weights.face_scale * dot(weights.face, features) as f32 + weights.face_bias;
        let mut confidence = Confidence {
            face: sigmoid(logit),
            ..Confidence::NONE
        };
        let n = self.features.max(1);
        weights.landmarks(features.chunks_exact(n), n, logit, &mut confidence);
        weights.visibility(features.chunks_exact(n), n, &mut confidence);
        confidence
    }
}

impl ViewWeights<'_> {
    /// Probabilities that landmarks are right, from the `features` of each, `n` per landmark, and
    /// the face's logit.
    fn landmarks<'f>(
        &self,
        features: impl Iterator<Item = &'f [i8]>,
        n: usize,
        face_logit: f32,
        confidence: &mut Confidence,
    ) {
        let rows = self.landmark.chunks_exact(n).zip(features);
        let constants = self.landmark_scale.iter().zip(self.landmark_bias);
        let constants = constants.zip(self.landmark_face);
        for ((out, (weights, features)), ((scale, bias), share)) in
            confidence.landmarks.iter_mut().zip(rows).zip(constants)
        {
            *out = sigmoid(scale * dot(weights, features) as f32 + share * face_logit + bias);
        }
    }

    /// Probabilities that landmarks are visible, from the `features` of each, `n` per landmark.
    fn visibility<'f>(
        &self,
        features: impl Iterator<Item = &'f [i8]>,
        n: usize,
        confidence: &mut Confidence,
    ) {
        let mut first = [0i8; LANDMARKS];
        let rows = self.visible.chunks_exact(n).zip(features);
        let constants = self.visible_scale.iter().zip(self.visible_bias);
        for ((out, (weights, features)), (scale, bias)) in first.iter_mut().zip(rows).zip(constants)
        {
            *out = first_prediction(scale * dot(weights, features) as f32 + bias);
        }
        let rows = self.context.chunks_exact(LANDMARKS);
        let constants = self.context_scale.iter().zip(self.context_bias);
        for ((out, row), (scale, bias)) in confidence.visibility.iter_mut().zip(rows).zip(constants)
        {
            *out = sigmoid(scale * dot(row, &first) as f32 + bias);
        }
    }
}

/// Quantises a first prediction of visibility (a margin, mostly −1..1) to the byte that the second
/// stage reads.
pub fn first_prediction(margin: f32) -> i8 {
    libm::roundf(margin * PREDICTION_UNITS).clamp(-127.0, 127.0) as i8
}

fn dot(a: &[i8], b: &[i8]) -> i32 {
    a.iter().zip(b).map(|(a, b)| *a as i32 * *b as i32).sum()
}
