//! A fitted face as the answer to a frame.

use super::motion::length;
use super::place::bounds;
use super::{Landmark, Loss, State, TrackResult};
use crate::align::Shape;
use crate::shape::{FaceFit, FaceModel, Intrinsics, LANDMARKS, eye_open};
use crate::verifier::Confidence;

/// An eye that moves farther than this while a frame is exposed, in its own widths, is a streak in
/// which open and shut look alike.
const STREAK: f32 = 0.6;

/// Writes all of a result. `blur_px`: how far the face may have moved while the frame was exposed.
pub(super) fn write(
    to: &mut TrackResult,
    now: i64,
    (face, camera): (&FaceModel<'_>, &Intrinsics),
    shape: &Shape,
    evaluated: &Confidence,
    fitted: &FaceFit,
    blur_px: f32,
) {
    let pose = &fitted.state.pose;
    let angles = pose.angles();
    let TrackResult {
        state,
        timestamp_us,
        age_us,
        confidence,
        face_box,
        rotation,
        yaw_deg,
        pitch_deg,
        roll_deg,
        translation_mm,
        eye_open,
        loss,
        visible_share,
        rotation_sigma_deg,
        translation_sigma_mm,
        landmarks,
        points_mm,
        animation,
    } = to;
    *state = State::Tracking;
    (*timestamp_us, *age_us) = (now, 0);
    *confidence = evaluated.face;
    *face_box = bounds(shape);
    *rotation = pose.quaternion();
    (*yaw_deg, *pitch_deg, *roll_deg) = (angles.yaw_deg, angles.pitch_deg, angles.roll_deg);
    *translation_mm = pose.translation_mm.to_array();
    *eye_open = eyes(face, camera, fitted, shape, evaluated, blur_px);
    *loss = Loss::None;
    *visible_share = evaluated.visibility.iter().sum::<f32>() / LANDMARKS as f32;
    let sigma = |k: usize| {
        let row = fitted.covariance.get(k);
        let variance = row.and_then(|row| row.get(k)).copied().unwrap_or(0.0);
        libm::sqrtf(variance.max(0.0))
    };
    *rotation_sigma_deg = [0, 1, 2].map(|k| sigma(k).to_degrees());
    *translation_sigma_mm = [3, 4, 5].map(sigma);
    let parts = shape
        .iter()
        .zip(&evaluated.landmarks)
        .zip(&evaluated.visibility);
    for (out, (([x, y], confidence), visibility)) in landmarks.iter_mut().zip(parts) {
        *out = Landmark {
            x: *x,
            y: *y,
            confidence: *confidence,
            visibility: *visibility,
        };
    }
    for (out, p) in points_mm.iter_mut().zip(fitted.points_mm.iter()) {
        *out = p.to_array();
    }
    *animation = fitted.state.animation;
}

/// Openness of the subject's left and right eye; −1 for an eye that is hidden by the head or by
/// something before it, so that a hand does not shut it, and for one that moves too fast to tell. Kept
/// apart, not inlined: two whole faces are on its stack.
#[inline(never)]
fn eyes(
    face: &FaceModel<'_>,
    camera: &Intrinsics,
    fitted: &FaceFit,
    shape: &Shape,
    evaluated: &Confidence,
    blur_px: f32,
) -> [f32; 2] {
    let neutral = face.neutral(&fitted.state.identity);
    let eye = |blink: usize, first: usize| {
        let lids = fitted.visible.iter().skip(first).take(6);
        let turned_here = lids.filter(|v| **v).count() >= 4;
        let seen: f32 = evaluated.visibility.iter().skip(first).take(6).sum();
        let corner = |k: usize| shape.get(first + k).copied().unwrap_or_default();
        let ([ax, ay], [bx, by]) = (corner(0), corner(3));
        let still = blur_px <= STREAK * length([bx - ax, by - ay]);
        let open = eye_open(face, camera, &fitted.state, &neutral, shape, first, blink);
        open.filter(|_| turned_here && seen >= 3.0 && still)
            .unwrap_or(-1.0)
    };
    // browDown ×2, browInnerUp, browOuterUp ×2 come before eyeBlinkLeft, eyeBlinkRight.
    [eye(5, 42), eye(6, 36)]
}
