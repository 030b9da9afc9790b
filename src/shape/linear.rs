//! Linearised landmark residuals and their normal equations.

use super::face::contour_directions;
use super::{ANIMATIONS, Contour, FaceModel, FaceState, Intrinsics, LANDMARKS, Shape};
use glam::{Mat3, Vec3};

/// Unknowns of the fit: animation weights, then turn \[rad\], then shift \[mm\].
pub(super) const UNKNOWNS: usize = ANIMATIONS + 6;

/// How much less a jaw landmark's place along the contour says than its place across it.
const ALONG_CONTOUR: f32 = 0.35;

/// Cauchy's scale: residuals of this many standard deviations count half.
const CAUCHY: f32 = 3.0;

/// Observed landmarks.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// Image positions, iBUG 68, the jaw on the visible contour \[px\].
    pub points: &'a [[f32; 2]; LANDMARKS],
    /// Trust in each, 0 (ignored) to 1.
    pub weights: &'a [f32; LANDMARKS],
}

/// One landmark's residual, whitened: 1 is one standard deviation.
pub(super) struct Row {
    /// Number of the point of the shape that stands for the landmark.
    pub point: usize,
    /// Weight after the robust loss.
    pub weight: f32,
    /// Observed minus predicted along two directions at right angles.
    pub residual: [f32; 2],
    /// Derivative of the prediction by the point in the camera frame, per direction.
    pub by_camera: [Vec3; 2],
    /// The same by the point in the head frame.
    pub by_head: [Vec3; 2],
    /// The point relative to the head's origin, camera axes \[mm\].
    pub arm: Vec3,
    /// Distance of prediction and observation \[px\].
    pub distance_px: f32,
    /// Contribution to the cost.
    pub cost: f32,
}

/// Calls `each` with the row of every landmark that has a weight and a finite position.
pub(super) fn rows(
    face: &FaceModel<'_>,
    camera: &Intrinsics,
    observed: &Observed<'_>,
    state: &FaceState,
    shape: &Shape,
    contour: &Contour,
    mut each: impl FnMut(usize, Row),
) {
    let pose = &state.pose;
    let directions = contour_directions(face, pose);
    let to_head: Mat3 = pose.rotation.transpose();
    let pixels_per_mm = camera.fx.min(camera.fy) / pose.translation_mm.z.max(1.0);
    let observations = observed
        .points
        .iter()
        .zip(observed.weights)
        .zip(face.noise_mm());
    for (landmark, ((seen, weight), noise_mm)) in observations.enumerate() {
        if !(*weight > 0.0 && weight.is_finite() && seen.iter().all(|v| v.is_finite())) {
            continue;
        }
        let point = Shape::image_point(landmark, contour);
        let arm = pose.rotation * shape.at(point);
        let at = arm + pose.translation_mm;
        let [px, py] = camera.project(at);
        let [gx, gy] = camera.project_gradient(at);
        let (dx, dy) = (seen[0] - px, seen[1] - py);
        // Whitening: across and along the contour for the jaw, x and y for the rest.
        let across = directions.get(landmark).copied().unwrap_or([1.0, 0.0]);
        let scale = 1.0 / (noise_mm * pixels_per_mm).max(1e-3);
        let along = if landmark < directions.len() {
            scale * ALONG_CONTOUR
        } else {
            scale
        };
        let residual = [
            scale * (across[0] * dx + across[1] * dy),
            along * (across[0] * dy - across[1] * dx),
        ];
        let by_camera = [
            (gx * across[0] + gy * across[1]) * scale,
            (gy * across[0] - gx * across[1]) * along,
        ];
        let squared = residual[0] * residual[0] + residual[1] * residual[1];
        let ratio = squared / (CAUCHY * CAUCHY);
        each(
            landmark,
            Row {
                point,
                weight: weight / (1.0 + ratio),
                residual,
                by_camera,
                by_head: by_camera.map(|row| to_head * row),
                arm,
                distance_px: libm::sqrtf(dx * dx + dy * dy),
                cost: weight * CAUCHY * CAUCHY * libm::logf(1.0 + ratio),
            },
        );
    }
}

/// Derivatives of both whitened residuals by the unknowns.
pub(super) fn gradients(face: &FaceModel<'_>, row: &Row) -> [[f32; UNKNOWNS]; 2] {
    let mut out = [[0.0; UNKNOWNS]; 2];
    let [(first, first_pose), (second, second_pose)] =
        out.each_mut().map(|o| o.split_at_mut(ANIMATIONS));
    let modes = face.animation_modes(row.point);
    for ((a, b), mode) in first.iter_mut().zip(second).zip(modes) {
        *a = row.by_head[0].dot(mode);
        *b = row.by_head[1].dot(mode);
    }
    for (pose, by_camera) in [first_pose, second_pose].into_iter().zip(row.by_camera) {
        // A turn ω moves the point by ω × arm.
        let turn = row.arm.cross(by_camera).to_array();
        let both = turn.into_iter().chain(by_camera.to_array());
        pose.iter_mut().zip(both).for_each(|(o, v)| *o = v);
    }
    out
}

/// Normal equations of one linearisation: `matrix · step = rhs`.
pub(super) struct System {
    pub matrix: [[f32; UNKNOWNS]; UNKNOWNS],
    pub rhs: [f32; UNKNOWNS],
    /// Robust cost of the residuals and of the animation prior.
    pub cost: f32,
    /// Σ weight · distance² \[px²\].
    pub squares_px: f32,
    /// Σ weight · residual², in variances.
    pub squares: f32,
    /// Σ weight.
    pub weight: f32,
    /// Landmarks used.
    pub count: usize,
}

impl System {
    /// Of nothing, all zero.
    pub const EMPTY: System = System {
        matrix: [[0.0; UNKNOWNS]; UNKNOWNS],
        rhs: [0.0; UNKNOWNS],
        cost: 0.0,
        squares_px: 0.0,
        squares: 0.0,
        weight: 0.0,
        count: 0,
    };

    /// Becomes the system at a state; in place, for small stacks.
    #[inline(never)]
    pub fn set(
        &mut self,
        face: &FaceModel<'_>,
        camera: &Intrinsics,
        observed: &Observed<'_>,
        state: &FaceState,
        shape: &Shape,
        contour: &Contour,
    ) {
        *self = Self::EMPTY;
        rows(face, camera, observed, state, shape, contour, |_, row| {
            self.add(face, &row)
        });
        self.add_prior(face, state);
    }

    /// The cost alone, bit for bit that of the system at the state.
    #[inline(never)]
    pub fn cost_of(
        face: &FaceModel<'_>,
        camera: &Intrinsics,
        observed: &Observed<'_>,
        state: &FaceState,
        shape: &Shape,
        contour: &Contour,
    ) -> f32 {
        let mut cost = 0.0;
        rows(face, camera, observed, state, shape, contour, |_, row| {
            cost += row.cost
        });
        for (w, sigma) in state.animation.iter().zip(face.animation_sigma()) {
            cost += 1.0 / (sigma * sigma) * w * w;
        }
        cost
    }

    /// Robust cost per landmark used.
    pub fn mean_cost(&self) -> f32 {
        self.cost / self.count.max(1) as f32
    }

    fn add(&mut self, face: &FaceModel<'_>, row: &Row) {
        for (g, residual) in gradients(face, row).iter().zip(row.residual) {
            for (i, ((sums, rhs), a)) in
                self.matrix.iter_mut().zip(&mut self.rhs).zip(g).enumerate()
            {
                let a = row.weight * a;
                *rhs += a * residual;
                // Whole vectors of four cover the lower triangle, which is all that is read.
                let lower = sums.iter_mut().zip(g).take((i | 3) + 1);
                lower.for_each(|(s, b)| *s += a * b);
            }
            self.squares += row.weight * residual * residual;
        }
        self.cost += row.cost;
        self.squares_px += row.weight * row.distance_px * row.distance_px;
        self.weight += row.weight;
        self.count += 1;
    }

    /// Animation weights are drawn from N(0, σ²).
    fn add_prior(&mut self, face: &FaceModel<'_>, state: &FaceState) {
        let rows = self.matrix.iter_mut().zip(&mut self.rhs).enumerate();
        for ((i, (row, rhs)), (w, sigma)) in
            rows.zip(state.animation.iter().zip(face.animation_sigma()))
        {
            let information = 1.0 / (sigma * sigma);
            if let Some(diagonal) = row.get_mut(i) {
                *diagonal += information;
            }
            *rhs -= information * w;
            self.cost += information * w * w;
        }
    }
}
