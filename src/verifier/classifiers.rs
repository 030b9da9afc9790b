//! Linear classifiers on the cascade's features, calibrated to probabilities (section `VRFY`).
//!
//! One looks at all landmarks' features at once and tells a well-fitted face from anything else;
//! one per landmark looks at that landmark's features alone and tells whether it is right. Whether a
//! landmark is seen is asked in two rounds: first of its own features, then of all landmarks' first
//! answers, because what covers one mostly covers its neighbours. Outputs pass through a fitted
//! logistic (Platt 1999). Weights are `i8`, sums are integers.

use super::Confidence;
use crate::math::sigmoid;
use crate::model::{Blob, ModelError};
use crate::shape::LANDMARKS;

/// A checked view of section `VRFY`.
#[derive(Clone, Copy, Debug)]
pub struct Verifier<'m> {
    features: usize,
    views: [Option<ViewWeights<'m>>; MAX_VIEWS],
}

/// The classifiers of one view; turns to the left and to the right are views of their own.
#[derive(Clone, Copy, Debug)]
struct ViewWeights<'m> {
    /// `LANDMARKS` rows of `features`: the face classifier.
    face: &'m [i8],
    face_scale: f32,
    face_bias: f32,
    /// The same shape: one classifier per landmark.
    local: &'m [i8],
    local_scale: &'m [f32],
    local_bias: &'m [f32],
    /// Share of the face's logit in every landmark's.
    local_face: &'m [f32],
    /// `LANDMARKS` rows of `features`: first answers on whether a landmark is seen.
    seen: &'m [i8],
    seen_scale: &'m [f32],
    seen_bias: &'m [f32],
    /// `LANDMARKS` rows of `LANDMARKS`: second answers from the first ones.
    context: &'m [i8],
    context_scale: &'m [f32],
    context_bias: &'m [f32],
}

/// Most views.
const MAX_VIEWS: usize = 7;

/// Nothing right, nothing seen.
const NONE: Confidence = Confidence {
    face: 0.0,
    landmarks: [0.0; LANDMARKS],
    visibility: [0.0; LANDMARKS],
};

impl<'m> Verifier<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"VRFY";

    /// Reads and checks the section; `features` per landmark and `views` as the cascade has them.
    ///
    /// # Errors
    /// When it is missing, too short, or made for another cascade.
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
                local: s.i8s(LANDMARKS * features)?,
                local_scale: s.f32s(LANDMARKS)?,
                local_bias: s.f32s(LANDMARKS)?,
                local_face: s.f32s(LANDMARKS)?,
                seen: s.i8s(LANDMARKS * features)?,
                seen_scale: s.f32s(LANDMARKS)?,
                seen_bias: s.f32s(LANDMARKS)?,
                context: s.i8s(LANDMARKS * LANDMARKS)?,
                context_scale: s.f32s(LANDMARKS)?,
                context_bias: s.f32s(LANDMARKS)?,
            });
        }
        Ok(verifier)
    }

    /// Judges the features of one fit (`LANDMARKS` × `features`), seen from `view`.
    pub fn evaluate(&self, features: &[i8], view: usize) -> Confidence {
        let Some(weights) = self.views.get(view).copied().flatten() else {
            return NONE;
        };
        let logit = weights.face_scale * dot(weights.face, features) as f32 + weights.face_bias;
        let n = self.features.max(1);
        let mut confidence = Confidence {
            face: sigmoid(logit),
            ..NONE
        };
        let rows = weights.local.chunks_exact(n).zip(features.chunks_exact(n));
        let constants = weights
            .local_scale
            .iter()
            .zip(weights.local_bias)
            .zip(weights.local_face);
        for ((out, (weight, own)), ((scale, bias), share)) in
            confidence.landmarks.iter_mut().zip(rows).zip(constants)
        {
            *out = sigmoid(scale * dot(weight, own) as f32 + share * logit + bias);
        }
        let mut first = [0i8; LANDMARKS];
        let rows = weights.seen.chunks_exact(n).zip(features.chunks_exact(n));
        let constants = weights.seen_scale.iter().zip(weights.seen_bias);
        for ((out, (weight, own)), (scale, bias)) in first.iter_mut().zip(rows).zip(constants) {
            *out = first_prediction(scale * dot(weight, own) as f32 + bias);
        }
        let rows = weights.context.chunks_exact(LANDMARKS);
        let constants = weights.context_scale.iter().zip(weights.context_bias);
        for ((out, row), (scale, bias)) in confidence.visibility.iter_mut().zip(rows).zip(constants)
        {
            *out = sigmoid(scale * dot(row, &first) as f32 + bias);
        }
        confidence
    }
}

/// A first answer (about −1 … 1) in the byte that the second ones read.
pub fn first_prediction(score: f32) -> i8 {
    libm::roundf(score * 48.0).clamp(-127.0, 127.0) as i8
}

fn dot(a: &[i8], b: &[i8]) -> i32 {
    a.iter().zip(b).map(|(a, b)| *a as i32 * *b as i32).sum()
}
