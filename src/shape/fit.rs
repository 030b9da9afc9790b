//! The bounded fit of pose and animation to landmarks.

use super::face::FIXED_CONTOUR;
use super::linear::{System, UNKNOWNS};
use super::posit::{mirrored, posit};
use super::step::stepped;
use super::{ANIMATIONS, Animation, Contour, FaceModel, Identity, Intrinsics, LANDMARKS};
use super::{MAX_IDENTITIES, Observed, Pose, Shape};
use crate::math::solve_spd;
use glam::{Mat3, Vec3};

/// Fewest landmarks that a pose is fitted to.
const MIN_LANDMARKS: usize = 8;

/// First landmark that is not on the jaw.
const INNER: usize = 17;

/// One face at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceState {
    /// Where the head is.
    pub pose: Pose,
    /// Weights of [`super::ANIMATION_NAMES`], 0..1.
    pub animation: Animation,
    /// Identity weights in standard deviations.
    pub identity: Identity,
}

impl FaceState {
    /// At the camera, at rest, the mean person. All zero.
    pub const EMPTY: FaceState = FaceState {
        pose: Pose {
            rotation: Mat3::ZERO,
            translation_mm: Vec3::ZERO,
        },
        animation: [0.0; ANIMATIONS],
        identity: [0.0; MAX_IDENTITIES],
    };
}

/// Bounds of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Linearisations per start, at most; 1 to 20.
    pub iterations: usize,
    /// Factor on the weight of landmarks that the head itself hides at the starting pose.
    pub hidden_weight: f32,
}

impl Default for FitOptions {
    fn default() -> Self {
        FitOptions {
            iterations: 6,
            hidden_weight: 0.5,
        }
    }
}

/// A fitted face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceFit {
    /// Pose, animation and the identity that was used.
    pub state: FaceState,
    /// The 68 landmarks as fixed vertices, camera frame \[mm\].
    pub points_mm: [Vec3; LANDMARKS],
    /// The landmarks in the image, the jaw on the visible contour \[px\].
    pub image_px: [[f32; 2]; LANDMARKS],
    /// Which landmarks the head itself does not hide.
    pub visible: [bool; LANDMARKS],
    /// The points that stand for the jaw landmarks in the image.
    pub contour: Contour,
    /// Root of the weighted mean squared distance to the observed landmarks \[px\].
    pub rms_px: f32,
    /// Mean robust cost per landmark; the measure by which starts are compared.
    pub cost: f32,
    /// Covariance of the pose, animation marginalised: turn \[rad\] about the camera's axes, then
    /// shift \[mm\].
    pub covariance: [[f32; 6]; 6],
}

/// Fits pose and animation of a person to observed landmarks under perspective.
///
/// Levenberg–Marquardt with analytic derivatives, a Cauchy loss, a Gaussian prior on animation
/// weights and bounds 0..1 on them. Starts from `start`, or without one from POSIT and its mirrored
/// twin, of which the better fit is taken. Work is bounded by `options.iterations`.
///
/// `None` when there are too few usable landmarks, the numbers are not finite, or no pose before
/// the camera explains them.
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
    let task = Task {
        face,
        camera,
        observed,
        neutral: &face.neutral(identity),
        options,
    };
    let mut at = Point::NOWHERE;
    match start {
        Some(start) => {
            let start = FaceState {
                identity: *identity,
                ..*start
            };
            let settled = task.descend(&start, &mut at);
            if settled { task.finish(&mut at) } else { None }
        }
        None => task.search(identity, &mut at),
    }
}

/// POSIT on the landmarks that are the same vertices from every side.
fn start_pose(camera: &Intrinsics, observed: &Observed<'_>, neutral: &Shape) -> Option<Pose> {
    let points = neutral
        .landmarks()
        .iter()
        .zip(observed.points)
        .zip(observed.weights);
    let usable = points
        .skip(INNER)
        .map(|((point, seen), weight)| (*point, *seen, *weight))
        .filter(|(_, seen, weight)| {
            *weight > 0.0 && weight.is_finite() && seen.iter().all(|v| v.is_finite())
        });
    if usable.clone().count() < MIN_LANDMARKS {
        return None;
    }
    posit(camera, usable)
}

/// A linearisation and where it was made.
struct Point {
    state: FaceState,
    /// Trust in each landmark from this start.
    weights: [f32; LANDMARKS],
    contour: Contour,
    system: System,
}

impl Point {
    const NOWHERE: Point = Point {
        state: FaceState::EMPTY,
        weights: [0.0; LANDMARKS],
        contour: FIXED_CONTOUR,
        system: System::EMPTY,
    };
}

/// What is fitted to what. Its functions are kept apart, not inlined, so that their working memory
/// on the stack is not added up.
struct Task<'a> {
    face: &'a FaceModel<'a>,
    camera: &'a Intrinsics,
    observed: &'a Observed<'a>,
    neutral: &'a Shape,
    options: &'a FitOptions,
}

impl Task<'_> {
    /// The better end of POSIT's pose and its mirrored twin.
    #[inline(never)]
    fn search(&self, identity: &Identity, at: &mut Point) -> Option<FaceFit> {
        let pose = start_pose(self.camera, self.observed, self.neutral)?;
        let [first, second] = [pose, mirrored(&pose)].map(|pose| {
            let start = FaceState {
                pose,
                animation: [0.0; ANIMATIONS],
                identity: *identity,
            };
            let settled = self.descend(&start, at);
            settled.then_some((at.state, at.weights, at.system.mean_cost()))
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
        // Only the last linearisation is in memory, so that of an end is made again.
        for (state, weights, _) in [better, other].into_iter().flatten() {
            at.weights = *weights;
            self.go_to(state, at);
            let fitted = self.finish(at);
            if fitted.is_some() {
                return fitted;
            }
        }
        None
    }

    #[inline(never)]
    fn go_to(&self, state: &FaceState, at: &mut Point) {
        let mut shape = *self.neutral;
        at.contour = self.pose(state, &mut shape);
        self.linearise(state, &shape, at);
    }

    /// Descends from a start; false when there is nothing to descend on.
    #[inline(never)]
    fn descend(&self, start: &FaceState, at: &mut Point) -> bool {
        if !start.pose.is_valid() {
            return false;
        }
        at.weights = self.trust(&start.pose);
        let mut shape = *self.neutral;
        at.contour = self.pose(start, &mut shape);
        self.linearise(start, &shape, at);
        if at.system.count < MIN_LANDMARKS || !at.system.cost.is_finite() {
            return false;
        }
        let mut damping = 1e-3f32;
        for _ in 1..self.options.iterations.clamp(1, 20) {
            let Some(state) = stepped(&at.state, &at.system, damping) else {
                damping *= 30.0;
                continue;
            };
            let contour = self.pose(&state, &mut shape);
            let observed = &self.weighted(&at.weights);
            let cost = System::cost_of(self.face, self.camera, observed, &state, &shape, &contour);
            let gain = at.system.cost - cost;
            if gain > 0.0 {
                let settled = gain < 1e-3 * at.system.cost;
                at.contour = contour;
                self.linearise(&state, &shape, at);
                damping = (damping * 0.2).max(1e-6);
                if settled {
                    break;
                }
            } else if gain > -1e-4 * at.system.cost {
                break;
            } else {
                damping *= 20.0;
            }
        }
        true
    }

    /// The observed weights, less where the head hides the landmark.
    fn trust(&self, pose: &Pose) -> [f32; LANDMARKS] {
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

    /// Evaluates the shape of a state, and which of its points stand for the jaw.
    fn pose(&self, state: &FaceState, shape: &mut Shape) -> Contour {
        shape.clone_from(self.neutral);
        self.face.animate(shape, &state.animation);
        shape.contour(self.face, &state.pose)
    }

    /// Moves `at` to a state of known shape; its weights and contour are those to use.
    fn linearise(&self, state: &FaceState, shape: &Shape, at: &mut Point) {
        at.state = *state;
        let observed = &self.weighted(&at.weights);
        at.system
            .set(self.face, self.camera, observed, state, shape, &at.contour);
    }

    /// The answer at a point, whose system is used up.
    #[inline(never)]
    fn finish(&self, at: &mut Point) -> Option<FaceFit> {
        let (state, system) = (&at.state, &mut at.system);
        let mut shape = *self.neutral;
        self.face.animate(&mut shape, &state.animation);
        let points_mm = shape.landmarks().map(|p| state.pose.apply(p));
        let mut image_px = points_mm.map(|p| self.camera.project(p));
        for (px, point) in image_px.iter_mut().zip(at.contour) {
            *px = self
                .camera
                .project(state.pose.apply(shape.at(point as usize)));
        }
        let freedom = (2.0 * system.weight - 6.0).max(1.0);
        Some(FaceFit {
            state: *state,
            points_mm,
            image_px,
            visible: self.face.visibility(&state.pose),
            contour: at.contour,
            rms_px: libm::sqrtf(system.squares_px / system.weight.max(1e-6)),
            cost: system.mean_cost(),
            covariance: pose_covariance(&mut system.matrix, system.squares / freedom)?,
        })
    }
}

/// Covariance of the last six unknowns: the inverse of the Schur complement, which is the last
/// block of Cholesky's factor, which the matrix is overwritten by.
fn pose_covariance(
    factor: &mut [[f32; UNKNOWNS]; UNKNOWNS],
    variance: f32,
) -> Option<[[f32; 6]; 6]> {
    if !solve_spd(factor, &mut [0.0; UNKNOWNS]) {
        return None;
    }
    let mut block = [[0.0f32; 6]; 6];
    for (to, from) in block.iter_mut().zip(factor.iter().skip(ANIMATIONS)) {
        to.iter_mut()
            .zip(from.iter().skip(ANIMATIONS))
            .for_each(|(t, f)| *t = *f);
    }
    // L·Lᵀ of the block, then its inverse column by column.
    let mut complement = [[0.0f32; 6]; 6];
    for (i, row) in complement.iter_mut().enumerate() {
        for (j, out) in row.iter_mut().enumerate() {
            let both = block.iter().enumerate().filter(|(k, _)| *k == i || *k == j);
            let rows = |n: usize| both.clone().find(|(k, _)| *k == n).map(|(_, r)| *r);
            let (a, b) = (rows(i).unwrap_or_default(), rows(j).unwrap_or_default());
            *out = a.iter().zip(b).take(i.min(j) + 1).map(|(a, b)| a * b).sum();
        }
    }
    let mut covariance = [[0.0f32; 6]; 6];
    for (i, column) in covariance.iter_mut().enumerate() {
        column
            .iter_mut()
            .enumerate()
            .for_each(|(k, c)| *c = if k == i { variance } else { 0.0 });
        if !solve_spd(&mut complement.clone(), column) {
            return None;
        }
    }
    Some(covariance)
}
