//! The state whose landmarks come nearest to points of the image: Gauss–Newton with a Gaussian
//! prior around the predicted state, as the second step of the fits of the thesis (4.4, 5.2).

use super::person::Sketch;
use super::state::{RIGID, SIGMA, SIZE, State};
use nalgebra::{DMatrix, DVector};

/// A point that a landmark should be at.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Landmark.
    pub landmark: usize,
    /// \[px\].
    pub at: [f32; 2],
    /// 0 to 1.
    pub weight: f32,
}

/// Standard deviation of a target \[mm\].
const NOISE_MM: f64 = 2.0;
/// Distance at which a target counts half, because it is probably wrong \[standard deviations\].
const FAR: f64 = 4.0;
/// Gauss–Newton iterations.
const ITERATIONS: usize = 4;
/// Difference that the Jacobian is computed with \[standard deviations of the prior\].
const DELTA: f64 = 1e-2;

/// Which numbers of the state may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// Rotation and translation.
    Pose,
    /// All.
    All,
}

/// The most probable state near `prior`, whose standard deviations are [`SIGMA`] times `wide`;
/// `None` without enough targets.
pub fn fit(
    head: &Sketch<'_>,
    prior: &State,
    targets: &[Target],
    free: Free,
    wide: f64,
) -> Option<State> {
    let size = match free {
        Free::Pose => RIGID,
        Free::All => SIZE,
    };
    let usable = targets.iter().filter(|t| t.weight > 0.0).count();
    if usable < RIGID {
        return None;
    }
    let state = |deviations: &DVector<f64>| {
        let mut step = [0.0; SIZE];
        for (k, d) in deviations.iter().enumerate() {
            step[k] = d * wide * SIGMA[k];
        }
        prior.moved(&step)
    };
    let noise = NOISE_MM * f64::from(head.camera.fx / prior.translation.z);
    let distances = |deviations: &DVector<f64>| {
        let state = state(deviations);
        let off = targets.iter().flat_map(|t| {
            let [x, y] = head.image(&state, t.landmark);
            [x - t.at[0], y - t.at[1]].map(|d| f64::from(d) / noise)
        });
        DVector::from_iterator(2 * targets.len(), off)
    };
    let mut deviations = DVector::zeros(size);
    for _ in 0..ITERATIONS {
        let here = distances(&deviations);
        let weights: Vec<f64> = (targets.iter().enumerate())
            .map(|(k, t)| {
                let squared = here[2 * k].powi(2) + here[2 * k + 1].powi(2);
                f64::from(t.weight) / (1.0 + squared / (FAR * FAR))
            })
            .collect();
        let mut jacobian = DMatrix::zeros(here.len(), size);
        for k in 0..size {
            let mut moved = deviations.clone();
            moved[k] += DELTA;
            jacobian.set_column(k, &((distances(&moved) - &here) / DELTA));
        }
        let weighted = DMatrix::from_fn(here.len(), size, |r, c| jacobian[(r, c)] * weights[r / 2]);
        let normal = weighted.tr_mul(&jacobian) + DMatrix::identity(size, size);
        let gradient = weighted.tr_mul(&here) + &deviations;
        deviations -= normal.cholesky()?.solve(&gradient);
    }
    Some(state(&deviations))
}
