//! What a network that need not run in each frame changed when it last ran.
//!
//! The second ensemble member and the mouth's mirrored run each correct a prediction by averaging.
//! Errors that averages take away change slowly from frame to frame, so the correction of a frame
//! holds for the next ones: several faces take turns with these networks.

use super::shape::Shape;
use crate::math::Similarity;
use crate::shape::LANDMARKS;

/// Frames for which a correction is held.
const MOST_FRAMES: u8 = 7;

/// Which networks run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Networks {
    /// Every one of the model.
    All,
    /// Of the global stage the first only, for landmarks that another iteration follows, or that
    /// must not take long.
    First,
    /// Those without which no landmark is seen. What the others changed when they last ran, a few
    /// frames ago on the same face, is held.
    Few,
}

/// A difference of two predictions of all landmarks, in the frame where it is kept.
#[derive(Clone)]
pub struct Correction {
    by: Shape,
    /// Frames for which it may yet be held.
    frames_left: u8,
}

/// Those of a face.
#[derive(Clone)]
pub struct Corrections {
    /// By the second ensemble member \[px of the crop\].
    pub(super) global: Correction,
    /// By the mirrored runs of refiners, in the canonical frame.
    pub(super) refiners: Correction,
}

impl Corrections {
    pub(super) const NONE: Corrections = Corrections {
        global: Correction::NONE,
        refiners: Correction::NONE,
    };
}

impl Correction {
    const NONE: Correction = Correction {
        by: [[0.0; 2]; LANDMARKS],
        frames_left: 0,
    };

    /// Whether it takes the place of the network on this frame, which is counted.
    pub(super) fn holds(&mut self, networks: Networks) -> bool {
        let is_held = networks == Networks::Few && self.frames_left > 0;
        self.frames_left = match is_held {
            true => self.frames_left - 1,
            false => 0,
        };
        is_held
    }

    /// Keeps what has changed from one prediction to the other; `kept` takes their frame to that
    /// in which it is kept.
    pub(super) fn keep(&mut self, from: &Shape, to: &Shape, kept: &Similarity) {
        for ((by, a), b) in self.by.iter_mut().zip(from).zip(to) {
            *by = kept.apply_vector([b[0] - a[0], b[1] - a[1]]);
        }
        self.frames_left = MOST_FRAMES;
    }

    /// Corrects a prediction in the frame to which `place` takes that of the kept correction.
    pub(super) fn add_to(&self, points: &mut Shape, place: &Similarity) {
        for (p, by) in points.iter_mut().zip(&self.by) {
            let [x, y] = place.apply_vector(*by);
            *p = [p[0] + x, p[1] + y];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_holds_for_a_few_frames_and_until_all_networks_run() {
        let (from, to) = ([[1.0, 2.0]; LANDMARKS], [[1.5, 1.0]; LANDMARKS]);
        let mut correction = Correction::NONE;
        assert!(!correction.holds(Networks::Few));
        correction.keep(&from, &to, &Similarity::IDENTITY);
        for _ in 0..MOST_FRAMES {
            let mut points = from;
            assert!(correction.holds(Networks::Few));
            correction.add_to(&mut points, &Similarity::IDENTITY);
            assert_eq!(points, to);
        }
        assert!(!correction.holds(Networks::Few));
        correction.keep(&from, &to, &Similarity::IDENTITY);
        assert!(!correction.holds(Networks::All) && !correction.holds(Networks::Few));
    }
}
