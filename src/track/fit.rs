//! Last part of an attempt: the 3D face is fitted to the aligned landmarks.

use super::align::Aligned;
#[cfg(feature = "verifier")]
use super::policy::{MOST_TURN_COSINE, UNTRUSTED_KEEP_CONFIDENCE};
use super::step::Step;
use crate::align::Shape;
use crate::shape::{FaceFit, FaceModel, FaceState, FitOptions, Identity, Intrinsics, fit};
use crate::verifier::Confidence;
#[cfg(not(feature = "verifier"))]
use crate::verifier::geometric_confidence;

/// What is known of a face before it is fitted.
pub(super) struct Prior<'a> {
    /// The face on the frame before.
    pub(super) start: Option<&'a FaceState>,
    pub(super) identity: Identity,
    /// Confidence by geometry alone from which the fit is one of a face.
    #[cfg(not(feature = "verifier"))]
    pub(super) min_confidence: f32,
}

/// Fits the 3D face to an alignment. `None` when no pose explains the landmarks.
#[inline(never)]
pub(super) fn fit_face(step: &Step<'_>, aligned: &Aligned, prior: &Prior<'_>) -> Option<FaceFit> {
    let (face, observed) = (&step.model.face, &aligned.observed());
    let options = &FitOptions {
        rotation: aligned.rotation,
        ..FitOptions::default()
    };
    let (start, identity) = (prior.start, &prior.identity);
    fit(face, &step.camera, observed, start, identity, options)
}

/// An alignment and the 3D face that explains it: all that target, keyframes, eyes and result take
/// of a frame.
pub(super) struct Fitted<'a> {
    pub(super) face: &'a FaceModel<'a>,
    pub(super) camera: &'a Intrinsics,
    pub(super) aligned: &'a Aligned,
    pub(super) fit: &'a FaceFit,
    /// How well the 3D face fits.
    #[cfg(not(feature = "verifier"))]
    geometric: Confidence,
}

/// Whether the head faces elsewhere than on the frame before.
#[cfg(feature = "verifier")]
fn has_jumped(prior: &Prior<'_>, fit: &FaceFit) -> bool {
    prior.start.is_some_and(|before| {
        let cosine = before
            .pose
            .rotation
            .z_axis
            .dot(fit.state.pose.rotation.z_axis);
        cosine < MOST_TURN_COSINE
    })
}

impl<'a> Fitted<'a> {
    /// `None` where the 3D face does not fit as that of a face does. The classifiers have judged
    /// that before, but for a face of low confidence that turns as no head does from one frame to
    /// the next; without them every alignment is fitted.
    pub(super) fn new(
        step: &'a Step<'_>,
        aligned: &'a Aligned,
        fit: &'a FaceFit,
        prior: &Prior<'_>,
    ) -> Option<Fitted<'a>> {
        #[cfg(feature = "verifier")]
        if aligned.confidence.face < UNTRUSTED_KEEP_CONFIDENCE && has_jumped(prior, fit) {
            return None;
        }
        #[cfg(not(feature = "verifier"))]
        let geometric = geometric_confidence(fit, &step.camera);
        #[cfg(not(feature = "verifier"))]
        if geometric.face < prior.min_confidence {
            return None;
        }
        Some(Fitted {
            face: &step.model.face,
            camera: &step.camera,
            aligned,
            fit,
            #[cfg(not(feature = "verifier"))]
            geometric,
        })
    }

    /// The landmarks in the picture.
    pub(super) fn shape(&self) -> &Shape {
        &self.aligned.shape
    }

    /// That of the classifiers; without them, by geometry.
    pub(super) fn confidence(&self) -> &Confidence {
        #[cfg(feature = "verifier")]
        return &self.aligned.confidence;
        #[cfg(not(feature = "verifier"))]
        return &self.geometric;
    }
}
