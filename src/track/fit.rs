//! Last part of an attempt: the 3D face is fitted to the aligned landmarks.

use super::align::Aligned;
use super::policy::{MOST_TURN_COSINE, UNTRUSTED_KEEP_CONFIDENCE};
use super::step::Step;
use crate::align::Shape;
use crate::shape::{FaceFit, FaceModel, FaceState, FitOptions, Identity, Intrinsics, fit};
use crate::verifier::Confidence;

/// What is known of a face before it is fitted.
pub(super) struct Prior<'a> {
    /// The face on the frame before.
    pub(super) start: Option<&'a FaceState>,
    pub(super) identity: Identity,
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
}

/// Whether the head faces elsewhere than on the frame before.
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
    /// `None` for a face of low confidence that turns as no head does from one frame to the next.
    /// All else the classifiers have judged before.
    pub(super) fn new(
        step: &'a Step<'_>,
        aligned: &'a Aligned,
        fit: &'a FaceFit,
        prior: &Prior<'_>,
    ) -> Option<Fitted<'a>> {
        if aligned.confidence.face < UNTRUSTED_KEEP_CONFIDENCE && has_jumped(prior, fit) {
            return None;
        }
        Some(Fitted {
            face: &step.model.face,
            camera: &step.camera,
            aligned,
            fit,
        })
    }

    /// The landmarks in the picture.
    pub(super) fn shape(&self) -> &Shape {
        &self.aligned.shape
    }

    /// That of the classifiers.
    pub(super) fn confidence(&self) -> &Confidence {
        &self.aligned.confidence
    }
}
