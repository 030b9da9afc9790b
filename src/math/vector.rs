//! Sums of vectors: four at a time, so that they take SIMD, in one order on all machines.

use glam::Vec4;

/// Σ a·b, the end of the longer one left out.
#[inline(never)]
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    let both = a.len().min(b.len());
    let [(a, rest_a), (b, rest_b)] = [a, b].map(|v| v.get(..both).unwrap_or(&[]).as_chunks::<4>());
    let mut sums = Vec4::ZERO;
    for (a, b) in a.iter().zip(b) {
        sums += Vec4::from_array(*a) * Vec4::from_array(*b);
    }
    let rest = rest_a.iter().zip(rest_b);
    rest.fold(total(sums), |sum, (a, b)| sum + a * b)
}

/// Σ a.
pub fn sum(a: &[f32]) -> f32 {
    let (a, rest) = a.as_chunks::<4>();
    let sums = a
        .iter()
        .fold(Vec4::ZERO, |sums, a| sums + Vec4::from_array(*a));
    rest.iter().fold(total(sums), |sum, a| sum + a)
}

/// The order of glam's own sum differs between machines.
fn total(sums: Vec4) -> f32 {
    let [x, y, z, w] = sums.to_array();
    (x + z) + (y + w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_are_no_multiple_of_four_are_summed() {
        let numbers: [f32; 11] = core::array::from_fn(|k| k as f32);
        assert_eq!(sum(&numbers), 55.0);
        assert_eq!(sum(&[]), 0.0);
        assert_eq!(dot(&numbers, &numbers), 385.0);
        assert_eq!(dot(&numbers[..8], &numbers[..6]), 55.0);
    }
}
