//! Estimation of identity weights from many frames: normal equations that are summed over time.

use super::identity_record::{MAX_PRECISION, MAX_WEIGHT};
use super::linear::{Gradients, Observed, ROW, Residuals, Row, System};
use super::{FaceFit, FaceModel, Guess, Identity, Intrinsics, MAX_IDENTITIES};
use crate::math::{dot, solve_spd};
use glam::Vec4;

/// Weight of a video frame: below 1, because the errors of neighbouring frames are correlated.
pub const FRAME_WEIGHT: f32 = 0.2;

/// Bound on the sum of weights; beyond it, older frames decay exponentially.
const MEMORY: f32 = 2.4;

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
    /// What a record says.
    guess: Guess,
    /// How much of that counts.
    guess_weight: f32,
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
            guess: Guess::NONE,
            guess_weight: 0.0,
        }
    }

    /// Guesses that the person is that of a record. Each frame that is added takes a part of the
    /// guess away, as frames take away what was before them.
    pub(crate) fn guess(&mut self, guess: &Guess) {
        self.guess = *guess;
        self.guess_weight = 1.0;
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
            let mut identity = [[0.0; MAX_IDENTITIES]; 2];
            let [first, second] = &mut identity;
            let modes = face.identity_modes(row.point);
            for ((a, b), mode) in first.iter_mut().zip(second).zip(modes) {
                *a = row.by_head[0].dot(mode);
                *b = row.by_head[1].dot(mode);
            }
            frame.add(&identity, &Gradients::new(face, &row), &row);
        });
        if !frame.eliminate(&mut system) {
            return;
        }
        // The equations are those of a step from `state.identity`: shift them to absolute weights.
        for (rhs, row) in frame.rhs.iter_mut().zip(&frame.matrix) {
            *rhs += dot(row, &state.identity);
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
        self.guess_weight *= self.memory / (self.memory + weight);
        self.frames = self.frames.saturating_add(1);
    }

    /// The most probable identity so far; zeros without frames and guess.
    #[inline(never)]
    pub fn estimate(&self) -> Identity {
        let mut matrix = self.matrix;
        let mut weights = self.rhs;
        let (add, towards) = self.prior();
        add_to_diagonal(&mut matrix, &add);
        weights.iter_mut().zip(towards).for_each(|(w, t)| *w += t);
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

    /// What is known without frames: what is added to the diagonal, and to the right-hand side.
    fn prior(&self) -> (Identity, Identity) {
        let Guess { mean, precision } = &self.guess;
        let mut add = [1.0; MAX_IDENTITIES];
        let mut towards = [0.0; MAX_IDENTITIES];
        let both = add.iter_mut().zip(&mut towards);
        for ((add, towards), (mean, precision)) in both.zip(mean.iter().zip(precision)) {
            let weight = self.guess_weight * precision;
            *add += weight;
            *towards = *mean * (weight + self.guess_weight);
        }
        (add, towards)
    }

    /// What frames and guess say so far, for the next time.
    #[inline(never)]
    pub(crate) fn learnt(&self) -> Guess {
        Guess {
            mean: self.estimate(),
            precision: self.precision(),
        }
    }

    /// By mode, one over the variance of the estimate, beyond that of all people.
    #[inline(never)]
    fn precision(&self) -> Identity {
        let mut matrix = self.matrix;
        add_to_diagonal(&mut matrix, &self.prior().0);
        let mut precisions = [0.0; MAX_IDENTITIES];
        if !solve_spd(&mut matrix, &mut [0.0; MAX_IDENTITIES]) {
            return precisions;
        }
        // The columns of L⁻¹, whose squares sum up to the diagonal of (L·Lᵀ)⁻¹.
        for (k, precision) in precisions.iter_mut().enumerate() {
            let mut column = [0.0; MAX_IDENTITIES];
            for (i, row) in matrix.iter().enumerate().skip(k) {
                let unit = if i == k { 1.0 } else { 0.0 };
                let known = column.get(..i).unwrap_or_default();
                let sum = unit - dot(row.get(..i).unwrap_or_default(), known);
                if let (Some(to), Some(pivot)) = (column.get_mut(i), row.get(i)) {
                    *to = sum / pivot;
                }
            }
            let variance = dot(&column, &column);
            *precision = (1.0 / variance.max(1e-6) - 1.0).clamp(0.0, MAX_PRECISION);
        }
        precisions
    }

    /// How much more likely the frames are for the person of a record than for anybody, as a
    /// logarithm, without what was guessed.
    #[inline(never)]
    pub(crate) fn evidence(&self, of: &Guess) -> f32 {
        let precision = of.precision.map(|p| p + 1.0);
        self.likelihood(&of.mean, &precision)
            - self.likelihood(&[0.0; MAX_IDENTITIES], &[1.0; MAX_IDENTITIES])
    }

    /// Logarithm of the likelihood of the frames, but for a constant, of people whose weights have
    /// these means and precisions.
    #[inline(never)]
    fn likelihood(&self, mean: &Identity, precision: &Identity) -> f32 {
        let mut matrix = self.matrix;
        add_to_diagonal(&mut matrix, precision);
        let mut towards = self.rhs;
        let mut sum = 0.0;
        for (towards, (mean, precision)) in towards.iter_mut().zip(mean.iter().zip(precision)) {
            *towards += precision * mean;
            sum += libm::logf(*precision) - precision * mean * mean;
        }
        let mut solved = towards;
        if !solve_spd(&mut matrix, &mut solved) {
            return 0.0;
        }
        for (i, row) in matrix.iter().enumerate() {
            sum -= 2.0 * libm::logf(row.get(i).copied().unwrap_or(1.0));
        }
        0.5 * (sum + dot(&towards, &solved))
    }
}

fn add_to_diagonal(matrix: &mut [[f32; MAX_IDENTITIES]; MAX_IDENTITIES], add: &Identity) {
    for (i, (row, add)) in matrix.iter_mut().zip(add).enumerate() {
        if let Some(diagonal) = row.get_mut(i) {
            *diagonal += add;
        }
    }
}

/// One frame's normal equations: the identity block, and its coupling to pose and animation.
struct Frame {
    /// Symmetric; before pose and animation are eliminated only the lower triangle is complete.
    matrix: [[f32; MAX_IDENTITIES]; MAX_IDENTITIES],
    coupling: [[f32; ROW]; MAX_IDENTITIES],
    rhs: Identity,
}

impl Frame {
    fn new() -> Self {
        Frame {
            matrix: [[0.0; MAX_IDENTITIES]; MAX_IDENTITIES],
            coupling: [[0.0; ROW]; MAX_IDENTITIES],
            rhs: [0.0; MAX_IDENTITIES],
        }
    }

    /// Adds a landmark: for both of its residuals, the derivatives by the identity, and those by
    /// animation and pose.
    fn add(&mut self, identity: &[[f32; MAX_IDENTITIES]; 2], gradients: &Gradients, row: &Row) {
        let [first, second] = identity;
        let blocks = self.matrix.iter_mut().zip(&mut self.coupling);
        let blocks = blocks.zip(&mut self.rhs).zip(first.iter().zip(second));
        for (k, (((own, coupling), rhs), (a, b))) in blocks.enumerate() {
            let factors = [row.weight * a, row.weight * b];
            *rhs += factors[0] * row.residual[0];
            *rhs += factors[1] * row.residual[1];
            let by_four = own.as_chunks_mut::<4>().0.iter_mut();
            let identities = first
                .as_chunks::<4>()
                .0
                .iter()
                .zip(second.as_chunks::<4>().0);
            let [a, b] = factors.map(Vec4::splat);
            for (sums, (first, second)) in by_four.zip(identities).take(k / 4 + 1) {
                let sum = Vec4::from_array(*sums) + a * Vec4::from_array(*first);
                *sums = (sum + b * Vec4::from_array(*second)).to_array();
            }
            gradients.add_to(coupling, factors);
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
            *rhs -= dot(row, reduced);
        }
        // Y = L⁻¹ · couplingᵀ, row by row in place; then matrix − Y·Yᵀ.
        for row in &mut self.coupling {
            for (i, factor_row) in factor.iter().enumerate() {
                let (known, from) = row.split_at_mut_checked(i).unwrap_or_default();
                let (of_known, pivot) = factor_row.split_at_checked(i).unwrap_or_default();
                if let (Some(y), Some(pivot)) = (from.first_mut(), pivot.first()) {
                    *y = (*y - dot(known, of_known)) / pivot;
                }
            }
        }
        for k in 0..MAX_IDENTITIES {
            let (above, from) = self.matrix.split_at_mut(k);
            let (Some(row), Some(a)) = (from.first_mut(), self.coupling.get(k)) else {
                continue;
            };
            for (entry, b) in row.iter_mut().zip(&self.coupling).take(k + 1) {
                *entry -= dot(a, b);
            }
            for (mirrored, entry) in above.iter_mut().zip(row.iter()) {
                mirrored[k] = *entry;
            }
        }
        true
    }
}
