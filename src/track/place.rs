//! Where shapes and detections lie: from one to the other.

use super::Model;
use crate::align::Shape;
use crate::detect::Detection;
use crate::image::Frame;
use crate::math::Similarity;

/// Puts an upright canonical start shape into a detection's box.
pub(super) fn start_in(start: &Shape, face: &Detection) -> Option<Shape> {
    let [x, y, width, height] = bounds(start);
    let scale = face.size / width.max(height);
    let (a, b) = (scale * libm::cosf(face.roll), scale * libm::sinf(face.roll));
    let turn = Similarity {
        a,
        b,
        tx: face.x,
        ty: face.y,
    };
    turn.inverse()?;
    let (cx, cy) = (x + width / 2.0, y + height / 2.0);
    Some(start.map(|p| turn.apply([p[0] - cx, p[1] - cy])))
}

/// The detector's box of a shape.
#[inline(never)]
pub(super) fn place_of(model: &Model<'_>, shape: &Shape) -> Detection {
    let roll = model.align.views().of(shape).map_or(0.0, |view| view.roll);
    let forth = Similarity {
        a: libm::cosf(roll),
        b: libm::sinf(roll),
        tx: 0.0,
        ty: 0.0,
    };
    let back = Similarity {
        b: -forth.b,
        ..forth
    };
    let [x, y, width, height] = bounds(&shape.map(|p| back.apply(p)));
    let [x, y] = forth.apply([x + width / 2.0, y + height / 2.0]);
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

/// Whether the middle of the face is in the frame.
pub(super) fn overlaps(shape: &Shape, frame: &Frame<'_>) -> bool {
    let [x, y, width, height] = bounds(shape);
    let (cx, cy) = (x + width / 2.0, y + height / 2.0);
    cx >= 0.0 && cy >= 0.0 && cx <= frame.width() as f32 && cy <= frame.height() as f32
}
