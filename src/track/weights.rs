//! Animation weights that are seen, beside those of the fit: less what the person's face at rest
//! seems to have of them.
//!
//! Lips, lids and cheeks differ from person to person, so that a neutral face seems to have some of
//! a weight. Faces are at rest most of the time, and no weight is negative: what a weight seldom
//! falls below is its rest. It follows what is seen slowly, down faster than up, and not beyond a
//! bound.

use super::fit::Fitted;
use super::policy::{
    REST_CUT, REST_FACING_COSINE, REST_MAX, REST_PRIOR_S, REST_RISE, REST_S, REST_STEP_S,
    TRUST_CONFIDENCE, WEIGHT_HIDDEN, WEIGHT_SHOWN,
};
use super::step::Step;
use crate::align::{FaceGeometry, MIDDLE_WEIGHTS, WEIGHT_OUTPUTS, Workspace};
use crate::shape::{ANIMATIONS, FITTED, LANDMARKS, NEAREST_MM};
use glam::Vec3;

/// Number of weights that are seen.
const SEEN: usize = ANIMATIONS - FITTED;

/// Weights that are seen, in the order of [`ANIMATION_NAMES`](crate::ANIMATION_NAMES) after the
/// fitted ones.
type SeenWeights = [f32; SEEN];

/// For each weight that is seen the output that it is. Other outputs of the network say too little.
const OUTPUTS: [Output; SEEN] = [
    Output::Middle(0),
    Output::Middle(2),
    Output::Left(2),
    Output::Right(2),
    Output::Middle(3),
];

/// An output of the network: of the middle, or of a side.
#[derive(Clone, Copy)]
enum Output {
    Middle(usize),
    Left(usize),
    Right(usize),
}

/// First landmark of the mouth, which shows all of them, and how many it has.
const MOUTH: (usize, usize) = (48, 20);

/// What the weights of a person's face at rest are.
#[derive(Clone)]
pub struct PersonsRest {
    rest: SeenWeights,
    /// For how long it was learnt \[s\].
    learnt_s: f32,
    /// When it was last seen \[µs\].
    last_us: i64,
}

impl PersonsRest {
    /// Nothing is known.
    pub const UNKNOWN: PersonsRest = PersonsRest {
        rest: [0.0; SEEN],
        learnt_s: 0.0,
        last_us: 0,
    };

    /// Learns from the weights of a trusted frame.
    fn see(&mut self, weights: &SeenWeights, now_us: i64) {
        let elapsed_s = now_us.saturating_sub(self.last_us) as f32 * 1e-6;
        let step_s = elapsed_s.clamp(0.0, REST_STEP_S);
        self.last_us = now_us;
        self.learnt_s = (self.learnt_s + step_s).min(REST_S);
        let share = step_s / (REST_PRIOR_S + self.learnt_s);
        for (rest, weight) in self.rest.iter_mut().zip(weights) {
            let away = (weight - *rest).clamp(-REST_CUT, REST_CUT);
            let rate = if away > 0.0 { REST_RISE } else { 1.0 };
            *rest = (*rest + share * rate * away).clamp(-REST_MAX, REST_MAX);
        }
    }
}

/// All weights of a face that the refiners have just seen; those that are seen are 0 with a model
/// without them.
#[inline(never)]
pub fn see(
    step: &Step<'_>,
    fitted: &Fitted<'_>,
    person: &mut PersonsRest,
    work: &mut Workspace,
) -> [f32; ANIMATIONS] {
    let fitted_weights = &fitted.fit.state.animation;
    let mut all = [0.0; ANIMATIONS];
    for (out, weight) in all.iter_mut().zip(fitted_weights) {
        *out = *weight;
    }
    let model = step.model.align.weights();
    let Some(outputs) = model.run(&geometry(fitted), work.seen()) else {
        return all;
    };
    let weights = OUTPUTS.map(|output| value(&outputs, output));
    let is_trusted = fitted.confidence().face >= TRUST_CONFIDENCE;
    if is_trusted && fitted.fit.state.pose.facing_cosine() >= REST_FACING_COSINE {
        person.see(&weights, step.now_us);
    }
    let shown = mouth_shown(fitted);
    let seen = weights.iter().zip(&person.rest);
    for (out, (weight, rest)) in all.iter_mut().skip(FITTED).zip(seen) {
        *out = ((weight - rest) * shown).clamp(0.0, 1.0);
    }
    all
}

/// An output; that of the middle is the mean of both sides'.
fn value([right, left]: &[[f32; WEIGHT_OUTPUTS]; 2], output: Output) -> f32 {
    let at = |side: &[f32; WEIGHT_OUTPUTS], index: usize| side.get(index).copied();
    let value = match output {
        Output::Middle(k) => (at(left, k).zip(at(right, k))).map(|(a, b)| 0.5 * (a + b)),
        Output::Left(k) => at(left, MIDDLE_WEIGHTS + k),
        Output::Right(k) => at(right, MIDDLE_WEIGHTS + k),
    };
    value.unwrap_or_default()
}

/// How much of the mouth is shown, 0..1: nothing is said of what something hides.
fn mouth_shown(fitted: &Fitted<'_>) -> f32 {
    let (first, count) = MOUTH;
    let visibility = fitted.confidence().visibility.iter().skip(first);
    let mean = visibility.take(count).sum::<f32>() / count as f32;
    ((mean - WEIGHT_HIDDEN) / (WEIGHT_SHOWN - WEIGHT_HIDDEN)).clamp(0.0, 1.0)
}

/// What a fit leaves of the landmarks, and what it found.
fn geometry(fitted: &Fitted<'_>) -> FaceGeometry {
    let (fit, camera) = (fitted.fit, fitted.camera);
    let to_head = fit.state.pose.rotation.transpose();
    let mut residuals = [[0.0; 2]; LANDMARKS];
    let places = fitted.aligned.undistorted.iter().zip(&fit.image_px);
    for (out, ((seen, expected), point)) in residuals.iter_mut().zip(places.zip(&fit.points_mm)) {
        let depth = point.z.max(NEAREST_MM);
        let right = (seen[0] - expected[0]) * depth / camera.fx;
        let down = (seen[1] - expected[1]) * depth / camera.fy;
        let along = to_head * Vec3::new(right, down, 0.0);
        *out = [along.x, along.y];
    }
    let facing = fit.state.pose.facing_angles();
    FaceGeometry {
        residuals,
        fitted: fit.state.animation,
        turn: [facing.yaw_deg.to_radians(), facing.pitch_deg.to_radians()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::ANIMATION_NAMES;

    #[test]
    fn every_weight_has_its_own_output_of_its_side() {
        let name = |k: usize| ANIMATION_NAMES[FITTED + k];
        for (k, output) in OUTPUTS.iter().enumerate() {
            let side = match output {
                Output::Middle(_) => "",
                Output::Left(_) => "Left",
                Output::Right(_) => "Right",
            };
            assert!(name(k).ends_with(side), "{}", name(k));
            let outputs: [[f32; WEIGHT_OUTPUTS]; 2] =
                core::array::from_fn(|side| core::array::from_fn(|at| (100 * side + at) as f32));
            let place = value(&outputs, *output);
            let others = OUTPUTS.iter().filter(|o| value(&outputs, **o) == place);
            assert_eq!(others.count(), 1, "{}", name(k));
        }
    }

    #[test]
    fn rest_is_what_a_weight_seldom_falls_below() {
        let mut person = PersonsRest::UNKNOWN;
        // At rest most of the time, and an expression of a second every five.
        for k in 1..=1500i64 {
            let expression = if k % 150 < 30 { 0.8 } else { 0.0 };
            person.see(&[0.15 + expression; SEEN], k * 33_333);
        }
        for rest in person.rest {
            assert!((rest - 0.15).abs() < 0.05, "{rest}");
        }
        // A clock that jumps counts as a short step, and the rest is bounded.
        person.see(&[1e9; SEEN], i64::MAX);
        person.see(&[-1e9; SEEN], i64::MIN);
        for _ in 0..100_000 {
            let now = person.last_us.saturating_add(33_333);
            person.see(&[1.0; SEEN], now);
        }
        assert!(person.rest.iter().all(|rest| *rest <= REST_MAX));
    }
}
