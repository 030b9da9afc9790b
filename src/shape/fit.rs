//! The bounded fit of pose and animation to landmarks: Levenberg–Marquardt with a robust loss.

use super::face::FIXED_CONTOUR;
use super::linear::{Matrix, Residuals, Sums, System, UNKNOWNS};
use super::posit::{mirrored, posit};
use super::state::FaceState;
use super::step::stepped;
use super::{Contour, FITTED, FaceModel, Identity, Intrinsics, LANDMARKS};
use super::{Observed, Pose, Project, RotationPrior, Shape};
use crate::math::solve_spd;
use glam::Vec3;
use nalgebra::{Cholesky, Matrix6};

/// Least number of landmarks for a fit: POSIT needs four, the rest makes outliers visible.
const MIN_LANDMARKS: usize = 8;

/// First landmark that is not on the jaw.
const INNER: usize = 17;

/// Damping of Levenberg–Marquardt at the start, and its least value.
const DAMPING_START: f32 = 1e-3;
const DAMPING_MIN: f32 = 1e-6;
/// Factor on the damping after a step that reduces the cost.
const DAMPING_SUCCESS: f32 = 0.2;
/// Factor after a step that increases the cost.
const DAMPING_FAILURE: f32 = 20.0;
/// Factor when the system cannot be solved.
const DAMPING_SINGULAR: f32 = 30.0;
/// The fit has converged when a step reduces the cost by less than this share of it.
const CONVERGED: f32 = 5e-2;
/// The fit stops when a step increases the cost by less than this share of it.
const STALLED: f32 = 1e-4;

/// Bounds of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Most linearisations per initial state, 1 to 20.
    pub iterations: usize,
    /// Factor on the weight of landmarks that the head itself hides at the initial pose.
    pub hidden_weight: f32,
    /// What is known of the rotation beside the landmarks.
    pub rotation: Option<RotationPrior>,
}

impl Default for FitOptions {
    fn default() -> Self {
        FitOptions {
            iterations: 6,
            hidden_weight: 0.5,
            rotation: None,
        }
    }
}

/// A fitted face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceFit {
    /// Pose, animation and the given identity.
    pub state: FaceState,
    /// The 68 landmarks as fixed points of the head, camera frame \[mm\].
    pub points_mm: [Vec3; LANDMARKS],
    /// The landmarks in the image, the jaw on the visible contour \[px\].
    pub image_px: [[f32; 2]; LANDMARKS],
    /// Which landmarks the head itself does not hide.
    pub visible: [bool; LANDMARKS],
    /// The points that represent the jaw landmarks in the image.
    pub contour: Contour,
    /// Root of the weighted mean squared distance to the observed landmarks \[px\].
    pub rms_px: f32,
    /// Mean robust cost per landmark, by which fits from several initial states are compared.
    pub cost: f32,
    /// The prior of the rotation that it was fitted with.
    pub rotation: Option<RotationPrior>,
    /// Covariance of the pose, animation marginalised: rotation vector about the camera's axes
    /// \[rad\], then translation \[mm\].
    pub covariance: [[f32; 6]; 6],
}

/// Fits pose and animation of a person to observed landmarks under perspective.
///
/// Levenberg–Marquardt with analytic derivatives, a Cauchy loss, Gaussian priors on animation
/// weights and, if there is one, on the rotation, and bounds 0..1 on the weights. Starts from
/// `start`; without one, from the pose of POSIT and from its mirrored pose, of which the better fit
/// is taken. `options.iterations` bounds the work.
///
/// `None` when there are fewer than eight usable landmarks, the camera or the result is not finite,
/// or no pose in front of the camera fits the landmarks.
#[inline(never)]
pub fn fit(
    face: &FaceModel<'_>,
    camera: &Intrinsics,
    observed: &Observed<'_>,
    start: Option<&FaceState>,
    identity: &Identity,
    options: &FitOptions,
) -> Option<FaceFit> {
    if !camera.is_valid() {
        return None;
    }
    let fit = Fit {
        face,
        camera,
        observed,
        neutral: &face.neutral(identity),
        options,
    };
    let mut at = Point::EMPTY;
    match start {
        Some(start) => {
            let start = FaceState {
                identity: *identity,
                ..*start
            };
            let fitted = fit.descend(&start, &mut at);
            if fitted { fit.finish(&mut at) } else { None }
        }
        None => fit.search(identity, &mut at),
    }
}

/// POSIT on the landmarks that are fixed points of the head: all but those of the jaw.
fn start_pose(camera: &Intrinsics, observed: &Observed<'_>, neutral: &Shape) -> Option<Pose> {
    let points = neutral
        .landmarks()
        .iter()
        .zip(observed.points)
        .zip(observed.weights);
    let usable = points
        .skip(INNER)
        .map(|((point, position), weight)| (*point, *position, *weight))
        .filter(|(_, position, weight)| {
            *weight > 0.0 && weight.is_finite() && position.iter().all(|v| v.is_finite())
        });
    if usable.clone().count() < MIN_LANDMARKS {
        return None;
    }
    posit(camera, usable)
}

/// A state and the linearisation at it.
struct Point {
    state: FaceState,
    /// Weight of each landmark, less where the head hides it at the initial pose.
    weights: [f32; LANDMARKS],
    shape: Shape,
    contour: Contour,
    system: System,
}

impl Point {
    const EMPTY: Point = Point {
        state: FaceState::EMPTY,
        weights: [0.0; LANDMARKS],
        shape: Shape::EMPTY,
        contour: FIXED_CONTOUR,
        system: System::EMPTY,
    };
}

/// The inputs of a fit. Its functions are not inlined, so that their working memory on the stack
/// does not add up.
struct Fit<'a> {
    face: &'a FaceModel<'a>,
    camera: &'a Intrinsics,
    observed: &'a Observed<'a>,
    neutral: &'a Shape,
    options: &'a FitOptions,
}

impl Fit<'_> {
    /// The better fit from POSIT's pose and from its mirrored pose.
    #[inline(never)]
    fn search(&self, identity: &Identity, at: &mut Point) -> Option<FaceFit> {
        let pose = start_pose(self.camera, self.observed, self.neutral)?;
        let [first, second] = [pose, mirrored(&pose)].map(|pose| {
            let start = FaceState {
                pose,
                animation: [0.0; FITTED],
                identity: *identity,
            };
            let fitted = self.descend(&start, at);
            fitted.then_some((at.state, at.weights, at.system.sums.mean_cost()))
        });
        let swap = match (&first, &second) {
            (Some((.., a)), Some((.., b))) => b < a,
            (a, _) => a.is_none(),
        };
        let (better, other) = if swap {
            (&second, &first)
        } else {
            (&first, &second)
        };
        // Memory holds only the last linearisation: it is computed again.
        for (state, weights, _) in [better, other].into_iter().flatten() {
            at.weights = *weights;
            self.linearise_at(state, at);
            let fitted = self.finish(at);
            if fitted.is_some() {
                return fitted;
            }
        }
        None
    }

    /// Moves `at` to a state; its weights are those to use.
    #[inline(never)]
    fn linearise_at(&self, state: &FaceState, at: &mut Point) {
        let mut shape = *self.neutral;
        at.contour = self.pose(state, &mut shape);
        self.linearise(state, &shape, at);
    }

    /// Minimises the cost from an initial state; false when the pose is not valid or too few
    /// landmarks are usable.
    #[inline(never)]
    fn descend(&self, start: &FaceState, at: &mut Point) -> bool {
        if !start.pose.is_valid() {
            return false;
        }
        at.weights = self.weights_at(&start.pose);
        let mut shape = *self.neutral;
        at.contour = self.pose(start, &mut shape);
        self.linearise(start, &shape, at);
        if at.system.sums.count < MIN_LANDMARKS || !at.system.sums.cost.is_finite() {
            return false;
        }
        let mut damping = DAMPING_START;
        for _ in 1..self.options.iterations.clamp(1, 20) {
            let Some(state) = stepped(&at.state, &at.system, damping) else {
                damping *= DAMPING_SINGULAR;
                continue;
            };
            let contour = self.pose(&state, &mut shape);
            let observed = &self.weighted(&at.weights);
            let sums = Sums::of(&self.residuals(observed, &state, &shape, &contour));
            let cost = at.system.sums.cost;
            let gain = cost - sums.cost;
            if gain > 0.0 && gain < CONVERGED * cost {
                // The matrix, of which the covariance is made, hardly differs here.
                (at.state, at.contour, at.system.sums) = (state, contour, sums);
                at.shape = shape;
                break;
            }
            if gain > 0.0 {
                at.contour = contour;
                self.linearise(&state, &shape, at);
                damping = (damping * DAMPING_SUCCESS).max(DAMPING_MIN);
            } else if gain > -STALLED * cost {
                break;
            } else {
                damping *= DAMPING_FAILURE;
            }
        }
        true
    }

    /// The observed weights, reduced where the head hides the landmark at this pose.
    fn weights_at(&self, pose: &Pose) -> [f32; LANDMARKS] {
        let mut weights = *self.observed.weights;
        let visible = self.face.visibility(pose);
        for (w, visible) in weights.iter_mut().zip(visible).skip(INNER) {
            *w *= if visible {
                1.0
            } else {
                self.options.hidden_weight
            };
        }
        weights
    }

    fn weighted<'b>(&'b self, weights: &'b [f32; LANDMARKS]) -> Observed<'b> {
        Observed {
            points: self.observed.points,
            weights,
        }
    }

    fn residuals<'b>(
        &'b self,
        observed: &'b Observed<'b>,
        state: &'b FaceState,
        shape: &'b Shape,
        contour: &'b Contour,
    ) -> Residuals<'b> {
        Residuals {
            face: self.face,
            camera: self.camera,
            observed,
            state,
            shape,
            contour,
            rotation: self.options.rotation.as_ref(),
        }
    }

    /// Evaluates the shape of a state, and which of its points represent the jaw.
    fn pose(&self, state: &FaceState, shape: &mut Shape) -> Contour {
        shape.clone_from(self.neutral);
        self.face.animate(shape, &state.animation);
        shape.contour(self.face, &state.pose)
    }

    /// Moves `at` to a state whose shape is known; its weights and contour are those to use.
    fn linearise(&self, state: &FaceState, shape: &Shape, at: &mut Point) {
        (at.state, at.shape) = (*state, *shape);
        let observed = &self.weighted(&at.weights);
        at.system
            .set(&self.residuals(observed, state, shape, &at.contour));
    }

    /// The result at a point, whose system is overwritten; `None` when its matrix is singular.
    #[inline(never)]
    fn finish(&self, at: &mut Point) -> Option<FaceFit> {
        let (state, shape, system) = (&at.state, &at.shape, &mut at.system);
        let points_mm = shape.landmarks().map(|p| state.pose.apply(p));
        let mut image_px = points_mm.map(|p| self.camera.project(p));
        for (px, point) in image_px.iter_mut().zip(at.contour) {
            *px = self
                .camera
                .project(state.pose.apply(shape.at(point as usize)));
        }
        let sums = &system.sums;
        let freedom = (2.0 * sums.weight - 6.0).max(1.0);
        Some(FaceFit {
            state: *state,
            points_mm,
            image_px,
            visible: self.face.visibility(&state.pose),
            contour: at.contour,
            rms_px: libm::sqrtf(sums.squares_px / sums.weight.max(1e-6)),
            cost: sums.mean_cost(),
            rotation: self.options.rotation,
            covariance: pose_covariance(&mut system.matrix, sums.squares / freedom)?,
        })
    }
}

/// Covariance of the last six unknowns: `variance` times the inverse of the Schur complement of the
/// others, whose Cholesky factor is the last block of the whole factor. The matrix is overwritten.
fn pose_covariance(matrix: &mut Matrix, variance: f32) -> Option<[[f32; 6]; 6]> {
    if !solve_spd(matrix, &mut [0.0; UNKNOWNS]) {
        return None;
    }
    let mut factor = Matrix6::zeros();
    let rows = matrix.iter().skip(FITTED);
    for (mut to, from) in factor.row_iter_mut().zip(rows) {
        let entries = to.iter_mut().zip(from.iter().skip(FITTED));
        entries.for_each(|(t, f)| *t = *f);
    }
    Some((Cholesky::pack_dirty(factor).inverse() * variance).into())
}
