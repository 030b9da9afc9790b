//! One Levenberg–Marquardt step of the fit, within bounds (Marquardt 1963, with his scaling of the
//! damping by the diagonal).

use super::FaceState;
use super::linear::{Matrix, System, UNKNOWNS};
use crate::math::solve_spd;
use glam::Vec3;

/// Longest translation of one step, relative to the distance from the camera.
const MAX_TRANSLATION: f32 = 0.3;
/// Largest rotation of one step \[rad\].
const MAX_ROTATION: f32 = 0.6;
/// Added to the diagonal, so that unknowns without any residual keep the matrix positive definite.
const DIAGONAL_OFFSET: f32 = 1e-6;

/// The state after one damped step; `None` when the system cannot be solved or the pose is not
/// valid.
#[inline(never)]
pub(super) fn stepped(from: &FaceState, system: &System, damping: f32) -> Option<FaceState> {
    let mut matrix = system.matrix;
    let mut step = system.rhs;
    for (i, row) in matrix.iter_mut().enumerate() {
        if let Some(diagonal) = row.get_mut(i) {
            *diagonal += *diagonal * damping + DIAGONAL_OFFSET;
        }
    }
    // Weights at a bound that the gradient points beyond stay there.
    for (i, w) in from.animation.iter().enumerate() {
        let descent = system.rhs.get(i).copied().unwrap_or(0.0);
        if (*w <= 0.0 && descent < 0.0) || (*w >= 1.0 && descent > 0.0) {
            fix(&mut matrix, &mut step, i);
        }
    }
    if !solve_spd(&mut matrix, &mut step) || step.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let mut state = *from;
    for (w, d) in state.animation.iter_mut().zip(step) {
        *w = (*w + d).clamp(0.0, 1.0);
    }
    let [.., rx, ry, rz, tx, ty, tz] = step;
    let depth = state.pose.translation_mm.z;
    let rotation = shortened(Vec3::new(rx, ry, rz), MAX_ROTATION);
    let translation = shortened(Vec3::new(tx, ty, tz), MAX_TRANSLATION * depth);
    state.pose = state.pose.moved(rotation, translation);
    state.pose.is_valid().then_some(state)
}

/// Removes one unknown from a system: its step becomes 0.
fn fix(matrix: &mut Matrix, rhs: &mut [f32; UNKNOWNS], unknown: usize) {
    for (i, (row, r)) in matrix.iter_mut().zip(rhs).enumerate() {
        if i == unknown {
            row.fill(0.0);
            *r = 0.0;
        }
        if let Some(entry) = row.get_mut(unknown) {
            *entry = if i == unknown { 1.0 } else { 0.0 };
        }
    }
}

/// The vector, at most `longest` long.
fn shortened(v: Vec3, longest: f32) -> Vec3 {
    let length = v.length();
    if length > longest {
        v * (longest / length)
    } else {
        v
    }
}
