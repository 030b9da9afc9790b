//! How far the eyes are open, from the lids in the image.

use super::{ANIMATIONS, FaceModel, FaceState, Intrinsics, LANDMARKS, Shape};

/// First landmark of an eye; upper and lower lid are at +1 and +5, +2 and +4.
const LIDS: [[usize; 2]; 2] = [[1, 5], [2, 4]];
/// Where shut eyes end up on the way from shut to open: the networks leave lids that they see badly a
/// little open. Measured on 87 shut and 1442 open eyes of rendered faces that training never saw:
/// means of 0.121 and 0.747, the first is 0.16 of the second.
const SHUT: f32 = 0.16;
/// Narrowest opening, over the width of the eye, that says anything: an eye seen from the side.
const NARROWEST: f32 = 0.08;

/// Openness of the eye whose first landmark is `first` (36 or 42) and whose lids the animation weight
/// `blink` closes: where the observed gap between the lids (px, along the eye's own vertical) lies
/// between those of this person's eye shut (0) and at rest (1) at the fitted pose. `neutral` is the
/// person's face at rest, [`FaceModel::neutral`].
///
/// The animation weight itself follows less far, because the prior on it pulls half-seen lids open.
/// `None` where perspective leaves too little of the eye.
pub fn eye_open(
    face: &FaceModel<'_>,
    camera: &Intrinsics,
    state: &FaceState,
    neutral: &Shape,
    observed: &[[f32; 2]; LANDMARKS],
    first: usize,
    blink: usize,
) -> Option<f32> {
    let mut closed = [0.0; ANIMATIONS];
    *closed.get_mut(blink)? = 1.0;
    let shut = face.animated(neutral, &closed);
    let project = |shape: &Shape, k: usize| camera.project(state.pose.apply(shape.at(first + k)));
    let sum = |point: &dyn Fn(usize) -> [f32; 2]| {
        LIDS.iter().fold([0.0f32; 2], |sum, [upper, lower]| {
            let (a, b) = (point(*upper), point(*lower));
            [sum[0] + b[0] - a[0], sum[1] + b[1] - a[1]]
        })
    };
    let rest = sum(&|k| project(neutral, k));
    let length = libm::sqrtf(rest[0] * rest[0] + rest[1] * rest[1]);
    let (a, b) = (project(neutral, 0), project(neutral, 3));
    let width = libm::sqrtf((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
    let along = |gap: [f32; 2]| (gap[0] * rest[0] + gap[1] * rest[1]) / length;
    let least = along(sum(&|k| project(&shut, k)));
    let room = length - least;
    if room.is_nan() || room <= NARROWEST * width {
        return None;
    }
    let gap = along(sum(&|k| {
        observed.get(first + k).copied().unwrap_or_default()
    }));
    let open = (gap - least) / room;
    Some(((open - SHUT) / (1.0 - SHUT)).clamp(0.0, 1.0))
}
