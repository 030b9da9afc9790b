//! A fitted face as the answer to a frame.

use super::place::bounds;
use super::{Landmark, State, TrackResult};
use crate::align::Shape;
use crate::experts::Verdict;
use crate::shape::FaceFit;

/// Writes all of a result.
pub(super) fn write(
    to: &mut TrackResult,
    now: i64,
    shape: &Shape,
    verdict: &Verdict,
    fitted: &FaceFit,
) {
    let pose = &fitted.state.pose;
    let angles = pose.angles();
    let TrackResult {
        state,
        timestamp_us,
        age_us,
        score,
        face_box,
        rotation,
        yaw_deg,
        pitch_deg,
        roll_deg,
        translation_mm,
        eye_open: eyes,
        landmarks,
        points_mm,
        animation,
    } = to;
    *state = State::Tracking;
    (*timestamp_us, *age_us) = (now, 0);
    *score = verdict.face;
    *face_box = bounds(shape);
    *rotation = pose.quaternion();
    (*yaw_deg, *pitch_deg, *roll_deg) = (angles.yaw_deg, angles.pitch_deg, angles.roll_deg);
    *translation_mm = pose.translation_mm.to_array();
    *eyes = eye_open(fitted);
    let parts = shape.iter().zip(&verdict.landmarks).zip(&fitted.visible);
    for (out, (([x, y], confidence), visible)) in landmarks.iter_mut().zip(parts) {
        let visibility = if *visible { 1.0 } else { 0.0 };
        *out = Landmark {
            x: *x,
            y: *y,
            confidence: *confidence,
            visibility,
        };
    }
    for (out, p) in points_mm.iter_mut().zip(&fitted.points_mm) {
        *out = p.to_array();
    }
    *animation = fitted.state.animation;
}

/// Openness of the subject's left and right eye from the animation; −1 for an eye that the head
/// hides.
fn eye_open(fitted: &FaceFit) -> [f32; 2] {
    let eye = |blink: usize, first: usize| {
        let seen = fitted
            .visible
            .iter()
            .skip(first)
            .take(6)
            .filter(|v| **v)
            .count();
        let closed = fitted.state.animation.get(blink).copied().unwrap_or(0.0);
        if seen >= 4 { 1.0 - closed } else { -1.0 }
    };
    // browDown ×2, browInnerUp, browOuterUp ×2 come before eyeBlinkLeft, eyeBlinkRight.
    [eye(5, 42), eye(6, 36)]
}
