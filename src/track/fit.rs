//! Last part of an attempt: the 3D face is fitted to the aligned landmarks.

use super::align::Aligned;
use super::policy::{
    ANCHOR_MIN_FACING, LEAST_TURN, MOST_TURN, MOST_TURN_SPEED, UNTRUSTED_KEEP_CONFIDENCE,
};
use super::step::Step;
use crate::align::Shape;
use crate::shape::{FaceFit, FaceModel, FaceState, FitOptions, Identity, Intrinsics, fit};
use crate::verifier::Confidence;

/// What is known of a face before it is fitted.
pub(super) struct Prior<'a> {
    /// The face on the frame before.
    pub(super) start: Option<&'a FaceState>,
    /// When that was \[µs\].
    pub(super) start_us: i64,
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

/// Whether the head has turned farther than one does since the frame before.
fn has_jumped(step: &Step<'_>, prior: &Prior<'_>, fit: &FaceFit) -> bool {
    prior.start.is_some_and(|before| {
        let nose = |face: &FaceState| face.pose.rotation.z_axis;
        let elapsed_s = step.now_us.saturating_sub(prior.start_us) as f32 * 1e-6;
        let most_turn = match before.pose.facing_cosine() < ANCHOR_MIN_FACING {
            true => (MOST_TURN_SPEED * elapsed_s).clamp(LEAST_TURN, MOST_TURN),
            false => MOST_TURN,
        };
        nose(before).dot(nose(&fit.state)) < libm::cosf(most_turn)
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
        if aligned.confidence.face < UNTRUSTED_KEEP_CONFIDENCE && has_jumped(step, prior, fit) {
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
