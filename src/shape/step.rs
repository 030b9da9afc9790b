//! One Levenberg–Marquardt step of the fit, within bounds.

use super::FaceState;
use super::linear::{System, UNKNOWNS};
use crate::math::solve_spd;
use glam::Vec3;

/// Longest shift of one step, as a share of the distance from the camera.
const MAX_SHIFT: f32 = 0.3;
/// Longest turn of one step \[rad\].
const MAX_TURN: f32 = 0.6;

/// One damped step, or `None` when the system cannot be solved or the pose leaves all bounds.
#[inline(never)]
pub(super) fn stepped(from: &FaceState, system: &System, damping: f32) -> Option<FaceState> {
    let mut matrix = system.matrix;
    let mut step = system.rhs;
    for (i, row) in matrix.iter_mut().enumerate() {
        if let Some(diagonal) = row.get_mut(i) {
            *diagonal += *diagonal * damping + 1e-6;
        }
    }
    // Weights at a bound that the descent would cross stay there.
    for (i, w) in from.animation.iter().enumerate() {
        let push = system.rhs.get(i).copied().unwrap_or(0.0);
        if (*w <= 0.0 && push < 0.0) || (*w >= 1.0 && push > 0.0) {
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
    let turn = shortened(Vec3::new(rx, ry, rz), MAX_TURN);
    let shift = shortened(Vec3::new(tx, ty, tz), MAX_SHIFT * depth);
    state.pose = state.pose.moved(turn, shift);
    state.pose.is_valid().then_some(state)
}

/// Takes one unknown out of a system.
fn fix(matrix: &mut [[f32; UNKNOWNS]; UNKNOWNS], rhs: &mut [f32; UNKNOWNS], unknown: usize) {
    for (i, (row, r)) in matrix.iter_mut().zip(rhs).enumerate() {
        if i == unknown {
            *row = [0.0; UNKNOWNS];
            *r = 0.0;
        }
        if let Some(entry) = row.get_mut(unknown) {
            *entry = if i == unknown { 1.0 } else { 0.0 };
        }
    }
}

fn shortened(v: Vec3, longest: f32) -> Vec3 {
    let length = libm::sqrtf(v.length_squared());
    if length > longest {
        v * (longest / length)
    } else {
        v
    }
}
