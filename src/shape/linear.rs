//! Whitened landmark residuals, their derivatives, and the normal equations of one linearisation.

use super::face::contour_directions;
use super::{
    Contour, FITTED, FaceModel, FaceState, Intrinsics, LANDMARKS, Project, RotationPrior, Shape,
};
use glam::{Mat3, Vec3, Vec4};

/// Unknowns of the fit: animation weights, then a rotation vector \[rad\], then a translation
/// \[mm\].
pub(super) const UNKNOWNS: usize = FITTED + 6;

/// Factor on the inverse deviation of a jaw landmark along the contour: its position along the
/// contour is less certain than across it.
const ALONG_CONTOUR: f32 = 0.35;

/// Unknowns by four; the last ones are padded.
const FOURS: usize = UNKNOWNS.div_ceil(4);
/// Length of a row of the normal equations.
pub(super) const ROW: usize = 4 * FOURS;
const _: () = assert!(FITTED.is_multiple_of(4));

/// Scale of the Cauchy loss \[standard deviations\]: a residual of this size has half the weight.
const CAUCHY: f32 = 3.0;

/// Observed landmarks.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// Image positions, iBUG 68, the jaw on the visible contour \[px\].
    pub points: &'a [[f32; 2]; LANDMARKS],
    /// Weight of each, 0 (ignored) to 1.
    pub weights: &'a [f32; LANDMARKS],
}

/// One landmark's residual, whitened: 1 is one standard deviation.
pub(super) struct Row {
    /// Index of the point of the shape that represents the landmark.
    pub point: usize,
    /// Weight after the robust loss.
    pub weight: f32,
    /// Observed minus predicted along two orthogonal directions.
    pub residual: [f32; 2],
    /// Derivatives of the prediction by the point in the camera frame, per direction \[1/mm\].
    pub by_camera: [Vec3; 2],
    /// The same by the point in the head frame.
    pub by_head: [Vec3; 2],
    /// The point relative to the head's origin, camera axes \[mm\].
    pub arm: Vec3,
    /// Distance of prediction and observation \[px\].
    pub distance_px: f32,
    /// Contribution to the robust cost.
    pub cost: f32,
}

/// What the residuals depend on.
#[derive(Clone, Copy)]
pub(super) struct Residuals<'a> {
    pub face: &'a FaceModel<'a>,
    pub camera: &'a Intrinsics,
    pub observed: &'a Observed<'a>,
    pub state: &'a FaceState,
    /// The face of `state`, head frame.
    pub shape: &'a Shape,
    pub contour: &'a Contour,
    pub rotation: Option<&'a RotationPrior>,
}

/// A landmark as observed.
struct Sighting {
    landmark: usize,
    position_px: [f32; 2],
    weight: f32,
    /// Its standard deviation on the face.
    noise_mm: f32,
}

impl Residuals<'_> {
    /// Calls `each` with the row of every landmark that has a weight and a finite position.
    pub(super) fn rows(&self, mut each: impl FnMut(Row)) {
        let directions = contour_directions(self.face, &self.state.pose);
        let observed = self.observed.points.iter().zip(self.observed.weights);
        let observed = observed.zip(self.face.noise_mm()).enumerate();
        for (landmark, ((position, weight), noise_mm)) in observed {
            if !(*weight > 0.0 && weight.is_finite() && position.iter().all(|v| v.is_finite())) {
                continue;
            }
            let sighting = Sighting {
                landmark,
                position_px: *position,
                weight: *weight,
                noise_mm: *noise_mm,
            };
            each(self.row(&sighting, directions.get(landmark)));
        }
    }

    /// The row of one landmark; `outward` is the normal of the contour for a landmark on the jaw.
    fn row(&self, sighting: &Sighting, outward: Option<&[f32; 2]>) -> Row {
        let pose = &self.state.pose;
        let to_head: Mat3 = pose.rotation.transpose();
        let pixels_per_mm = self.camera.fx.min(self.camera.fy) / pose.translation_mm.z.max(1.0);
        let point = Shape::image_point(sighting.landmark, self.contour);
        let arm = pose.rotation * self.shape.at(point);
        let at = arm + pose.translation_mm;
        let [px, py] = self.camera.project(at);
        let [gx, gy] = self.camera.project_gradient(at);
        let [x, y] = sighting.position_px;
        let (dx, dy) = (x - px, y - py);
        // Whitening: across and along the contour for the jaw, x and y for the rest.
        let across = outward.copied().unwrap_or([1.0, 0.0]);
        let scale = 1.0 / (sighting.noise_mm * pixels_per_mm).max(1e-3);
        let along = match outward {
            Some(_) => scale * ALONG_CONTOUR,
            None => scale,
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
        Row {
            point,
            weight: sighting.weight / (1.0 + ratio),
            residual,
            by_camera,
            by_head: by_camera.map(|row| to_head * row),
            arm,
            distance_px: libm::sqrtf(dx * dx + dy * dy),
            cost: sighting.weight * CAUCHY * CAUCHY * libm::logf(1.0 + ratio),
        }
    }
}

/// Derivatives of both whitened residuals by the unknowns.
pub(super) struct Gradients {
    /// `[residual][unknown]`, padded with zeros.
    by_residual: [[f32; ROW]; 2],
    /// Unknowns by four: those of which some move the point, in order. Derivatives by the others
    /// are 0, as most are: a landmark of a brow does not move with the mouth.
    moving: [u8; FOURS],
    count: usize,
}

impl Gradients {
    pub fn new(face: &FaceModel<'_>, row: &Row) -> Gradients {
        let mut out = Gradients {
            by_residual: [[0.0; ROW]; 2],
            moving: [0; FOURS],
            count: 0,
        };
        let [(first, first_pose), (second, second_pose)] =
            out.by_residual.each_mut().map(|o| o.split_at_mut(FITTED));
        let outputs = first.as_chunks_mut::<4>().0.iter_mut();
        let outputs = outputs.zip(second.as_chunks_mut::<4>().0).zip(0..);
        let mut fours = out.moving.iter_mut();
        for (((first, second), four), modes) in outputs.zip(face.animation_fours(row.point)) {
            let Some(modes) = modes else {
                continue;
            };
            for ((a, b), mode) in first.iter_mut().zip(second).zip(modes) {
                *a = row.by_head[0].dot(mode);
                *b = row.by_head[1].dot(mode);
            }
            fours.by_ref().take(1).for_each(|moving| *moving = four);
            out.count += 1;
        }
        for (pose, by_camera) in [first_pose, second_pose].into_iter().zip(row.by_camera) {
            // A rotation vector ω moves the point by ω × arm.
            let by_rotation = row.arm.cross(by_camera).to_array();
            let both = by_rotation.into_iter().chain(by_camera.to_array());
            pose.iter_mut().zip(both).for_each(|(o, v)| *o = v);
        }
        for (moving, four) in fours.zip(FITTED as u8 / 4..FOURS as u8) {
            *moving = four;
            out.count += 1;
        }
        out
    }

    /// Those unknowns by four of which some move the point, in order.
    fn moving(&self) -> &[u8] {
        self.moving.get(..self.count).unwrap_or(&[])
    }

    /// Adds multiples of both residuals' derivatives, by those of the unknowns that are named by
    /// four.
    #[inline(always)]
    fn add_of(&self, moving: &[u8], sums: &mut [f32; ROW], factors: [f32; 2]) {
        let factors = factors.map(Vec4::splat);
        let [a, b] = self.by_residual.each_ref().map(|row| row.as_chunks().0);
        let sums = sums.as_chunks_mut().0;
        for four in moving {
            // The remainder, which changes nothing, saves the checks of three indices.
            let four = usize::from(*four) % FOURS;
            let sum = Vec4::from_array(sums[four]) + factors[0] * Vec4::from_array(a[four]);
            sums[four] = (sum + factors[1] * Vec4::from_array(b[four])).to_array();
        }
    }

    /// Adds multiples of both residuals' derivatives.
    pub fn add_to(&self, sums: &mut [f32; ROW], factors: [f32; 2]) {
        self.add_of(self.moving(), sums, factors);
    }
}

/// What the prior of the rotation adds to the cost.
struct RotationTerm {
    /// Half the descent of the squared distance by a rotation vector about the camera's axes.
    slope: Vec3,
    /// Weight after the robust loss.
    weight: f32,
    cost: f32,
}

impl RotationTerm {
    fn new(prior: &RotationPrior, rotation: &Mat3) -> RotationTerm {
        let residual = prior.residual(rotation);
        let slope = prior.information * residual;
        let ratio = slope.dot(residual).max(0.0) / (CAUCHY * CAUCHY);
        RotationTerm {
            slope,
            weight: prior.weight / (1.0 + ratio),
            cost: prior.weight * CAUCHY * CAUCHY * libm::logf(1.0 + ratio),
        }
    }
}

/// Sums over the landmarks of a state.
#[derive(Clone, Copy)]
pub(super) struct Sums {
    /// Robust cost of the residuals and of the priors.
    pub cost: f32,
    /// Σ weight · distance² \[px²\].
    pub squares_px: f32,
    /// Σ weight · residual² \[variances\].
    pub squares: f32,
    /// Σ weight.
    pub weight: f32,
    /// Landmarks used.
    pub count: usize,
}

impl Sums {
    /// Those of no landmarks.
    const EMPTY: Sums = Sums {
        cost: 0.0,
        squares_px: 0.0,
        squares: 0.0,
        weight: 0.0,
        count: 0,
    };

    /// Those of a state, with the same bits as in its system.
    #[inline(never)]
    pub fn of(residuals: &Residuals<'_>) -> Sums {
        let mut sums = Sums::EMPTY;
        residuals.rows(|row| sums.add(&row));
        sums.add_priors(residuals);
        sums
    }

    /// Robust cost per landmark used.
    pub fn mean_cost(&self) -> f32 {
        self.cost / self.count.max(1) as f32
    }

    fn add(&mut self, row: &Row) {
        for residual in row.residual {
            self.squares += row.weight * residual * residual;
        }
        self.cost += row.cost;
        self.squares_px += row.weight * row.distance_px * row.distance_px;
        self.weight += row.weight;
        self.count += 1;
    }

    /// Adds the costs of the priors.
    fn add_priors(&mut self, residuals: &Residuals<'_>) {
        let sigmas = residuals.face.animation_sigma();
        for (w, sigma) in residuals.state.animation.iter().zip(sigmas) {
            self.cost += 1.0 / (sigma * sigma) * w * w;
        }
        if let Some(prior) = residuals.rotation {
            self.cost += RotationTerm::new(prior, &residuals.state.pose.rotation).cost;
        }
    }
}

/// A square matrix of the unknowns, its rows padded.
pub(super) type Matrix = [[f32; ROW]; UNKNOWNS];

/// Normal equations of one linearisation, `matrix · step = rhs`.
pub(super) struct System {
    /// Symmetric; only the lower triangle is complete.
    pub matrix: Matrix,
    pub rhs: [f32; UNKNOWNS],
    pub sums: Sums,
}

impl System {
    /// The system of no landmarks, all zero.
    pub const EMPTY: System = System {
        matrix: [[0.0; ROW]; UNKNOWNS],
        rhs: [0.0; UNKNOWNS],
        sums: Sums::EMPTY,
    };

    /// Becomes the system of these residuals; in place, for small stacks.
    #[inline(never)]
    pub fn set(&mut self, residuals: &Residuals<'_>) {
        *self = Self::EMPTY;
        residuals.rows(|row| self.add(residuals.face, &row));
        self.add_prior(residuals.face, residuals.state);
        if let Some(prior) = residuals.rotation {
            self.add_rotation(prior, residuals.state);
        }
        self.sums.add_priors(residuals);
    }

    fn add(&mut self, face: &FaceModel<'_>, row: &Row) {
        let gradients = Gradients::new(face, row);
        let [a, b] = &gradients.by_residual;
        let derivatives = a
            .iter()
            .zip(b)
            .map(|(a, b)| [row.weight * a, row.weight * b]);
        let rhs = self.rhs.iter_mut().zip(derivatives.clone());
        for (sum, [a, b]) in rhs {
            *sum += a * row.residual[0];
            *sum += b * row.residual[1];
        }
        // The lower triangle, rounded up to whole fours.
        let moving = gradients.moving();
        for (n, four) in moving.iter().enumerate() {
            let (columns, _) = moving.split_at_checked(n + 1).unwrap_or_default();
            let first = 4 * usize::from(*four);
            let rows = self.matrix.iter_mut().zip(derivatives.clone());
            for (row, factors) in rows.skip(first).take(4) {
                gradients.add_of(columns, row, factors);
            }
        }
        self.sums.add(row);
    }

    /// Adds the prior of the rotation, with the same robust loss as the landmarks.
    fn add_rotation(&mut self, prior: &RotationPrior, state: &FaceState) {
        let term = RotationTerm::new(prior, &state.pose.rotation);
        let information = (term.weight * prior.information).to_cols_array_2d();
        let slope = (term.weight * term.slope).to_array();
        let rows = self.matrix.iter_mut().zip(&mut self.rhs).skip(FITTED);
        for ((row, rhs), (sums, slope)) in rows.zip(information.iter().zip(slope)) {
            let entries = row.iter_mut().skip(FITTED).zip(sums);
            entries.for_each(|(entry, value)| *entry += value);
            *rhs += slope;
        }
    }

    /// Adds the prior N(0, σ²) of the animation weights.
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
        }
    }
}
