//! Eye opening, from the distance of the lids in the image.

use super::{FaceModel, FaceState, Intrinsics, LANDMARKS, Project};
use glam::Vec3;

/// Pairs of upper and lower lid landmarks, relative to the first landmark of the eye.
const LIDS: [[usize; 2]; 2] = [[1, 5], [2, 4]];
/// Measured opening of a shut eye, relative to an open one: the networks place poorly visible lids
/// slightly apart. Measured on 87 shut and 1442 open eyes of rendered faces outside the training
/// set: means of 0.121 and 0.747, a ratio of 0.16.
pub(crate) const SHUT: f32 = 0.16;
/// Least difference of the lid distance between an open and a shut eye, over the eye's width: below
/// it, the eye is seen too much from the side.
const MIN_RANGE: f32 = 0.08;

/// Opening of the eye whose first landmark is `first` (36 or 42) and whose lids the animation
/// weight `blink` closes: 0 shut, 1 open at rest. It is the observed distance of the lids (px,
/// along the eye's vertical) relative to the distances of this person's eye, shut and at rest,
/// projected at the fitted pose. `observed` are the landmarks (frame px).
///
/// The animation weight itself has a smaller range, because its prior pulls poorly visible lids
/// open. `None` when the eye is seen too much from the side.
pub fn eye_open(
    face: &FaceModel<'_>,
    camera: &Intrinsics,
    state: &FaceState,
    observed: &[[f32; 2]; LANDMARKS],
    first: usize,
    blink: usize,
) -> Option<f32> {
    let project = |point: Vec3| camera.project(state.pose.apply(point));
    let factors = &face.identity_factors(&state.identity);
    let at_rest = |k: usize| face.neutral_point(first + k, factors);
    let shut = |k: usize| at_rest(k) + face.animation_mode(first + k, blink);
    let sum = |point: &dyn Fn(usize) -> [f32; 2]| {
        LIDS.iter().fold([0.0f32; 2], |sum, [upper, lower]| {
            let (a, b) = (point(*upper), point(*lower));
            [sum[0] + b[0] - a[0], sum[1] + b[1] - a[1]]
        })
    };
    let rest = sum(&|k| project(at_rest(k)));
    let length = libm::sqrtf(rest[0] * rest[0] + rest[1] * rest[1]);
    let (a, b) = (project(at_rest(0)), project(at_rest(3)));
    let width = libm::sqrtf((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
    let along = |gap: [f32; 2]| (gap[0] * rest[0] + gap[1] * rest[1]) / length;
    let least = along(sum(&|k| project(shut(k))));
    let range = length - least;
    if range.is_nan() || range <= MIN_RANGE * width {
        return None;
    }
    let gap = along(sum(&|k| {
        observed.get(first + k).copied().unwrap_or_default()
    }));
    let open = (gap - least) / range;
    Some(((open - SHUT) / (1.0 - SHUT)).clamp(0.0, 1.0))
}
