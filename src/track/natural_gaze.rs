//! What is always wrong with a person's gaze, learnt from where people look most: straight ahead.
//!
//! An eyeball's centre and the pose of the head are off by a little for each person, and a
//! millimetre of the eyeball is 4° of the gaze. What a gaze is off by stays the same from frame to
//! frame. The mean of the gaze in the head frame is that error and where the person really looks on
//! average, so part of it is taken off.

use super::eye::Gaze;
use super::geometry::gaze_angles;
use super::policy::{
    NATURAL_GAZE_CUT_RAD, NATURAL_GAZE_MAX_RAD, NATURAL_GAZE_PRIOR_S, NATURAL_GAZE_S,
    NATURAL_GAZE_SHARE, NATURAL_GAZE_STEP_S,
};
use glam::{Mat3, Vec3};

/// The mean of a person's gaze.
#[derive(Clone)]
pub(super) struct NaturalGaze {
    /// In the head frame, to the subject's left and down \[rad\].
    mean: [f32; 2],
    /// For how long it was learnt \[s\].
    learnt_s: f32,
    /// When the last gaze was \[µs\].
    last_us: i64,
}

impl NaturalGaze {
    /// Nothing is known.
    pub(super) const UNKNOWN: NaturalGaze = NaturalGaze {
        mean: [0.0; 2],
        learnt_s: 0.0,
        last_us: 0,
    };

    /// Learns from a gaze.
    pub(super) fn see(&mut self, gaze: [f32; 2], now_us: i64) {
        let elapsed_s = now_us.saturating_sub(self.last_us) as f32 * 1e-6;
        let step_s = elapsed_s.clamp(0.0, NATURAL_GAZE_STEP_S);
        self.last_us = now_us;
        self.learnt_s = (self.learnt_s + step_s).min(NATURAL_GAZE_S);
        let share = step_s / (NATURAL_GAZE_PRIOR_S + self.learnt_s);
        for (mean, angle) in self.mean.iter_mut().zip(gaze) {
            let away = (angle - *mean).clamp(-NATURAL_GAZE_CUT_RAD, NATURAL_GAZE_CUT_RAD);
            *mean += share * away;
        }
    }

    /// What is to be taken off \[rad\].
    fn offset(&self) -> [f32; 2] {
        let [x, y] = self.mean.map(|angle| NATURAL_GAZE_SHARE * angle);
        let length = libm::sqrtf(x * x + y * y);
        let shorter = NATURAL_GAZE_MAX_RAD / length.max(NATURAL_GAZE_MAX_RAD);
        [shorter * x, shorter * y]
    }

    /// Takes it off a known gaze of a head of this rotation.
    pub(super) fn correct(&self, gaze: &mut Gaze, rotation: &Mat3) {
        let [left, down] = gaze_angles(Vec3::from(gaze.head));
        let [off_left, off_down] = self.offset();
        let (sin_x, cos_x) = libm::sincosf(left - off_left);
        let (sin_y, cos_y) = libm::sincosf(down - off_down);
        let head = Vec3::new(sin_x * cos_y, sin_y, -cos_x * cos_y);
        gaze.head = head.to_array();
        gaze.camera = (*rotation * head).to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::EyeUnknown;

    fn gaze(left: f32, down: f32) -> Gaze {
        let head = [
            left.sin() * down.cos(),
            down.sin(),
            -left.cos() * down.cos(),
        ];
        Gaze {
            unknown: EyeUnknown::Known,
            head,
            camera: head,
            sigma_deg: 5.0,
        }
    }

    #[test]
    fn part_of_what_stays_the_same_is_taken_off() {
        let mut natural = NaturalGaze::UNKNOWN;
        let mut seen = gaze(0.1, -0.05);
        natural.correct(&mut seen, &Mat3::IDENTITY);
        assert!((Vec3::from(seen.head) - Vec3::from(gaze(0.1, -0.05).head)).length() < 1e-6);
        for k in 1..=1500 {
            natural.see([0.1, -0.05], 40_000 * k);
        }
        let [left, down] = natural.offset();
        assert!((left - 0.1 * NATURAL_GAZE_SHARE).abs() < 0.01, "{left}");
        assert!((down + 0.05 * NATURAL_GAZE_SHARE).abs() < 0.01, "{down}");
        natural.correct(&mut seen, &Mat3::IDENTITY);
        let [x, y] = gaze_angles(Vec3::from(seen.camera));
        assert!((x - 0.1 + left).abs() < 1e-5 && (y + 0.05 + down).abs() < 1e-5);
    }

    #[test]
    fn it_is_bounded_and_glances_count_little() {
        let mut natural = NaturalGaze::UNKNOWN;
        for k in 1..=1500 {
            natural.see([0.9, 0.9], 40_000 * k);
        }
        let [x, y] = natural.offset();
        assert!(x.hypot(y) <= NATURAL_GAZE_MAX_RAD + 1e-6);
        let mut natural = NaturalGaze::UNKNOWN;
        for k in 1..=1500 {
            natural.see([if k % 10 == 0 { 1.0 } else { 0.0 }, 0.0], 40_000 * k);
        }
        let [x, _] = natural.offset();
        assert!(x < 0.03, "{x}");
        natural.see([f32::MAX, 0.0], i64::MIN);
        natural.see([0.0, f32::MIN], i64::MAX);
        assert!(natural.offset().iter().all(|v| v.is_finite()));
    }
}
