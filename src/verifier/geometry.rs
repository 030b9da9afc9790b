//! The confidence in builds without the verifier: the goodness of fit of the 3D face.
//!
//! The cascade yields a plausible shape for any image content, and without classifiers nothing
//! evaluates the pixels again. What remains is the distance between the landmarks and the 3D face.
//! These confidences are not probabilities.

use super::Confidence;
use crate::shape::{FaceFit, Intrinsics, LANDMARKS};
use core::marker::PhantomData;
use posewise_format::{Blob, ModelError};

/// Distance of the landmarks from the 3D face (root mean square, over the distance between the
/// outer eye corners) at which the confidence is 0. Most faces stay below half of this; most
/// backgrounds give between half and twice this.
const LIMIT: f32 = 0.06;

/// Outer eye corners, iBUG 68 numbers.
const EYES: [usize; 2] = [36, 45];

/// Accepts everything; has the interface of the classifiers.
#[derive(Clone, Copy, Debug)]
pub struct Verifier<'m>(PhantomData<&'m ()>);

impl<'m> Verifier<'m> {
    /// Reads nothing from the model.
    ///
    /// # Errors
    /// Never.
    pub fn open(_: &Blob<'m>, _: usize, _: usize) -> Result<Self, ModelError> {
        Ok(Verifier(PhantomData))
    }

    /// All probabilities 1: after the fit there is [`geometric_confidence`].
    pub fn evaluate(&self, _: &[i8], _: usize) -> Confidence {
        Confidence {
            face: 1.0,
            landmarks: [1.0; LANDMARKS],
            visibility: [1.0; LANDMARKS],
        }
    }
}

/// The goodness of fit of the 3D face as a confidence: `face` and every landmark from 1, where the
/// 3D face matches the landmarks, to 0 at [`LIMIT`]; `visibility` by the occlusion of the head by
/// itself, 0 or 1.
pub fn geometric_confidence(fitted: &FaceFit, camera: &Intrinsics) -> Confidence {
    let [a, b] = EYES.map(|k| fitted.points_mm.get(k).copied().unwrap_or_default());
    let eyes_mm = libm::sqrtf((b - a).length_squared());
    let eyes_px = eyes_mm * camera.fx / fitted.state.pose.translation_mm.z.max(1.0);
    let distance = fitted.rms_px / (LIMIT * eyes_px).max(1e-6);
    let face = (1.0 - distance * distance).max(0.0);
    Confidence {
        face,
        landmarks: [face; LANDMARKS],
        visibility: fitted.visible.map(|visible| f32::from(u8::from(visible))),
    }
}
