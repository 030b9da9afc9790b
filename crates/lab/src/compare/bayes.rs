//! The Bayesian loop (thesis 3.1) that all comparators share: the state of a frame is the maximum
//! of prior and likelihood, found by Nelder–Mead from the state of the frame before.

use super::picture::Picture;
use super::scorer::Scorer;
use super::state::{DAMPING, RIGID, SIGMA, SIZE, State, Step};
use anyhow::Result;
use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;

/// The search.
#[derive(Clone, Debug, clap::Args, serde::Serialize)]
pub struct Search {
    /// Weight of the likelihood's energy against the prior's; the method's own without it.
    #[arg(long)]
    pub weight: Option<f64>,
    /// Steps of Nelder–Mead for pose.
    #[arg(long, default_value_t = 80)]
    pub rigid_steps: u64,
    /// Steps of Nelder–Mead for pose and animation.
    #[arg(long, default_value_t = 120)]
    pub full_steps: u64,
}

/// First steps of Nelder–Mead \[standard deviations of the prior\].
const SIMPLEX: f64 = 0.7;
/// Standard deviation of the simplex's costs at which it has converged.
const CONVERGED: f64 = 1e-4;

/// The tracker's memory.
pub struct Loop {
    state: State,
    motion: Step,
    weight: f64,
    steps: [u64; 2],
}

/// Negative logarithm of the posterior, of the first numbers of a step.
#[derive(Clone, Copy)]
struct Posterior<'a> {
    scorer: &'a dyn Scorer,
    frame: &'a Picture,
    start: &'a State,
    weight: f64,
}

impl Posterior<'_> {
    /// The state after a change of these prior standard deviations.
    fn state(&self, deviations: &[f64]) -> State {
        let mut step = [0.0; SIZE];
        let scaled = deviations.iter().zip(SIGMA).map(|(d, sigma)| d * sigma);
        step.iter_mut().zip(scaled).for_each(|(s, v)| *s = v);
        self.start.moved(&step)
    }
}

impl CostFunction for Posterior<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, deviations: &Vec<f64>) -> Result<f64> {
        let energy = self.scorer.energy(self.frame, &self.state(deviations));
        let prior = deviations.iter().map(|d| d * d).sum::<f64>() / 2.0;
        Ok(self.weight * energy + prior)
    }
}

impl Loop {
    /// Begins at the first frame's state.
    pub fn new(first: &State, weight: f64, search: &Search) -> Loop {
        Loop {
            state: *first,
            motion: [0.0; SIZE],
            weight: search.weight.unwrap_or(weight),
            steps: [search.rigid_steps, search.full_steps],
        }
    }

    /// Of the last frame.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The next frame. `matched` is where wide-baseline matching found the head.
    pub fn step(
        &mut self,
        scorer: &mut dyn Scorer,
        frame: &Picture,
        matched: Option<State>,
    ) -> Result<State> {
        let predicted = self.state.moved(&self.motion);
        let mut start = self.state;
        let mut least = f64::INFINITY;
        // Each is compared with what the person looks like from there.
        for state in [predicted, self.state].into_iter().chain(matched) {
            scorer.prepare(&state);
            let energy = scorer.energy(frame, &state);
            if energy < least {
                (start, least) = (state, energy);
            }
        }
        scorer.prepare(&start);
        let posterior = Posterior {
            scorer: &*scorer,
            frame,
            start: &start,
            weight: self.weight,
        };
        // The pose first, then all: a simplex of all numbers moves slowly.
        let mut deviations = Vec::new();
        for (size, steps) in [RIGID, SIZE].into_iter().zip(self.steps) {
            deviations.resize(size, 0.0);
            deviations = search_from(&posterior, deviations, steps)?;
        }
        let best = posterior.state(&deviations);
        let motion = best.motion_since(&self.state);
        self.motion = motion.map(|v| DAMPING * v);
        self.state = best;
        scorer.accept(frame, &best);
        Ok(best)
    }
}

/// Nelder–Mead from these deviations.
fn search_from(posterior: &Posterior<'_>, from: Vec<f64>, steps: u64) -> Result<Vec<f64>> {
    let corner = |k: usize| {
        let mut corner = from.clone();
        if let Some(number) = k.checked_sub(1) {
            // Away from the bound, where a weight is near it.
            let unit = number.checked_sub(RIGID);
            let is_high = unit.is_some_and(|unit| posterior.start.units[unit] > 0.5);
            corner[number] += if is_high { -SIMPLEX } else { SIMPLEX };
        }
        corner
    };
    let solver = NelderMead::new((0..=from.len()).map(corner).collect());
    let solver = solver.with_sd_tolerance(CONVERGED)?;
    let executor = Executor::new(*posterior, solver).configure(|state| state.max_iters(steps));
    Ok(executor.run()?.state.best_param.unwrap_or(from))
}

#[cfg(test)]
mod tests {
    use super::super::state::UNITS;
    use super::*;
    use glam::{Mat3, Vec3};

    /// Likes one state.
    struct Target(State);

    impl Scorer for Target {
        fn prepare(&mut self, _: &State) {}

        fn energy(&self, _: &Picture, state: &State) -> f64 {
            let step = state.motion_since(&self.0);
            let scaled = step.iter().zip(SIGMA).map(|(d, sigma)| (d / sigma).powi(2));
            scaled.sum::<f64>() + f64::from(state.units[5] - self.0.units[5]).powi(2)
        }

        fn accept(&mut self, _: &Picture, _: &State) {}
    }

    #[test]
    fn a_moving_target_is_followed() {
        let frame = Picture {
            width: 1,
            height: 1,
            pixels: vec![0.0],
        };
        let first = State {
            rotation: Mat3::IDENTITY,
            translation: Vec3::new(0.0, 0.0, 600.0),
            units: [0.0; UNITS.len()],
        };
        let search = Search {
            weight: None,
            rigid_steps: 150,
            full_steps: 300,
        };
        let mut tracker = Loop::new(&first, 100.0, &search);
        let mut scorer = Target(first);
        for frame_number in 1..=20 {
            let turned = 0.03 * frame_number as f32;
            scorer.0.rotation = Mat3::from_rotation_y(turned);
            scorer.0.units[5] = 0.5;
            let found = tracker.step(&mut scorer, &frame, None).unwrap();
            let off = found.motion_since(&scorer.0);
            assert!(off[..3].iter().all(|v| v.abs() < 0.02), "{off:?}");
        }
        assert!((tracker.state.units[5] - 0.5).abs() < 0.2);
    }
}
