//! Where the face will be on the next frame: constant velocity of its centroid.

use crate::align::Shape;
use crate::shape::LANDMARKS;
use crate::track::geometry::{centroid, face_width, length};
use crate::track::policy::{
    CROP_FOLLOWS_AT, CROP_FOLLOWS_LEAST, EXPOSURE_US, MAX_PREDICTION, MAX_PREDICTION_US, MIN_MOTION,
};

/// Velocity of a face's centroid \[px/µs\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    velocity: [f32; 2],
}

impl Motion {
    pub const STILL: Motion = Motion { velocity: [0.0; 2] };

    /// Velocity between two fits `elapsed_us` apart.
    pub fn between(before: &Shape, after: &Shape, elapsed_us: i64) -> Motion {
        if !(1..=MAX_PREDICTION_US).contains(&elapsed_us) {
            return Motion::STILL;
        }
        let (a, b) = (centroid(before), centroid(after));
        let shift = [b[0] - a[0], b[1] - a[1]];
        if length(shift) < MIN_MOTION * face_width(after) {
            return Motion::STILL;
        }
        Motion {
            velocity: shift.map(|v| v / elapsed_us as f32),
        }
    }

    /// How far the face moves while a frame is exposed, at most \[px\].
    pub fn blur_px(&self) -> f32 {
        length(self.velocity) * EXPOSURE_US
    }

    /// The shape after `elapsed_us`.
    pub fn predict(&self, shape: &Shape, elapsed_us: i64) -> Shape {
        if !(1..=MAX_PREDICTION_US).contains(&elapsed_us) {
            return *shape;
        }
        let shift = self.velocity.map(|v| v * elapsed_us as f32);
        let farthest = MAX_PREDICTION * face_width(shape);
        let factor = (farthest / length(shift).max(1e-6)).min(1.0);
        shape.map(|[x, y]| [x + shift[0] * factor, y + shift[1] * factor])
    }
}

/// The initial shape of the next alignment, between that of the last one and the prediction. The
/// crop follows small distances slowly: they are mostly noise of the last fit, and a crop that
/// followed them would add noise to the next fit.
pub fn damped(last: &Shape, predicted: &Shape) -> Shape {
    let pairs = last.iter().zip(predicted);
    let sum: f32 = pairs.map(|(a, b)| length([b[0] - a[0], b[1] - a[1]])).sum();
    let distance = sum / LANDMARKS as f32 / face_width(predicted).max(1e-6);
    let share = (distance / CROP_FOLLOWS_AT).clamp(CROP_FOLLOWS_LEAST, 1.0);
    core::array::from_fn(|i| {
        let (a, b) = (
            last.get(i).copied().unwrap_or_default(),
            predicted.get(i).copied().unwrap_or_default(),
        );
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    })
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_on_as_before_and_ignores_gaps() {
        let shape: Shape = core::array::from_fn(|i| [(i % 9) as f32 * 10.0, (i / 9) as f32 * 10.0]);
        let moved = shape.map(|[x, y]| [x + 8.0, y - 4.0]);
        let motion = Motion::between(&shape, &moved, 33_000);
        let next = motion.predict(&moved, 33_000);
        assert!((next[0][0] - moved[0][0] - 8.0).abs() < 1e-3);
        assert!((next[0][1] - moved[0][1] + 4.0).abs() < 1e-3);
        assert_eq!(motion.predict(&moved, 1_000_000), moved);
        assert!((motion.blur_px() - 80.0f32.sqrt()).abs() < 0.1);
        assert_eq!(Motion::between(&shape, &moved, 0), Motion::STILL);
        assert_eq!(
            Motion::between(&shape, &shape.map(|[x, y]| [x + 0.1, y]), 33_000),
            Motion::STILL
        );
    }
}
