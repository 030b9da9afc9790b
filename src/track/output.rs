//! A fitted face, written as the result of a frame.

use super::geometry::{bounds, length};
use super::policy::{EYE_MAX_BLUR, EYE_MIN_FACING, EYE_MIN_VISIBILITY};
use super::{Landmark, Loss, State, TrackResult};
use crate::align::Shape;
use crate::shape::{FARTHEST_MM, FaceFit, FaceModel, Intrinsics, LANDMARKS, eye_open};
use crate::shape::{Seen, Variances};
use crate::verifier::Confidence;

/// Everything that a result is made of.
pub(super) struct Fitted<'a> {
    pub(super) face: &'a FaceModel<'a>,
    pub(super) camera: &'a Intrinsics,
    /// Whether that is the default one.
    pub(super) camera_assumed: bool,
    /// The landmarks in the picture.
    pub(super) shape: &'a Shape,
    /// The landmarks where a pinhole camera would show them.
    pub(super) undistorted: &'a Shape,
    pub(super) confidence: &'a Confidence,
    pub(super) fit: &'a FaceFit,
    /// How far the face moves while the frame is exposed, at most \[px\].
    pub(super) blur_px: f32,
}

/// Writes all of a result.
pub(super) fn write(to: &mut TrackResult, now_us: i64, fitted: &Fitted<'_>) {
    let pose = &fitted.fit.state.pose;
    let (angles, facing) = (pose.angles(), pose.facing_angles());
    let visible = fitted.confidence.visible_share();
    let seen = Seen {
        visible_share: visible,
        confidence: fitted.confidence.face,
        focal_px: fitted.camera.fx,
        is_assumed: fitted.camera_assumed,
    };
    let variances = Variances::of(pose, &fitted.fit.covariance, &seen);
    // Every field by name: a new one does not compile until it is written.
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
        // By what is seen in the picture: see `eyes`.
        eyes: _,
        facing_yaw_deg,
        facing_pitch_deg,
        facing_roll_deg,
        facing_sigma_deg,
        focal_px,
        camera_assumed,
    } = to;
    *state = State::Tracking;
    (*timestamp_us, *age_us) = (now_us, 0);
    *confidence = fitted.confidence.face;
    *face_box = bounds(fitted.shape);
    *rotation = pose.quaternion();
    (*yaw_deg, *pitch_deg, *roll_deg) = (angles.yaw_deg, angles.pitch_deg, angles.roll_deg);
    *translation_mm = pose.translation_mm.to_array();
    *eye_open = eyes(fitted);
    *loss = Loss::None;
    *visible_share = visible;
    *rotation_sigma_deg = variances
        .rotation
        .map(|v| sigma(v, MAX_SIGMA_RAD).to_degrees());
    *translation_sigma_mm = variances.translation.map(|v| sigma(v, MAX_SIGMA_MM));
    write_landmarks(landmarks, fitted);
    for (out, p) in points_mm.iter_mut().zip(fitted.fit.points_mm.iter()) {
        *out = p.to_array();
    }
    *animation = fitted.fit.state.animation;
    (*facing_yaw_deg, *facing_pitch_deg, *facing_roll_deg) =
        (facing.yaw_deg, facing.pitch_deg, facing.roll_deg);
    *facing_sigma_deg = variances
        .facing
        .map(|v| sigma(v, MAX_SIGMA_RAD).to_degrees());
    (*focal_px, *camera_assumed) = (fitted.camera.fx, fitted.camera_assumed);
}

fn write_landmarks(to: &mut [Landmark; LANDMARKS], fitted: &Fitted<'_>) {
    let Confidence {
        landmarks,
        visibility,
        ..
    } = fitted.confidence;
    let values = fitted.shape.iter().zip(landmarks).zip(visibility);
    for (out, (([x, y], confidence), visibility)) in to.iter_mut().zip(values) {
        *out = Landmark {
            x: *x,
            y: *y,
            confidence: *confidence,
            visibility: *visibility,
        };
    }
}

/// Largest standard deviation of a rotation \[rad\]: half a turn, nothing is known.
const MAX_SIGMA_RAD: f32 = core::f32::consts::PI;
/// Largest standard deviation of a position \[mm\]: as far as the farthest head.
const MAX_SIGMA_MM: f32 = FARTHEST_MM;

/// Root of a variance; `most` where the landmarks leave the unknown undetermined.
fn sigma(variance: f32, most: f32) -> f32 {
    // Not for a NaN.
    match variance < most * most {
        true => libm::sqrtf(variance.max(0.0)),
        false => most,
    }
}

/// Openness of the face's left and right eye; −1 (unknown) for an eye that the head or something
/// else hides, so that a hand does not shut it, and for one that is blurred by motion.
#[inline(never)]
fn eyes(fitted: &Fitted<'_>) -> [f32; 2] {
    let Fitted {
        face,
        camera,
        shape,
        undistorted,
        fit,
        ..
    } = fitted;
    let eye = |blink: usize, first: usize| {
        let points = fit.visible.iter().skip(first).take(6);
        let is_facing = points.filter(|v| **v).count() >= EYE_MIN_FACING;
        let visibility = fitted.confidence.visibility.iter().skip(first).take(6);
        let is_visible = visibility.sum::<f32>() >= EYE_MIN_VISIBILITY;
        let corner = |k: usize| shape.get(first + k).copied().unwrap_or_default();
        let ([ax, ay], [bx, by]) = (corner(0), corner(3));
        let is_sharp = fitted.blur_px <= EYE_MAX_BLUR * length([bx - ax, by - ay]);
        let open = eye_open(face, camera, &fit.state, undistorted, first, blink);
        open.filter(|_| is_facing && is_visible && is_sharp)
            .unwrap_or(-1.0)
    };
    // browDown ×2, browInnerUp, browOuterUp ×2 come before eyeBlinkLeft, eyeBlinkRight.
    [eye(5, 42), eye(6, 36)]
}
