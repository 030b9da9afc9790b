//! What the caller gets: a fitted face as the result of a frame, the same smoothed, and events.

mod event;
mod one_euro;
mod result;

pub use event::{EVENTS, Event, EventKind, EventLog, EventRing};
pub use one_euro::Smoother;
pub use result::{Landmark, Loss, State, TrackResult};

use super::eyes::Eyes;
use super::fit::Fitted;
use super::geometry::{bounds, length};
use super::policy::{EYE_MAX_BLUR, EYE_MIN_FACING, EYE_MIN_VISIBILITY};
use super::step::Step;
use crate::shape::{ANIMATIONS, FARTHEST_MM, LANDMARKS, NEAREST_MM, Seen, Variances, eye_open};
use crate::verifier::Confidence;

/// Writes all of a result: of a face that moves by `blur_px` while the frame is exposed, at most.
pub fn write(
    to: &mut TrackResult,
    step: &Step<'_>,
    fitted: &Fitted<'_>,
    weights: &[f32; ANIMATIONS],
    seen_eyes: &Eyes,
    blur_px: f32,
) {
    let pose = &fitted.fit.state.pose;
    let (angles, facing) = (pose.angles(), pose.facing_angles());
    let variances = variances_of(step, fitted);
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
        eyes,
        facing_yaw_deg,
        facing_pitch_deg,
        facing_roll_deg,
        facing_sigma_deg,
        focal_px,
        camera_assumed,
        facing_angle_deg,
        interocular_px,
    } = to;
    *state = State::Tracking;
    (*timestamp_us, *age_us) = (step.now_us, 0);
    *confidence = fitted.confidence().face;
    *face_box = bounds(fitted.shape());
    *rotation = pose.quaternion();
    (*yaw_deg, *pitch_deg, *roll_deg) = (angles.yaw_deg, angles.pitch_deg, angles.roll_deg);
    *translation_mm = pose.translation_mm.to_array();
    *eye_open = openness(fitted, blur_px);
    *loss = None;
    *visible_share = fitted.confidence().visible_share();
    *rotation_sigma_deg = variances
        .rotation
        .map(|v| sigma(v, MAX_SIGMA_RAD).to_degrees());
    *translation_sigma_mm = variances.translation.map(|v| sigma(v, MAX_SIGMA_MM));
    write_landmarks(landmarks, fitted);
    for (out, p) in points_mm.iter_mut().zip(fitted.fit.points_mm.iter()) {
        *out = p.to_array();
    }
    *animation = *weights;
    (*facing_yaw_deg, *facing_pitch_deg, *facing_roll_deg) =
        (facing.yaw_deg, facing.pitch_deg, facing.roll_deg);
    *facing_sigma_deg = variances
        .facing
        .map(|v| sigma(v, MAX_SIGMA_RAD).to_degrees());
    (*focal_px, *camera_assumed) = (fitted.camera.fx, step.camera_assumed);
    *facing_angle_deg = pose.facing_angle_deg();
    *interocular_px = interocular(fitted);
    *eyes = *seen_eyes;
}

/// Distance between the outer eye corners, as a camera sees it that the face looks into \[px\].
fn interocular(fitted: &Fitted<'_>) -> f32 {
    let corner = |i: usize| fitted.fit.points_mm.get(i).copied().unwrap_or_default();
    let apart_mm = corner(RIGHT_EYE_CORNER).distance(corner(LEFT_EYE_CORNER));
    let away_mm = fitted.fit.state.pose.translation_mm.z.max(NEAREST_MM);
    apart_mm * fitted.camera.fx / away_mm
}

/// Landmarks of the outer corners of the person's eyes.
const RIGHT_EYE_CORNER: usize = 36;
const LEFT_EYE_CORNER: usize = 45;

/// Variances of the pose, by how it is seen.
fn variances_of(step: &Step<'_>, fitted: &Fitted<'_>) -> Variances {
    let seen = Seen {
        visible_share: fitted.confidence().visible_share(),
        confidence: fitted.confidence().face,
        focal_px: fitted.camera.fx,
        is_assumed: step.camera_assumed,
    };
    Variances::of(&fitted.fit.state.pose, &fitted.fit.covariance, &seen)
}

fn write_landmarks(to: &mut [Landmark; LANDMARKS], fitted: &Fitted<'_>) {
    let Confidence {
        landmarks,
        visibility,
        ..
    } = fitted.confidence();
    let values = fitted.shape().iter().zip(landmarks).zip(visibility);
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

/// Openness of the face's left and right eye; unknown for an eye that the head or something else
/// hides, so that a hand does not shut it, and for one that is blurred by motion.
#[inline(never)]
fn openness(fitted: &Fitted<'_>, blur_px: f32) -> [Option<f32>; 2] {
    let (fit, shape) = (fitted.fit, fitted.shape());
    let (face, camera) = (fitted.face, fitted.camera);
    let eye = |blink: usize, first: usize| {
        let points = fit.visible.iter().skip(first).take(6);
        let is_facing = points.filter(|v| **v).count() >= EYE_MIN_FACING;
        let visibility = fitted.confidence().visibility.iter().skip(first).take(6);
        let is_visible = visibility.sum::<f32>() >= EYE_MIN_VISIBILITY;
        let corner = |k: usize| shape.get(first + k).copied().unwrap_or_default();
        let ([ax, ay], [bx, by]) = (corner(0), corner(3));
        let is_sharp = blur_px <= EYE_MAX_BLUR * length([bx - ax, by - ay]);
        let open = eye_open(
            face,
            camera,
            &fit.state,
            &fitted.aligned.undistorted,
            first,
            blink,
        );
        open.filter(|_| is_facing && is_visible && is_sharp)
    };
    // browDown ×2, browInnerUp, browOuterUp ×2 come before eyeBlinkLeft, eyeBlinkRight.
    [eye(5, 42), eye(6, 36)]
}
