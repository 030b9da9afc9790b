//! Boxes, centres and widths of shapes, and the way from a shape to a detection and back.

use super::Model;
use super::policy::SAME_FACE;
use crate::align::Shape;
use crate::detect::Detection;
use crate::image::{Frame, Roi};
use crate::math::Similarity;
use crate::shape::LANDMARKS;
use glam::Vec3;

/// Places the upright canonical shape of a view in a detection's box.
pub(super) fn initial_shape(canonical: &Shape, face: &Detection) -> Option<Shape> {
    let [x, y, width, height] = bounds(canonical);
    let scale = face.size / width.max(height);
    let (a, b) = (scale * libm::cosf(face.roll), scale * libm::sinf(face.roll));
    let to_frame = Similarity {
        a,
        b,
        tx: face.x,
        ty: face.y,
    };
    to_frame.inverse()?;
    let (cx, cy) = (x + width / 2.0, y + height / 2.0);
    Some(canonical.map(|p| to_frame.apply([p[0] - cx, p[1] - cy])))
}

/// A shape as the detector would report it: centre, size and roll.
#[inline(never)]
pub(super) fn detection_of(model: &Model<'_>, shape: &Shape) -> Detection {
    let roll = model.align.views().of(shape).map_or(0.0, |view| view.roll);
    let to_frame = Similarity {
        a: libm::cosf(roll),
        b: libm::sinf(roll),
        tx: 0.0,
        ty: 0.0,
    };
    let to_upright = Similarity {
        b: -to_frame.b,
        ..to_frame
    };
    let [x, y, width, height] = bounds(&shape.map(|p| to_upright.apply(p)));
    let [x, y] = to_frame.apply([x + width / 2.0, y + height / 2.0]);
    Detection {
        x,
        y,
        size: width.max(height),
        roll,
        ..Detection::default()
    }
}

/// Axis-aligned box: x, y, width, height.
pub(super) fn bounds(shape: &[[f32; 2]]) -> [f32; 4] {
    let mut low = [f32::MAX; 2];
    let mut high = [f32::MIN; 2];
    for [x, y] in shape {
        low = [low[0].min(*x), low[1].min(*y)];
        high = [high[0].max(*x), high[1].max(*y)];
    }
    [low[0], low[1], high[0] - low[0], high[1] - low[1]]
}

/// Whether a box (left, top, width, height) is around the same face as another one: its centre is
/// near the other's.
pub fn is_same_face(face: &[f32; 4], other: &[f32; 4]) -> bool {
    let centre = |[x, y, width, height]: &[f32; 4]| [x + width / 2.0, y + height / 2.0];
    let ([x, y], [u, v]) = (centre(face), centre(other));
    let [_, _, width, height] = other;
    libm::hypotf(x - u, y - v) < SAME_FACE * width.max(*height)
}

/// Centre of the axis-aligned box.
pub(super) fn centre(shape: &Shape) -> [f32; 2] {
    let [x, y, width, height] = bounds(shape);
    [x + width / 2.0, y + height / 2.0]
}

/// Whether the centre of the face is in the frame.
pub(super) fn is_in_frame(shape: &Shape, frame: &Frame<'_>) -> bool {
    Roi::whole(frame).contains(centre(shape))
}

pub(super) fn length([x, y]: [f32; 2]) -> f32 {
    libm::sqrtf(x * x + y * y)
}

/// Mean of the landmarks.
pub(super) fn centroid(shape: &Shape) -> [f32; 2] {
    let n = LANDMARKS as f32;
    shape
        .iter()
        .fold([0.0, 0.0], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n])
}

/// Width of the face, the same at every roll: twice the mean distance from the centroid.
pub(super) fn face_width(shape: &Shape) -> f32 {
    let [cx, cy] = centroid(shape);
    let sum: f32 = shape.iter().map(|[x, y]| length([x - cx, y - cy])).sum();
    2.0 * sum / LANDMARKS as f32
}

/// Angles of a gaze in the head frame to the person's left and down \[rad\].
pub(super) fn gaze_angles(gaze: Vec3) -> [f32; 2] {
    let across = libm::sqrtf(gaze.x * gaze.x + gaze.z * gaze.z);
    [libm::atan2f(gaze.x, -gaze.z), libm::atan2f(gaze.y, across)]
}
