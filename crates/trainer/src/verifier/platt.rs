//! Calibration of scores to probabilities (Platt 1999).

/// Newton steps; the loss is convex and has one or two slopes.
const STEPS: usize = 30;
/// Longest step, so that scores that separate the classes do not run away.
const MAX_STEP: f64 = 4.0;
/// Where the slope of the second input starts.
const SECOND_SLOPE: f64 = 0.2;

/// Logistic fit of labels to score and a second input, if there is one: slopes and offset. Without
/// weights all count the same. Targets are a little inside 0 and 1 (Lin, Lin and Weng 2007).
pub fn platt(
    scores: &[f32],
    labels: &[bool],
    weights: Option<&[f32]>,
    second: Option<&[f32]>,
) -> ([f32; 2], f32) {
    let positives = labels.iter().filter(|l| **l).count() as f64;
    let negatives = labels.len() as f64 - positives;
    let (high, low) = (
        (positives + 1.0) / (positives + 2.0),
        1.0 / (negatives + 2.0),
    );
    let start = if second.is_some() { SECOND_SLOPE } else { 0.0 };
    let mut w = nalgebra::Vector3::new(1.0, start, 0.0);
    for _ in 0..STEPS {
        let mut gradient = nalgebra::Vector3::zeros();
        let mut hessian = nalgebra::Matrix3::identity() * 1e-3;
        for (k, (score, label)) in scores.iter().zip(labels).enumerate() {
            let (weight, second) = (weights.map_or(1.0, |w| w[k]), second.map_or(0.0, |t| t[k]));
            let x = nalgebra::Vector3::new(f64::from(*score), f64::from(second), 1.0);
            let p = 1.0 / (1.0 + (-w.dot(&x)).exp());
            let weight = f64::from(weight);
            gradient += x * weight * (p - if *label { high } else { low });
            hessian += x * x.transpose() * weight * (p * (1.0 - p)).max(1e-6);
        }
        let step = hessian.lu().solve(&gradient);
        w -= step.unwrap_or_default().cap_magnitude(MAX_STEP);
    }
    ([w[0] as f32, w[1] as f32], w[2] as f32)
}
