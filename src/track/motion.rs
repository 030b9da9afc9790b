//! Where the face will be on the next frame: constant velocity.

use crate::align::Shape;
use crate::shape::LANDMARKS;

/// Gaps longer than this say nothing about the next frame \[µs\].
const LONGEST_US: i64 = 200_000;
/// Farthest prediction, in widths of the face.
const FARTHEST: f32 = 0.3;
/// Motion below this share of the face's width per frame is noise.
const STILL: f32 = 0.02;

/// The longest that a frame is exposed, as far as blur goes \[µs\]: 1/30 s.
const EXPOSURE_US: f32 = 33_333.0;

/// Velocity of a face's middle \[px/µs\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    velocity: [f32; 2],
}

impl Motion {
    pub const STILL: Motion = Motion { velocity: [0.0; 2] };

    /// Velocity between two fits `elapsed_us` apart.
    pub fn between(before: &Shape, after: &Shape, elapsed_us: i64) -> Motion {
        if !(1..=LONGEST_US).contains(&elapsed_us) {
            return Motion::STILL;
        }
        let (a, b) = (middle(before), middle(after));
        let shift = [b[0] - a[0], b[1] - a[1]];
        if length(shift) < STILL * width(after) {
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

    /// A shape moved on.
    pub fn predict(&self, shape: &Shape, elapsed_us: i64) -> Shape {
        if !(1..=LONGEST_US).contains(&elapsed_us) {
            return *shape;
        }
        let shift = self.velocity.map(|v| v * elapsed_us as f32);
        let farthest = FARTHEST * width(shape);
        let factor = (farthest / length(shift).max(1e-6)).min(1.0);
        shape.map(|[x, y]| [x + shift[0] * factor, y + shift[1] * factor])
    }
}

/// Where to look for a face that was looked for at `last` and is expected at `predicted`: little
/// differences are mostly the last answer's noise, which would come back as more noise if the crop
/// followed it.
pub(super) fn steadied(last: &Shape, predicted: &Shape) -> Shape {
    let pairs = last.iter().zip(predicted);
    let sum: f32 = pairs.map(|(a, b)| length([b[0] - a[0], b[1] - a[1]])).sum();
    let apart = sum / LANDMARKS as f32 / width(predicted).max(1e-6);
    let share = (apart / FOLLOWED).clamp(LEAST_SHARE, 1.0);
    core::array::from_fn(|i| {
        let (a, b) = (
            last.get(i).copied().unwrap_or_default(),
            predicted.get(i).copied().unwrap_or_default(),
        );
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    })
}

/// Distance, in widths of the face, from which on the crop follows at once.
const FOLLOWED: f32 = 0.08;
/// Share of a small distance by which it follows.
const LEAST_SHARE: f32 = 0.1;

pub(super) fn length([x, y]: [f32; 2]) -> f32 {
    libm::sqrtf(x * x + y * y)
}

fn middle(shape: &Shape) -> [f32; 2] {
    let n = LANDMARKS as f32;
    shape
        .iter()
        .fold([0.0, 0.0], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n])
}

/// Twice the mean distance from the middle: the same at every roll.
fn width(shape: &Shape) -> f32 {
    let [cx, cy] = middle(shape);
    let sum: f32 = shape.iter().map(|[x, y]| length([x - cx, y - cy])).sum();
    2.0 * sum / LANDMARKS as f32
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
