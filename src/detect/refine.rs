//! Moves a merged window onto the face: boosted regression on the same pixel comparisons.

use super::forest::ABREAST;
use super::model::REFINE_OUTPUTS;
use super::{Detection, DetectorModel, Window};
use crate::image::Frame;

/// One unit of the leaves' sums.
const UNIT: f32 = 1.0 / 4096.0;

/// The detection after the model's number of rounds, with `yaw` filled in; the score is kept.
/// Work: rounds × trees of the refining forest.
pub fn refine(model: &DetectorModel<'_>, frame: &Frame<'_>, start: &Detection) -> Detection {
    let mut found = *start;
    for _ in 0..model.refiner.rounds {
        let window = window_of(model, &found);
        let [right, down, log_size, roll, yaw] = sums(model, frame, &window);
        let (sin, cos) = (libm::sinf(found.roll), libm::cosf(found.roll));
        found.x += found.size * (cos * right - sin * down);
        found.y += found.size * (sin * right + cos * down);
        found.size *= libm::expf(log_size.clamp(-0.5, 0.5));
        found.roll += roll;
        found.yaw = yaw.clamp(-1.0, 1.0);
    }
    found
}

/// The window that the trees look at for a detection.
pub(super) fn window_of(model: &DetectorModel<'_>, at: &Detection) -> Window {
    let q4 = |v: f32| libm::roundf(v * 16.0) as i32;
    let side = at.size * model.side_q8 as f32 / 256.0;
    Window::new(q4(at.x), q4(at.y), q4(side), at.roll)
}

/// The forest's answer for a window.
fn sums(model: &DetectorModel<'_>, frame: &Frame<'_>, window: &Window) -> [f32; REFINE_OUTPUTS] {
    let refiner = &model.refiner;
    let mut sums = [0i32; REFINE_OUTPUTS];
    for first in (0..refiner.forest.trees()).step_by(ABREAST) {
        let reached = (refiner.forest).walk(first, |pixel| window.read(frame, pixel));
        for (tree, leaf) in (first..refiner.forest.trees()).zip(reached) {
            let at = (tree * refiner.forest.leaves() + leaf) * REFINE_OUTPUTS;
            let values = refiner.leaves.get(at..).unwrap_or(&[]);
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += *value as i32;
            }
        }
    }
    sums.map(|sum| sum as f32 * UNIT)
}
