//! What is learnt of a person's eyes over many frames: glasses, and what is always wrong with the
//! gaze.
//!
//! Glasses do not come and go as what is taken for them does, so it is their mean over seconds that
//! counts.
//!
//! An eyeball's centre and the pose of the head are off by a little for each person, and a
//! millimetre of the eyeball is 4° of the gaze. What a gaze is off by stays the same from frame to
//! frame. The mean of the gaze in the head frame is that error and where the person really looks on
//! average, which is mostly straight ahead, so part of it is taken off.

use super::result::{Eyes, Gaze};
use crate::align::SeenEye;
use crate::shape::Pose;
use crate::track::geometry::gaze_angles;
use crate::track::policy::{
    EYE_GLASSES, GLASSES_S, GLASSES_STEP_S, NATURAL_GAZE_CUT_RAD, NATURAL_GAZE_FACING_COSINE,
    NATURAL_GAZE_MAX_RAD, NATURAL_GAZE_PRIOR_S, NATURAL_GAZE_S, NATURAL_GAZE_SHARE,
    NATURAL_GAZE_STEP_S,
};
use glam::{Mat3, Vec3};

/// What is learnt of one person.
#[derive(Clone)]
pub struct PersonsEyes {
    glasses: Glasses,
    natural_gaze: NaturalGaze,
}

impl PersonsEyes {
    /// Nothing is known.
    pub const UNKNOWN: PersonsEyes = PersonsEyes {
        glasses: Glasses::NONE,
        natural_gaze: NaturalGaze::UNKNOWN,
    };

    /// Whether the person wears glasses.
    pub fn wear_glasses(&self) -> bool {
        self.glasses.are_worn()
    }

    /// Takes what one frame says of glasses.
    pub fn see_glasses(&mut self, seen: &GlassesSeen, now_us: i64) {
        if let Some(probability) = seen.before_visible() {
            self.glasses.see(probability, now_us);
        }
    }

    /// Learns from the gaze of both eyes, and takes off what is always wrong with it.
    #[inline(never)]
    pub fn correct(&mut self, eyes: &mut Eyes, pose: &Pose, now_us: i64) {
        let faces = pose.facing_cosine() >= NATURAL_GAZE_FACING_COSINE;
        if let Ok(gaze) = eyes.gaze
            && faces
        {
            let angles = gaze_angles(Vec3::from(gaze.head));
            self.natural_gaze.see(angles, now_us);
        }
        let [left, right] = &mut eyes.each;
        let gazes = [&mut left.gaze, &mut right.gaze, &mut eyes.gaze];
        for gaze in gazes.into_iter().flatten() {
            self.natural_gaze.correct(gaze, &pose.rotation);
        }
    }
}

/// The mean of what the network of single eyes says of glasses, over some seconds.
#[derive(Clone, Copy)]
struct Glasses {
    probability: f32,
    /// When it was last said \[µs\].
    last_us: i64,
}

impl Glasses {
    /// None so far.
    const NONE: Glasses = Glasses {
        probability: 0.0,
        last_us: 0,
    };

    /// Takes the probability of glasses before eyes whose landmarks are visible.
    fn see(&mut self, probability: f32, now_us: i64) {
        let elapsed_s = now_us.saturating_sub(self.last_us) as f32 * 1e-6;
        let share = elapsed_s.clamp(0.0, GLASSES_STEP_S) / GLASSES_S;
        self.last_us = now_us;
        self.probability += share * (probability - self.probability);
    }

    /// Whether the person wears glasses.
    fn are_worn(&self) -> bool {
        self.probability >= EYE_GLASSES
    }
}

/// What the network says in one step of glasses before the eyes.
#[derive(Default)]
pub struct GlassesSeen {
    /// Sums of the probabilities of glasses and of dark ones.
    sums: [f32; 2],
    count: f32,
    /// Sum of that of glasses before eyes whose landmarks are visible.
    visible_sum: f32,
    visible_count: f32,
}

impl GlassesSeen {
    /// Adds an eye.
    pub fn add(&mut self, seen: &SeenEye, has_landmarks: bool) {
        self.sums[0] += seen.glasses;
        self.sums[1] += seen.dark;
        self.count += 1.0;
        if has_landmarks {
            self.visible_sum += seen.glasses;
            self.visible_count += 1.0;
        }
    }

    /// Probabilities of glasses and of dark ones, if an eye was seen.
    pub fn mean(&self) -> Option<[f32; 2]> {
        (self.count > 0.0).then(|| self.sums.map(|sum| sum / self.count))
    }

    /// Probability of glasses before eyes whose landmarks are visible, if there are any.
    fn before_visible(&self) -> Option<f32> {
        (self.visible_count > 0.0).then(|| self.visible_sum / self.visible_count)
    }
}

/// The mean of a person's gaze.
#[derive(Clone)]
struct NaturalGaze {
    /// In the head frame, to the person's left and down \[rad\].
    mean: [f32; 2],
    /// For how long it was learnt \[s\].
    learnt_s: f32,
    /// When the last gaze was \[µs\].
    last_us: i64,
}

impl NaturalGaze {
    /// Nothing is known.
    const UNKNOWN: NaturalGaze = NaturalGaze {
        mean: [0.0; 2],
        learnt_s: 0.0,
        last_us: 0,
    };

    /// Learns from a gaze.
    fn see(&mut self, gaze: [f32; 2], now_us: i64) {
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
    fn correct(&self, gaze: &mut Gaze, rotation: &Mat3) {
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

    #[test]
    fn glasses_are_worn_for_seconds() {
        let mut glasses = Glasses::NONE;
        assert!(!glasses.are_worn());
        for frame in 1..=100 {
            glasses.see(0.9, frame * 40_000);
        }
        assert!(glasses.are_worn());
        for frame in 101..=105 {
            glasses.see(0.0, frame * 40_000);
        }
        assert!(glasses.are_worn());
        // A clock that jumps counts as a short step.
        glasses.see(0.0, i64::MAX);
        glasses.see(0.0, i64::MIN);
        assert!((0.0..=1.0).contains(&glasses.probability));
    }

    fn gaze(left: f32, down: f32) -> Gaze {
        let head = [
            left.sin() * down.cos(),
            down.sin(),
            -left.cos() * down.cos(),
        ];
        Gaze {
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
