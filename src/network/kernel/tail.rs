//! Loops without vectors: the scalar kernel's, and what is left behind the vectors of others.

use super::operands::Sum;

/// Stages values as 16-bit differences from the zero point; vectorised by the compiler.
#[inline(always)]
pub(super) fn widen(values: &[u8], zero_point: u8, staged: &mut [u8]) {
    for (out, value) in staged.as_chunks_mut::<2>().0.iter_mut().zip(values) {
        *out = (*value as i16 - zero_point as i16).to_ne_bytes();
    }
}

/// [`Kernel::add`](super::Kernel::add).
#[inline(always)]
pub(super) fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
    let (pre_shift, post_shift, half) = sum.shifts();
    let [own, second] = sum.factors.map(i32::from);
    for (out, other) in out.iter_mut().zip(other) {
        let sum = i32::from(*out) * own + i32::from(*other) * second;
        let value = (sum >> pre_shift).wrapping_add(half) >> post_shift;
        *out = value.clamp(0, 255) as u8;
    }
}

/// [`Kernel::dot`](super::Kernel::dot).
#[inline(always)]
pub(super) fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let pairs = features.iter().zip(weights);
    // 16-bit factors, for which SIMD units have a multiply-add of pairs.
    pairs
        .map(|(f, w)| (*f as i16) as i32 * (*w as i16) as i32)
        .sum()
}
