//! Adaptive local appearance models of the tracked person (thesis 3.4), on the cascade's features.
//!
//! Mean and variance of every feature at every landmark follow the frames of one person at one rate
//! (the thesis's α and β are equal here). A landmark that differs from its model is less likely
//! visible. A face some of whose landmarks match their models is likely still there, whatever
//! occludes the others. Drift is bounded: only the trained classifiers select the samples for an
//! update, and the influence on a probability is limited.

use crate::math::{sigmoid, sum};
use crate::network::MAX_FEATURES;
use crate::shape::LANDMARKS;
use crate::track::policy::{
    APPEARANCE_MATCH, APPEARANCE_MATCH_VISIBILITY, APPEARANCE_MAX_CHANGE, APPEARANCE_MIN_FRAMES,
    APPEARANCE_MIN_VISIBILITY, APPEARANCE_RATE, APPEARANCE_VARIANCE,
};
use crate::verifier::Confidence;

/// Fixed-point scale of means: 1 / 128 of a feature's unit, so that ±127 fits an `i16`.
const MEAN_SCALE: i32 = 128;
/// Fixed-point scale of variances: a quarter of a feature's unit squared, so that 127² fits a
/// `u16`.
const VARIANCE_SCALE: i32 = 4;

/// The appearance models of one person's landmarks. Plain data, all zero at first.
#[derive(Clone)]
pub struct Appearance {
    /// Means \[1 / [`MEAN_SCALE`] feature units\].
    mean: [[i16; MAX_FEATURES]; LANDMARKS],
    /// Variances \[1 / [`VARIANCE_SCALE`] feature units²\].
    variance: [[u16; MAX_FEATURES]; LANDMARKS],
    /// Updates so far, by landmark.
    frames: [u16; LANDMARKS],
}

impl Appearance {
    /// Models without any update.
    pub const EMPTY: Appearance = Appearance {
        mean: [[0; MAX_FEATURES]; LANDMARKS],
        variance: [[0; MAX_FEATURES]; LANDMARKS],
        frames: [0; LANDMARKS],
    };

    /// Applies the models to a frame's `features` (`[68][features]`): shifts the visibilities in
    /// `confidence` by the distance of each landmark from its model. Where the face is `trusted`,
    /// updates the models of the landmarks that the classifiers find visible. Returns the number of
    /// landmarks that are visible and match their models.
    #[inline(never)]
    pub fn update(&mut self, features: &[i8], trusted: bool, confidence: &mut Confidence) -> u32 {
        let each = features.len() / LANDMARKS;
        if !(1..=MAX_FEATURES).contains(&each) {
            return 0;
        }
        let mut matching = 0;
        let models = self.mean.iter_mut().zip(&mut self.variance);
        let models = models.zip(&mut self.frames).zip(&mut confidence.visibility);
        let features = features.chunks_exact(each);
        for ((((mean, variance), frames), visibility), features) in models.zip(features) {
            let updates = trusted && *visibility >= APPEARANCE_MIN_VISIBILITY;
            if *frames >= APPEARANCE_MIN_FRAMES {
                let distance = distance(mean, variance, features);
                let change = -distance.clamp(-APPEARANCE_MAX_CHANGE, APPEARANCE_MAX_CHANGE);
                *visibility = with_logit_change(*visibility, change);
                matching += u32::from(
                    distance < APPEARANCE_MATCH && *visibility >= APPEARANCE_MATCH_VISIBILITY,
                );
            }
            if updates {
                update_model(mean, variance, *frames, features);
                *frames = frames.saturating_add(1);
            }
        }
        matching
    }
}

/// Mean squared deviation of a landmark's features from its model, in variances, minus 1: about 0
/// for a typical frame of the person.
fn distance(mean: &[i16], variance: &[u16], features: &[i8]) -> f32 {
    let mut terms = [0.0f32; MAX_FEATURES];
    let models = mean.iter().zip(variance).zip(features);
    for (term, ((mean, variance), feature)) in terms.iter_mut().zip(models) {
        let deviation = f32::from(*feature) - f32::from(*mean) / MEAN_SCALE as f32;
        let variance = f32::from(*variance) / VARIANCE_SCALE as f32 + APPEARANCE_VARIANCE;
        *term = deviation * deviation / variance;
    }
    sum(&terms) / features.len().max(1) as f32 - 1.0
}

/// Exponential moving average of mean and variance; a plain average over the first frames.
fn update_model(mean: &mut [i16], variance: &mut [u16], frames: u16, features: &[i8]) {
    match i32::from(frames) + 1 {
        // The compiler divides by a constant in vectors.
        APPEARANCE_RATE.. => move_towards(mean, variance, features, APPEARANCE_RATE),
        rate => move_towards(mean, variance, features, rate),
    }
}

/// Moves mean and variance by one part in `rate`.
#[inline(always)]
fn move_towards(mean: &mut [i16], variance: &mut [u16], features: &[i8], rate: i32) {
    for ((mean, variance), feature) in mean.iter_mut().zip(variance).zip(features) {
        let deviation = i32::from(*feature) * MEAN_SCALE - i32::from(*mean);
        *mean = (i32::from(*mean) + divide_rounded(deviation, rate)) as i16;
        let units = deviation / MEAN_SCALE;
        let square = (units * units * VARIANCE_SCALE).min(i32::from(u16::MAX));
        let target = if rate == 1 { 0 } else { square };
        let change = divide_rounded(target - i32::from(*variance), rate);
        *variance = (i32::from(*variance) + change).clamp(0, i32::from(u16::MAX)) as u16;
    }
}

/// The quotient rounded to the nearest integer; `divisor` > 0.
fn divide_rounded(value: i32, divisor: i32) -> i32 {
    let half = if value < 0 { -divisor / 2 } else { divisor / 2 };
    (value + half) / divisor.max(1)
}

/// A probability with its logit changed.
fn with_logit_change(probability: f32, change: f32) -> f32 {
    let p = probability.clamp(1e-4, 1.0 - 1e-4);
    sigmoid(libm::logf(p / (1.0 - p)) + change)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FEATURES: usize = LANDMARKS * MAX_FEATURES;

    fn face(change: impl Fn(usize) -> i8) -> [i8; FEATURES] {
        core::array::from_fn(|i| 40 + (i % 7) as i8 + change(i))
    }

    fn certain() -> Confidence {
        Confidence {
            face: 1.0,
            landmarks: [1.0; LANDMARKS],
            visibility: [0.8; LANDMARKS],
        }
    }

    #[test]
    fn a_landmark_that_differs_from_its_model_is_less_visible() {
        let mut appearance = Appearance::EMPTY;
        for n in 0..40 {
            let mut confidence = certain();
            appearance.update(&face(|i| ((i + n) % 3) as i8 * 4), true, &mut confidence);
            assert_eq!(confidence.visibility.map(|s| s > 0.5), [true; LANDMARKS]);
        }
        let occluded = face(|i| if i / MAX_FEATURES == 30 { 50 } else { 4 });
        let mut confidence = certain();
        appearance.update(&occluded, true, &mut confidence);
        assert!(
            confidence.visibility[30] < 0.2,
            "{}",
            confidence.visibility[30]
        );
        assert!(
            confidence.visibility[31] > 0.8,
            "{}",
            confidence.visibility[31]
        );
    }

    #[test]
    fn unoccluded_landmarks_match_their_models() {
        let mut appearance = Appearance::EMPTY;
        for n in 0..40 {
            let frame = face(|i| ((i + n) % 3) as i8 * 4);
            let matching = appearance.update(&frame, true, &mut certain());
            let all = if n < usize::from(APPEARANCE_MIN_FRAMES) {
                0
            } else {
                LANDMARKS
            };
            assert_eq!(matching, all as u32);
        }
        for occluded in [40, 60, LANDMARKS] {
            let frame = face(|i| if i / MAX_FEATURES < occluded { 50 } else { 4 });
            let matching = appearance.update(&frame, false, &mut certain());
            assert_eq!(matching, (LANDMARKS - occluded) as u32);
        }
    }

    #[test]
    fn untrusted_frames_do_not_update_the_models() {
        let mut appearance = Appearance::EMPTY;
        for _ in 0..40 {
            let mut confidence = Confidence {
                face: 0.5,
                ..certain()
            };
            appearance.update(&face(|_| 0), false, &mut confidence);
            let mut confidence = Confidence {
                visibility: [0.3; LANDMARKS],
                ..certain()
            };
            appearance.update(&face(|_| 0), true, &mut confidence);
        }
        assert_eq!(appearance.frames, [0; LANDMARKS]);
    }

    #[test]
    fn extreme_features_stay_in_range() {
        let mut appearance = Appearance::EMPTY;
        for n in 0..300 {
            let value = if n % 2 == 0 { i8::MIN } else { i8::MAX };
            let mut confidence = certain();
            appearance.update(&[value; FEATURES], true, &mut confidence);
            assert!(
                confidence
                    .visibility
                    .iter()
                    .all(|s| (0.0..=1.0).contains(s))
            );
        }
        let mut confidence = certain();
        appearance.update(&[], true, &mut confidence);
        appearance.update(&[1, 2, 3], true, &mut confidence);
    }
}
