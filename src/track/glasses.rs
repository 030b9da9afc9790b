//! Whether a person wears glasses: what the network of single eyes says in a step, and its mean
//! over seconds, because glasses do not come and go as what is taken for them does.

use super::policy::{EYE_GLASSES, GLASSES_S, GLASSES_STEP_S};
use crate::align::SeenEye;

/// The mean of what the network of single eyes says of glasses, over some seconds.
#[derive(Clone, Copy)]
pub(super) struct Glasses {
    probability: f32,
    /// When it was last said \[µs\].
    last_us: i64,
}

impl Glasses {
    /// None so far.
    pub(super) const NONE: Glasses = Glasses {
        probability: 0.0,
        last_us: 0,
    };

    /// Takes the probability of glasses before eyes whose landmarks are visible.
    pub(super) fn see(&mut self, probability: f32, now_us: i64) {
        let elapsed_s = now_us.saturating_sub(self.last_us) as f32 * 1e-6;
        let share = elapsed_s.clamp(0.0, GLASSES_STEP_S) / GLASSES_S;
        self.last_us = now_us;
        self.probability += share * (probability - self.probability);
    }

    /// Whether the person wears glasses.
    pub(super) fn are_worn(&self) -> bool {
        self.probability >= EYE_GLASSES
    }
}

/// What the network says in one step of glasses before the eyes.
#[derive(Default)]
pub(super) struct Lenses {
    /// Sums of the probabilities of glasses and of dark ones.
    sums: [f32; 2],
    count: f32,
    /// Sum of that of glasses before eyes whose landmarks are visible.
    visible_sum: f32,
    visible_count: f32,
}

impl Lenses {
    /// Adds an eye.
    pub(super) fn add(&mut self, seen: &SeenEye, has_landmarks: bool) {
        self.sums[0] += seen.glasses;
        self.sums[1] += seen.dark;
        self.count += 1.0;
        if has_landmarks {
            self.visible_sum += seen.glasses;
            self.visible_count += 1.0;
        }
    }

    /// Probabilities of glasses and of dark ones, if an eye was seen.
    pub(super) fn mean(&self) -> Option<[f32; 2]> {
        (self.count > 0.0).then(|| self.sums.map(|sum| sum / self.count))
    }

    /// Probability of glasses before eyes whose landmarks are visible, if there are any.
    pub(super) fn before_visible(&self) -> Option<f32> {
        (self.visible_count > 0.0).then(|| self.visible_sum / self.visible_count)
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
}
