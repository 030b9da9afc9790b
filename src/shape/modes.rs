//! Sums of quantised modes: what identity and animation weights add to a point of the face.

use glam::{Vec3, Vec4};

/// The factors of up to four times `FOURS` modes, a scale times a weight each, four by four and
/// three times each: of x, y and z.
pub(super) struct Factors<const FOURS: usize>([[Vec4; 3]; FOURS]);

impl<const FOURS: usize> Factors<FOURS> {
    pub(super) fn new(scales: &[f32], weights: &[f32]) -> Self {
        let mut factors = [[0.0; 12]; FOURS];
        let by_mode = factors.as_flattened_mut().as_chunks_mut::<3>().0.iter_mut();
        for (out, (scale, weight)) in by_mode.zip(scales.iter().zip(weights)) {
            *out = [scale * weight; 3];
        }
        Factors(factors.map(|factors| vectors(&factors)))
    }

    /// What the modes of a point add to it; x, y and z of each after those of the one before.
    #[inline(never)]
    pub(super) fn sum(&self, modes: &[i8]) -> Vec3 {
        let mut deltas = [[0.0f32; 12]; FOURS];
        for (out, delta) in deltas.as_flattened_mut().iter_mut().zip(modes) {
            *out = f32::from(*delta);
        }
        let mut sums = [Vec4::ZERO; 3];
        for (deltas, factors) in deltas.iter().zip(&self.0) {
            for (sum, (delta, factor)) in sums.iter_mut().zip(vectors(deltas).iter().zip(factors)) {
                *sum += *delta * *factor;
            }
        }
        // x, y, z, x | y, z, x, y | z, x, y, z
        let [a, b, c] = sums;
        Vec3::new(
            (a.x + a.w) + (b.z + c.y),
            (a.y + b.x) + (b.w + c.z),
            (a.z + b.y) + (c.x + c.w),
        )
    }
}

fn vectors(numbers: &[f32; 12]) -> [Vec4; 3] {
    let mut out = [Vec4::ZERO; 3];
    for (out, numbers) in out.iter_mut().zip(numbers.as_chunks::<4>().0) {
        *out = Vec4::from_array(*numbers);
    }
    out
}

/// A quantised displacement \[mm\].
#[inline]
pub(super) fn scaled(delta: &[i8; 3], scale: f32) -> Vec3 {
    Vec3::from_array(delta.map(|d| f32::from(d) * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_that_are_no_multiple_of_four_are_added() {
        let modes: [i8; 18] = core::array::from_fn(|k| 7 * k as i8 - 60);
        let scales = [0.5, 1.0, 2.0, 3.0, 0.1, 0.7];
        let weights = [1.0, -1.0, 0.25, 0.0, 3.0, 2.0];
        let factors = Factors::<2>::new(&scales, &weights);
        let each = modes.as_chunks().0.iter().zip(scales.iter().zip(weights));
        let expected: Vec3 = each.map(|(m, (s, w))| scaled(m, *s) * w).sum();
        assert!((factors.sum(&modes) - expected).length() < 1e-4);
        assert_eq!(factors.sum(&[]), Vec3::ZERO);
    }
}
