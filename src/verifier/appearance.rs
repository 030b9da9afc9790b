//! What a person's own landmarks look like: adaptive local models (thesis 3.4) on the cascade's
//! features.
//!
//! Mean and variance of every feature at every landmark follow the frames of one person, with the
//! same rate for both (the thesis's α and β). A landmark that looks less like itself than usual is
//! less likely seen, and a face some of whose landmarks look like themselves is likely still there,
//! whatever covers the others. Drift is bounded: only the trained classifiers decide what is learnt
//! from, never what was learnt, and the person's say is limited.

use super::Confidence;
use crate::math::sigmoid;
use crate::network::MAX_FEATURES;
use crate::shape::LANDMARKS;

/// Means are counted in so many parts of a feature's unit, variances in quarters of its square.
const MEAN_PARTS: i32 = 128;
const VARIANCE_PARTS: i32 = 4;
/// A frame moves means and variances by 1 / 64 of the way.
const RATE: i32 = 64;
/// Added to variances, so that distances are finite.
const FLOOR: f32 = 16.0;
/// Frames before the person has a say.
const FIRST: u32 = 10;
/// Only landmarks that are at least this surely seen teach.
const SEEN: f32 = 0.7;
/// Most that the person can change a logit.
const MOST: f32 = 4.0;
/// A landmark that is less than this far from its model looks like itself.
const ALIKE: f32 = 0.5;

/// Landmarks that are learnt: none in builds that lack the features.
const LEARNT: usize = if cfg!(all(feature = "verifier", feature = "adaptation")) {
    LANDMARKS
} else {
    0
};

/// One person's landmarks. Plain data, all zero for nobody.
#[derive(Clone)]
pub struct Appearance {
    mean: [[i16; MAX_FEATURES]; LEARNT],
    variance: [[u16; MAX_FEATURES]; LEARNT],
    frames: [u16; LEARNT],
}

impl Appearance {
    /// Nobody yet.
    pub const EMPTY: Appearance = Appearance {
        mean: [[0; MAX_FEATURES]; LEARNT],
        variance: [[0; MAX_FEATURES]; LEARNT],
        frames: [0; LEARNT],
    };

    /// Takes the next frame's features (landmark by landmark): betters what the trained classifiers
    /// say of seen and hidden, and learns from what they are sure of where the face is `trusted`.
    /// Returns how many landmarks are seen and look like themselves.
    #[inline(never)]
    pub fn follow(&mut self, features: &[i8], trusted: bool, confidence: &mut Confidence) -> u32 {
        let each = features.len() / LANDMARKS;
        if !(1..=MAX_FEATURES).contains(&each) {
            return 0;
        }
        let mut recognised = 0;
        let models = self.mean.iter_mut().zip(&mut self.variance);
        let models = models.zip(&mut self.frames).zip(&mut confidence.visibility);
        let features = features.chunks_exact(each);
        for ((((mean, variance), frames), seen), features) in models.zip(features) {
            let learns = trusted && *seen >= SEEN;
            if u32::from(*frames) >= FIRST {
                let apart = distance(mean, variance, features);
                *seen = shifted(*seen, -apart.clamp(-MOST, MOST));
                recognised += u32::from(apart < ALIKE && *seen >= 0.5);
            }
            if learns {
                learn(mean, variance, *frames, features);
                *frames = frames.saturating_add(1);
            }
        }
        recognised
    }
}

/// Mean squared distance from the model in its own deviations, less 1.
fn distance(mean: &[i16], variance: &[u16], features: &[i8]) -> f32 {
    let mut sum = 0.0f32;
    for ((mean, variance), feature) in mean.iter().zip(variance).zip(features) {
        let off = f32::from(*feature) - f32::from(*mean) / MEAN_PARTS as f32;
        sum += off * off / (f32::from(*variance) / VARIANCE_PARTS as f32 + FLOOR);
    }
    sum / features.len().max(1) as f32 - 1.0
}

fn learn(mean: &mut [i16], variance: &mut [u16], frames: u16, features: &[i8]) {
    // The first frames count alike.
    let rate = (i32::from(frames) + 1).min(RATE);
    for ((mean, variance), feature) in mean.iter_mut().zip(variance).zip(features) {
        let off = i32::from(*feature) * MEAN_PARTS - i32::from(*mean);
        *mean = (i32::from(*mean) + rounded(off, rate)) as i16;
        let whole = off / MEAN_PARTS;
        let square = (whole * whole * VARIANCE_PARTS).min(i32::from(u16::MAX));
        let first = if frames == 0 { 0 } else { square };
        let change = rounded(first - i32::from(*variance), rate);
        *variance = (i32::from(*variance) + change).clamp(0, i32::from(u16::MAX)) as u16;
    }
}

/// A quotient rounded to the nearest whole number; `by` > 0.
fn rounded(value: i32, by: i32) -> i32 {
    let half = if value < 0 { -by / 2 } else { by / 2 };
    (value + half) / by.max(1)
}

/// A probability after a change of its logit.
fn shifted(probability: f32, by: f32) -> f32 {
    let p = probability.clamp(1e-4, 1.0 - 1e-4);
    sigmoid(libm::logf(p / (1.0 - p)) + by)
}

#[cfg(all(test, feature = "verifier", feature = "adaptation"))]
mod tests {
    use super::*;

    const FEATURES: usize = LANDMARKS * MAX_FEATURES;

    fn face(change: impl Fn(usize) -> i8) -> [i8; FEATURES] {
        core::array::from_fn(|i| 40 + (i % 7) as i8 + change(i))
    }

    fn sure() -> Confidence {
        Confidence {
            face: 1.0,
            landmarks: [1.0; LANDMARKS],
            visibility: [0.8; LANDMARKS],
        }
    }

    #[test]
    fn a_landmark_that_looks_unlike_itself_is_less_seen() {
        let mut person = Appearance::EMPTY;
        for n in 0..40 {
            let mut confidence = sure();
            person.follow(&face(|i| ((i + n) % 3) as i8 * 4), true, &mut confidence);
            assert_eq!(confidence.visibility.map(|s| s > 0.5), [true; LANDMARKS]);
        }
        let covered = face(|i| if i / MAX_FEATURES == 30 { 50 } else { 4 });
        let mut confidence = sure();
        person.follow(&covered, true, &mut confidence);
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
    fn a_face_is_recognised_by_what_is_left_of_it() {
        let mut person = Appearance::EMPTY;
        for n in 0..40 {
            let frame = face(|i| ((i + n) % 3) as i8 * 4);
            let recognised = person.follow(&frame, true, &mut sure());
            let all = if n < FIRST as usize { 0 } else { LANDMARKS };
            assert_eq!(recognised, all as u32);
        }
        for covered in [40, 60, LANDMARKS] {
            let frame = face(|i| if i / MAX_FEATURES < covered { 50 } else { 4 });
            let recognised = person.follow(&frame, false, &mut sure());
            assert_eq!(recognised, (LANDMARKS - covered) as u32);
        }
    }

    #[test]
    fn nothing_is_learnt_from_what_is_not_trusted() {
        let mut person = Appearance::EMPTY;
        for _ in 0..40 {
            let mut confidence = Confidence {
                face: 0.5,
                ..sure()
            };
            person.follow(&face(|_| 0), false, &mut confidence);
            let mut confidence = Confidence {
                visibility: [0.3; LANDMARKS],
                ..sure()
            };
            person.follow(&face(|_| 0), true, &mut confidence);
        }
        assert_eq!(person.frames, [0; LANDMARKS]);
    }

    #[test]
    fn extreme_features_stay_in_range() {
        let mut person = Appearance::EMPTY;
        for n in 0..300 {
            let value = if n % 2 == 0 { i8::MIN } else { i8::MAX };
            let mut confidence = sure();
            person.follow(&[value; FEATURES], true, &mut confidence);
            assert!(
                confidence
                    .visibility
                    .iter()
                    .all(|s| (0.0..=1.0).contains(s))
            );
        }
        let mut confidence = sure();
        person.follow(&[], true, &mut confidence);
        person.follow(&[1, 2, 3], true, &mut confidence);
    }
}
