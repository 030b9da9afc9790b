//! Whitened landmark residuals, their derivatives, and the normal equations of one linearisation.

use super::face::contour_directions;
use super::{
    ANIMATIONS, Contour, FaceModel, FaceState, Intrinsics, LANDMARKS, Project, RotationPrior, Shape,
};
use glam::{Mat3, Vec3};

/// Unknowns of the fit: animation weights, then a rotation vector \[rad\], then a translation
/// \[mm\].
pub(super) const UNKNOWNS: usize = ANIMATIONS + 6;

/// Factor on the inverse deviation of a jaw landmark along the contour: its position along the
/// contour is less certain than across it.
const ALONG_CONTOUR: f32 = 0.35;

/// The unknowns of the pose, as bits of [`Gradients::fours`]: they move every point.
const ALWAYS_MOVES: u32 = u32::MAX << (ANIMATIONS / 4);
const _: () = assert!(ANIMATIONS.is_multiple_of(4));

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
    pub by_residual: [[f32; UNKNOWNS]; 2],
    /// Bit `k`: some of the unknowns from `4 k` to `4 k + 3` move the point. Derivatives by others
    /// are 0, as most are: a landmark of a brow does not move with the mouth.
    fours: u32,
}

impl Gradients {
    pub fn new(face: &FaceModel<'_>, row: &Row) -> Gradients {
        let mut by_residual = [[0.0; UNKNOWNS]; 2];
        let mut fours = ALWAYS_MOVES;
        let [(first, first_pose), (second, second_pose)] =
            by_residual.each_mut().map(|o| o.split_at_mut(ANIMATIONS));
        let outputs = first.as_chunks_mut::<4>().0.iter_mut();
        let outputs = outputs.zip(second.as_chunks_mut::<4>().0).enumerate();
        for ((k, (first, second)), modes) in outputs.zip(face.animation_fours(row.point)) {
            let Some(modes) = modes else {
                continue;
            };
            fours |= 1 << k;
            for ((a, b), mode) in first.iter_mut().zip(second).zip(modes) {
                *a = row.by_head[0].dot(mode);
                *b = row.by_head[1].dot(mode);
            }
        }
        for (pose, by_camera) in [first_pose, second_pose].into_iter().zip(row.by_camera) {
            // A rotation vector ω moves the point by ω × arm.
            let by_rotation = row.arm.cross(by_camera).to_array();
            let both = by_rotation.into_iter().chain(by_camera.to_array());
            pose.iter_mut().zip(both).for_each(|(o, v)| *o = v);
        }
        Gradients { by_residual, fours }
    }

    /// Adds a multiple of each residual's derivatives.
    pub fn add_to(&self, sums: &mut [f32; UNKNOWNS], factors: &[f32; 2]) {
        let by_residual = self.by_residual.each_ref();
        let [(a, last_a), (b, last_b)] = by_residual.map(|g| g.as_chunks::<4>());
        let (sums, last) = sums.as_chunks_mut::<4>();
        for (k, (sums, (a, b))) in sums.iter_mut().zip(a.iter().zip(b)).enumerate() {
            if self.moves(k) {
                add_scaled(sums, factors, [a, b]);
            }
        }
        add_scaled(last, factors, [last_a, last_b]);
    }

    /// Whether some of four unknowns move the point.
    fn moves(&self, four: usize) -> bool {
        self.fours >> four & 1 != 0
    }
}

/// Adds the products of both residuals' gradients to `R` rows of the matrix from `first` on, up to
/// the column of the last row, rounded up to a whole vector of four.
fn add_products<const R: usize>(
    rows: &mut [[f32; UNKNOWNS]; R],
    first: usize,
    weighted: &[[f32; UNKNOWNS]; 2],
    gradients: &Gradients,
) {
    let mut factors = [[0.0; 2]; R];
    for (residual, weighted) in weighted.iter().enumerate() {
        for (factors, a) in factors.iter_mut().zip(weighted.iter().skip(first)) {
            factors[residual] = *a;
        }
    }
    let by_residual = gradients.by_residual.each_ref();
    let [(a, last_a), (b, last_b)] = by_residual.map(|g| g.as_chunks::<4>());
    for (column, (a, b)) in a.iter().zip(b).take(first / 4 + 1).enumerate() {
        if !gradients.moves(column) {
            continue;
        }
        for (row, factors) in rows.iter_mut().zip(&factors) {
            if let Some(sums) = row.as_chunks_mut::<4>().0.get_mut(column) {
                add_scaled(sums, factors, [a, b]);
            }
        }
    }
    if first / 4 + 1 > a.len() {
        for (row, factors) in rows.iter_mut().zip(&factors) {
            add_scaled(row.as_chunks_mut::<4>().1, factors, [last_a, last_b]);
        }
    }
}

/// Adds a multiple of each of two vectors.
#[inline]
pub(super) fn add_scaled(sums: &mut [f32], factors: &[f32; 2], vectors: [&[f32]; 2]) {
    for (sum, (a, b)) in sums.iter_mut().zip(vectors[0].iter().zip(vectors[1])) {
        *sum += factors[0] * a;
        *sum += factors[1] * b;
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

/// Normal equations of one linearisation, `matrix · step = rhs`.
pub(super) struct System {
    /// Symmetric; only the lower triangle is complete.
    pub matrix: [[f32; UNKNOWNS]; UNKNOWNS],
    pub rhs: [f32; UNKNOWNS],
    pub sums: Sums,
}

impl System {
    /// The system of no landmarks, all zero.
    pub const EMPTY: System = System {
        matrix: [[0.0; UNKNOWNS]; UNKNOWNS],
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
        let by_residual = gradients.by_residual.each_ref();
        let weighted = by_residual.map(|g| g.map(|by_unknown| row.weight * by_unknown));
        for (weighted, residual) in weighted.iter().zip(row.residual) {
            let rhs = self.rhs.iter_mut().zip(weighted);
            rhs.for_each(|(sum, a)| *sum += a * residual);
        }
        // The lower triangle, rounded up to whole SIMD vectors of four.
        let (groups, last) = self.matrix.as_chunks_mut::<4>();
        for (k, rows) in groups.iter_mut().enumerate() {
            if gradients.moves(k) {
                add_products(rows, 4 * k, &weighted, &gradients);
            }
        }
        if let Some(rows) = last.first_chunk_mut::<{ UNKNOWNS % 4 }>() {
            add_products(rows, UNKNOWNS / 4 * 4, &weighted, &gradients);
        }
        self.sums.add(row);
    }

    /// Adds the prior of the rotation, with the same robust loss as the landmarks.
    fn add_rotation(&mut self, prior: &RotationPrior, state: &FaceState) {
        let term = RotationTerm::new(prior, &state.pose.rotation);
        let information = (term.weight * prior.information).to_cols_array_2d();
        let slope = (term.weight * term.slope).to_array();
        let rows = self.matrix.iter_mut().zip(&mut self.rhs).skip(ANIMATIONS);
        for ((row, rhs), (sums, slope)) in rows.zip(information.iter().zip(slope)) {
            let entries = row.iter_mut().skip(ANIMATIONS).zip(sums);
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
