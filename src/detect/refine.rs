//! Moves a merged window onto the face: boosted regression on the same pixel comparisons.

use super::forest::PARALLEL_TREES;
use super::model::REFINE_OUTPUTS;
use super::{Detection, DetectorModel, Window};
use crate::image::Frame;

/// Value of one unit of the leaves' sums.
const UNIT: f32 = 1.0 / 4096.0;

/// The detection after the model's number of iterations, with `yaw` estimated; the score is kept.
/// Work: iterations × trees of the regression forest.
pub fn refine(model: &DetectorModel<'_>, frame: &Frame<'_>, start: &Detection) -> Detection {
    let mut refined = *start;
    for _ in 0..model.refiner.iterations {
        let window = window_of(model, &refined);
        let [right, down, log_size, roll, yaw] = regress(model, frame, &window);
        let (sin, cos) = (libm::sinf(refined.roll), libm::cosf(refined.roll));
        refined.x += refined.size * (cos * right - sin * down);
        refined.y += refined.size * (sin * right + cos * down);
        refined.size *= libm::expf(log_size.clamp(-0.5, 0.5));
        refined.roll += roll;
        refined.yaw = yaw.clamp(-1.0, 1.0);
    }
    refined
}

/// The window that the trees read for a detection.
pub(super) fn window_of(model: &DetectorModel<'_>, at: &Detection) -> Window {
    let q4 = |v: f32| libm::roundf(v * 16.0) as i32;
    let side = at.size * model.side_q8 as f32 / 256.0;
    Window::new(q4(at.x), q4(at.y), q4(side), at.roll)
}

/// The forest's prediction for a window: [`REFINE_OUTPUTS`] in their order.
fn regress(model: &DetectorModel<'_>, frame: &Frame<'_>, window: &Window) -> [f32; REFINE_OUTPUTS] {
    let refiner = &model.refiner;
    let mut sums = [0i32; REFINE_OUTPUTS];
    for first in (0..refiner.forest.trees()).step_by(PARALLEL_TREES) {
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
