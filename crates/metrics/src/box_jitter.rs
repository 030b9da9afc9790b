//! Boxes around true faces, as far off as a detector's: where training and evaluation start.

use serde::Serialize;

/// A square face box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceBox {
    /// Centre \[px\].
    pub centre: [f32; 2],
    /// Side \[px\].
    pub size: f32,
    /// Roll \[rad\].
    pub roll: f32,
}

/// Standard deviations of a box from the true one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoxJitter {
    /// Of the centre along each axis, in box sides.
    pub shift: f32,
    /// Of the natural logarithm of the side.
    pub log_size: f32,
    /// Of the roll \[rad\].
    pub roll: f32,
}

impl BoxJitter {
    /// As wide as the errors of the shipped detector: 5 % of the side, 8 % in size, 8 degrees.
    pub const DETECTOR: BoxJitter = BoxJitter {
        shift: 0.05,
        log_size: 0.08,
        roll: 0.14,
    };

    /// All three times `factor`.
    pub fn times(self, factor: f32) -> BoxJitter {
        BoxJitter {
            shift: self.shift * factor,
            log_size: self.log_size * factor,
            roll: self.roll * factor,
        }
    }

    /// The box moved by standard normal numbers: two for the centre, one for size, one for roll.
    pub fn apply(&self, truth: &FaceBox, mut normal: impl FnMut() -> f32) -> FaceBox {
        let centre = truth.centre.map(|c| c + self.shift * truth.size * normal());
        let size = truth.size * (self.log_size * normal()).exp();
        FaceBox {
            centre,
            size,
            roll: truth.roll + self.roll * normal(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_are_taken_in_order() {
        let truth = FaceBox {
            centre: [10.0, 20.0],
            size: 100.0,
            roll: 0.0,
        };
        let mut numbers = [1.0, -1.0, 0.0, 2.0].into_iter();
        let moved = BoxJitter::DETECTOR.apply(&truth, || numbers.next().expect("four numbers"));
        assert_eq!(moved.centre, [15.0, 15.0]);
        assert_eq!((moved.size, moved.roll), (100.0, 0.28));
        assert_eq!(BoxJitter::DETECTOR.times(0.0).apply(&truth, || 1.0), truth);
    }
}
