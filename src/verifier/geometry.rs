//! What stands in for the classifiers in builds without them: geometry alone.
//!
//! The cascade ends with a plausible shape whatever it looks at, and without classifiers nothing
//! looks at the picture again. All that is left to ask is how well the 3D face explains the shape.
//! Numbers here are no probabilities.

use super::Confidence;
use crate::model::{Blob, ModelError};
use crate::shape::{FaceFit, Intrinsics, LANDMARKS};
use core::marker::PhantomData;

/// Root mean square distance of the landmarks from the 3D face, over the distance between the eyes'
/// outer corners, at which a fit counts for nothing. On faces it mostly stays below half of this; what
/// the cascade makes of a background mostly lies between half and twice this.
const LIMIT: f32 = 0.06;

/// Outer corners of the eyes.
const EYES: [usize; 2] = [36, 45];

/// Knows nothing; takes the place of the classifiers.
#[derive(Clone, Copy, Debug)]
pub struct Verifier<'m>(PhantomData<&'m ()>);

impl<'m> Verifier<'m> {
    /// Reads nothing.
    ///
    /// # Errors
    /// None.
    pub fn open(_: &Blob<'m>, _: usize, _: usize) -> Result<Self, ModelError> {
        Ok(Verifier(PhantomData))
    }

    /// Takes everything, until [`by_fit`] has seen more.
    pub fn evaluate(&self, _: &[i8], _: usize) -> Confidence {
        Confidence {
            face: 1.0,
            landmarks: [1.0; LANDMARKS],
            visibility: [1.0; LANDMARKS],
        }
    }
}

/// Replaces a confidence by what a fit says of itself: `face`, and with it every landmark, from 1 where
/// the 3D face lies on the landmarks to 0 where it lies too far from them; `seen` by the head's own
/// shape. In place, for small stacks.
#[inline(never)]
pub fn by_fit(confidence: &mut Confidence, fitted: &FaceFit, camera: &Intrinsics) {
    let [a, b] = EYES.map(|k| fitted.points_mm.get(k).copied().unwrap_or_default());
    let eyes_mm = libm::sqrtf((b - a).length_squared());
    let eyes_px = eyes_mm * camera.fx / fitted.state.pose.translation_mm.z.max(1.0);
    let off = fitted.rms_px / (LIMIT * eyes_px).max(1e-6);
    confidence.face = (1.0 - off * off).max(0.0);
    confidence.landmarks.fill(confidence.face);
    for (seen, visible) in confidence.visibility.iter_mut().zip(fitted.visible) {
        *seen = f32::from(u8::from(visible));
    }
}
