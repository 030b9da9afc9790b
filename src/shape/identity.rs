//! Estimation of identity weights from many frames: normal equations that are summed over time.

use super::linear::{Observed, Residuals, System, UNKNOWNS, gradients};
use super::{FaceFit, FaceModel, Identity, Intrinsics, MAX_IDENTITIES};
use crate::math::solve_spd;

/// Weight of a video frame: below 1, because the errors of neighbouring frames are correlated.
pub const FRAME_WEIGHT: f32 = 0.2;

/// Bound on the sum of weights; beyond it, older frames decay exponentially.
const MEMORY: f32 = 2.4;

/// Largest identity weight \[standard deviations\].
const MAX_WEIGHT: f32 = 3.0;

/// Running normal equations of the identity weights, under the prior N(0, 1). Plain data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentityEstimator {
    matrix: [[f32; MAX_IDENTITIES]; MAX_IDENTITIES],
    rhs: Identity,
    /// Frames that were added.
    frames: u32,
    /// Sum of their weights after decay.
    information: f32,
    /// Bound on `information`.
    memory: f32,
}

impl Default for IdentityEstimator {
    fn default() -> Self {
        Self::new()
    }
}

impl IdentityEstimator {
    /// An estimator without frames, with the memory for a video.
    pub const fn new() -> Self {
        Self::with_memory(MEMORY)
    }

    /// An estimator without frames; they decay once the sum of their weights exceeds `memory`.
    pub const fn with_memory(memory: f32) -> Self {
        IdentityEstimator {
            matrix: [[0.0; MAX_IDENTITIES]; MAX_IDENTITIES],
            rhs: [0.0; MAX_IDENTITIES],
            frames: 0,
            information: 0.0,
            memory,
        }
    }

    /// Number of frames that were added.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Adds the normal equations of a fitted frame, with pose and animation marginalised. A frame
    /// whose system cannot be solved is ignored. `weight` is 1 for an independent image and
    /// [`FRAME_WEIGHT`] for a video frame.
    #[inline(never)]
    pub fn add(
        &mut self,
        face: &FaceModel<'_>,
        camera: &Intrinsics,
        observed: &Observed<'_>,
        fit: &FaceFit,
        weight: f32,
    ) {
        let state = &fit.state;
        let mut shape = face.neutral(&state.identity);
        face.animate(&mut shape, &state.animation);
        let mut system = System::EMPTY;
        let residuals = Residuals {
            face,
            camera,
            observed,
            state,
            shape: &shape,
            contour: &fit.contour,
            rotation: fit.rotation.as_ref(),
        };
        system.set(&residuals);
        let mut frame = Frame::new();
        residuals.rows(|row| {
            let mut identity = [[0.0; 2]; MAX_IDENTITIES];
            for (out, mode) in identity.iter_mut().zip(face.identity_modes(row.point)) {
                *out = row.by_head.map(|by_head| by_head.dot(mode));
            }
            frame.add(&identity, &gradients(face, &row), row.weight, row.residual);
        });
        if !frame.eliminate(&mut system) {
            return;
        }
        // The equations are those of a step from `state.identity`: shift them to absolute weights.
        for (rhs, row) in frame.rhs.iter_mut().zip(&frame.matrix) {
            *rhs += row
                .iter()
                .zip(&state.identity)
                .map(|(a, w)| a * w)
                .sum::<f32>();
        }
        let finite = frame
            .matrix
            .iter()
            .flatten()
            .chain(&frame.rhs)
            .all(|v| v.is_finite());
        if finite && weight > 0.0 {
            self.merge(&frame, weight);
        }
    }

    fn merge(&mut self, frame: &Frame, weight: f32) {
        let keep = (self.memory / (self.information + weight)).min(1.0);
        let mix = |sum: &mut f32, new: &f32| *sum = (*sum + weight * new) * keep;
        for (row, new) in self.matrix.iter_mut().zip(&frame.matrix) {
            row.iter_mut().zip(new).for_each(|(s, n)| mix(s, n));
        }
        self.rhs
            .iter_mut()
            .zip(&frame.rhs)
            .for_each(|(s, n)| mix(s, n));
        self.information = (self.information + weight) * keep;
        self.frames = self.frames.saturating_add(1);
    }

    /// The most probable identity so far; zeros without frames.
    #[inline(never)]
    pub fn estimate(&self) -> Identity {
        let mut matrix = self.matrix;
        let mut weights = self.rhs;
        for (i, row) in matrix.iter_mut().enumerate() {
            if let Some(diagonal) = row.get_mut(i) {
                *diagonal += 1.0;
            }
        }
        if !solve_spd(&mut matrix, &mut weights) {
            return [0.0; MAX_IDENTITIES];
        }
        weights.map(|w| {
            if w.is_finite() {
                w.clamp(-MAX_WEIGHT, MAX_WEIGHT)
            } else {
                0.0
            }
        })
    }
}

/// One frame's normal equations: the identity block, and its coupling to pose and animation.
struct Frame {
    matrix: [[f32; MAX_IDENTITIES]; MAX_IDENTITIES],
    coupling: [[f32; UNKNOWNS]; MAX_IDENTITIES],
    rhs: Identity,
}

impl Frame {
    fn new() -> Self {
        Frame {
            matrix: [[0.0; MAX_IDENTITIES]; MAX_IDENTITIES],
            coupling: [[0.0; UNKNOWNS]; MAX_IDENTITIES],
            rhs: [0.0; MAX_IDENTITIES],
        }
    }

    /// Adds a landmark: for both of its residuals, the derivatives by the identity, and those by
    /// animation and pose.
    fn add(
        &mut self,
        identity: &[[f32; 2]; MAX_IDENTITIES],
        gradients: &[[f32; UNKNOWNS]; 2],
        weight: f32,
        residual: [f32; 2],
    ) {
        let [first, second] = gradients;
        let blocks = self
            .matrix
            .iter_mut()
            .zip(&mut self.coupling)
            .zip(&mut self.rhs);
        for (((own, coupling), rhs), by_both) in blocks.zip(identity) {
            let [a, b] = by_both.map(|by_residual| weight * by_residual);
            *rhs += a * residual[0];
            *rhs += b * residual[1];
            for (sum, [of_first, of_second]) in own.iter_mut().zip(identity) {
                *sum += a * of_first;
                *sum += b * of_second;
            }
            for (sum, (of_first, of_second)) in coupling.iter_mut().zip(first.iter().zip(second)) {
                *sum += a * of_first;
                *sum += b * of_second;
            }
        }
    }

    /// Marginalises pose and animation (Schur complement). The system is solved in place; false
    /// when it is singular.
    fn eliminate(&mut self, system: &mut System) -> bool {
        let (factor, reduced) = (&mut system.matrix, &mut system.rhs);
        if !solve_spd(factor, reduced) {
            return false;
        }
        // coupling · A⁻¹ · rhs, with A⁻¹·rhs already solved.
        for (rhs, row) in self.rhs.iter_mut().zip(&self.coupling) {
            *rhs -= row
                .iter()
                .zip(reduced.iter())
                .map(|(c, r)| c * r)
                .sum::<f32>();
        }
        // Y = L⁻¹ · couplingᵀ, row by row in place; then matrix − Y·Yᵀ.
        for row in &mut self.coupling {
            for (i, factor_row) in factor.iter().enumerate() {
                let known = row.iter().zip(factor_row).take(i);
                let sum: f32 = known.map(|(y, l)| y * l).sum();
                let pivot = factor_row.get(i).copied().unwrap_or(1.0);
                if let Some(y) = row.get_mut(i) {
                    *y = (*y - sum) / pivot;
                }
            }
        }
        for (row, a) in self.matrix.iter_mut().zip(&self.coupling) {
            for (entry, b) in row.iter_mut().zip(&self.coupling) {
                *entry -= a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
            }
        }
        true
    }
}
