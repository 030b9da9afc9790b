//! The inner products that nearly all time goes into. The SSE2 twin gives the same integers as the
//! portable code, which compilers turn into good code for other machines.

// SIMD kernels are one of the places where `unsafe` is allowed.
#![allow(unsafe_code)]

/// Outputs computed together.
pub(super) const BLOCK: usize = 8;

/// Eight inner products at once: `Σₖ columns[k]·weights[k/2][output][k%2]`. `columns` has an even
/// length; `weights` holds [`BLOCK`] outputs for each pair of columns.
#[cfg(not(target_arch = "x86_64"))]
#[inline]
pub(super) fn products(columns: &[i16], weights: &[i16]) -> [i32; BLOCK] {
    portable(columns, weights)
}

/// As the portable version.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(super) fn products(columns: &[i16], weights: &[i16]) -> [i32; BLOCK] {
    // SAFETY: SSE2 is part of x86-64.
    unsafe { sse2(columns, weights) }
}

/// By `pmaddwd`.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "sse2")]
#[inline]
fn sse2(columns: &[i16], weights: &[i16]) -> [i32; BLOCK] {
    use core::arch::x86_64::{
        __m128i, _mm_add_epi32, _mm_cvtsi128_si32, _mm_madd_epi16, _mm_set1_epi32, _mm_setr_epi16,
        _mm_setzero_si128, _mm_shuffle_epi32,
    };
    let load = |w: &[i16; 8]| _mm_setr_epi16(w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7]);
    let (mut low, mut high) = (_mm_setzero_si128(), _mm_setzero_si128());
    let pairs = columns.as_chunks::<2>().0;
    for ([x0, x1], w) in pairs.iter().zip(weights.as_chunks::<16>().0) {
        let pair = _mm_set1_epi32((*x0 as u16 as u32 | (*x1 as u16 as u32) << 16) as i32);
        let [first, second, ..] = w.as_chunks::<8>().0 else {
            continue;
        };
        low = _mm_add_epi32(low, _mm_madd_epi16(pair, load(first)));
        high = _mm_add_epi32(high, _mm_madd_epi16(pair, load(second)));
    }
    let split = |v: __m128i| {
        [
            _mm_cvtsi128_si32(v),
            _mm_cvtsi128_si32(_mm_shuffle_epi32::<1>(v)),
            _mm_cvtsi128_si32(_mm_shuffle_epi32::<2>(v)),
            _mm_cvtsi128_si32(_mm_shuffle_epi32::<3>(v)),
        ]
    };
    let ([a, b, c, d], [e, f, g, h]) = (split(low), split(high));
    [a, b, c, d, e, f, g, h]
}

/// What [`products`] computes.
#[cfg(any(test, not(target_arch = "x86_64")))]
fn portable(columns: &[i16], weights: &[i16]) -> [i32; BLOCK] {
    let mut sums = [0i32; BLOCK];
    let pairs = columns.as_chunks::<2>().0;
    for ([x0, x1], w) in pairs.iter().zip(weights.as_chunks::<16>().0) {
        for (sum, [w0, w1]) in sums.iter_mut().zip(w.as_chunks::<2>().0) {
            *sum = sum
                .wrapping_add(*x0 as i32 * *w0 as i32)
                .wrapping_add(*x1 as i32 * *w1 as i32);
        }
    }
    sums
}

/// `Σ a·b` of features and weights.
#[inline]
pub(crate) fn dot(features: &[u8], weights: &[i8]) -> i32 {
    // 16-bit factors: what machines multiply in pairs.
    let products = features
        .iter()
        .zip(weights)
        .map(|(f, w)| (*f as i16) as i32 * (*w as i16) as i32);
    products.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twins_agree() {
        let noise = |k: usize| ((k * 7919 + 13) % 511) as i16 - 255;
        let columns: [i16; 26] = core::array::from_fn(noise);
        let weights: [i16; 26 * 8] = core::array::from_fn(|k| noise(k + 7) / 2);
        let sums = products(&columns, &weights);
        assert_eq!(sums, portable(&columns, &weights));
        let first: i32 = (0..26)
            .map(|k| columns[k] as i32 * weights[k / 2 * 16 + k % 2] as i32)
            .sum();
        assert_eq!(sums[0], first);
    }
}
