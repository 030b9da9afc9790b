//! The kernels for x86-64: `pmaddwd` multiplies pairs of 16-bit numbers and adds the products.

use super::{BLOCK, NO_LATERAL, Scale, TILE, TapWeights, Taps, Tile};
use core::arch::x86_64::{
    __m128i, _mm_add_epi32, _mm_and_si128, _mm_cvtsi32_si128, _mm_cvtsi64_si128, _mm_cvtsi128_si32,
    _mm_cvtsi128_si64, _mm_madd_epi16, _mm_packs_epi32, _mm_packus_epi16, _mm_set_epi64x,
    _mm_set1_epi32, _mm_setr_epi16, _mm_setr_epi32, _mm_setzero_si128, _mm_shuffle_epi32,
    _mm_slli_epi32, _mm_sra_epi32, _mm_srai_epi16, _mm_unpackhi_epi8, _mm_unpackhi_epi16,
    _mm_unpacklo_epi8, _mm_unpacklo_epi16,
};

#[target_feature(enable = "sse2")]
#[inline]
pub(super) fn conv2d(tile: &Tile<'_>, weights: &[i16], scale: &Scale<'_>) -> [[u8; BLOCK]; TILE] {
    let mut sums = [[_mm_setzero_si128(); 2]; TILE];
    for (pairs, weights) in tile.pairs().zip(weights.as_chunks::<16>().0) {
        let weights = halves(weights);
        for (sums, [x0, x1]) in sums.iter_mut().zip(pairs) {
            let pair = _mm_set1_epi32((*x0 as u16 as u32 | (*x1 as u16 as u32) << 16) as i32);
            for (sum, weights) in sums.iter_mut().zip(weights) {
                *sum = _mm_add_epi32(*sum, _mm_madd_epi16(pair, weights));
            }
        }
    }
    let mut out = [[0; BLOCK]; TILE];
    for ((out, sums), lateral) in out.iter_mut().zip(sums).zip(tile.lateral) {
        *out = requantize(sums, scale, lateral);
    }
    out
}

#[target_feature(enable = "sse2")]
#[inline]
pub(super) fn depthwise3x3(
    taps: &Taps<'_>,
    weights: &TapWeights,
    scale: &Scale<'_>,
) -> [u8; BLOCK] {
    let mut sums = [_mm_setzero_si128(); 2];
    for ([first, second], weights) in taps.iter().zip(weights) {
        let (first, second) = (widened(first), widened(second));
        let pairs = [
            _mm_unpacklo_epi16(first, second),
            _mm_unpackhi_epi16(first, second),
        ];
        for ((sum, pair), weights) in sums.iter_mut().zip(pairs).zip(halves(weights)) {
            *sum = _mm_add_epi32(*sum, _mm_madd_epi16(pair, weights));
        }
    }
    requantize(sums, scale, &NO_LATERAL)
}

#[target_feature(enable = "sse2")]
#[inline]
pub(super) fn dot(features: &[[u8; 2 * BLOCK]], weights: &[[i8; 2 * BLOCK]]) -> i32 {
    let zero = _mm_setzero_si128();
    let [mut low, mut high] = [zero; 2];
    for (features, weights) in features.iter().zip(weights) {
        let features = sixteen(*features);
        let weights = sixteen(weights.map(|w| w as u8));
        // Sign extension: the byte is shifted down from the upper half of a word.
        let below = _mm_srai_epi16::<8>(_mm_unpacklo_epi8(zero, weights));
        let above = _mm_srai_epi16::<8>(_mm_unpackhi_epi8(zero, weights));
        let first = _mm_unpacklo_epi8(features, zero);
        let second = _mm_unpackhi_epi8(features, zero);
        low = _mm_add_epi32(low, _mm_madd_epi16(first, below));
        high = _mm_add_epi32(high, _mm_madd_epi16(second, above));
    }
    let sums = _mm_add_epi32(low, high);
    let sums = _mm_add_epi32(sums, _mm_shuffle_epi32::<0b1110>(sums));
    _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_shuffle_epi32::<0b01>(sums)))
}

#[target_feature(enable = "sse2")]
#[inline]
fn sixteen(v: [u8; 2 * BLOCK]) -> __m128i {
    let [low, high] = [v.first_chunk(), v.last_chunk()]
        .map(|half: Option<&[u8; BLOCK]>| i64::from_le_bytes(*half.unwrap_or(&[0; BLOCK])));
    _mm_set_epi64x(high, low)
}

/// Sixteen 16-bit numbers in two registers.
#[target_feature(enable = "sse2")]
#[inline]
fn halves(v: &[i16; 16]) -> [__m128i; 2] {
    let [a, b, c, d, e, f, g, h, rest @ ..] = *v;
    let [i, j, k, l, m, n, o, p] = rest;
    [
        _mm_setr_epi16(a, b, c, d, e, f, g, h),
        _mm_setr_epi16(i, j, k, l, m, n, o, p),
    ]
}

/// Eight 32-bit numbers in two registers.
#[target_feature(enable = "sse2")]
#[inline]
fn quarters(v: &[i32; BLOCK]) -> [__m128i; 2] {
    let [a, b, c, d, e, f, g, h] = *v;
    [_mm_setr_epi32(a, b, c, d), _mm_setr_epi32(e, f, g, h)]
}

/// Bytes as 16-bit numbers.
#[target_feature(enable = "sse2")]
#[inline]
fn widened(v: &[u8; BLOCK]) -> __m128i {
    let v = _mm_cvtsi64_si128(i64::from_le_bytes(*v));
    _mm_unpacklo_epi8(v, _mm_setzero_si128())
}

#[target_feature(enable = "sse2")]
#[inline]
fn requantize(sums: [__m128i; 2], scale: &Scale<'_>, lateral: &[u8; BLOCK]) -> [u8; BLOCK] {
    let (pre_shift, post_shift) = (scale.pre_shift & 31, scale.post_shift & 31);
    let half = _mm_set1_epi32(1 << (post_shift.wrapping_sub(1) & 31));
    let [pre_shift, post_shift] =
        [pre_shift, post_shift].map(|shift| _mm_cvtsi32_si128(shift as i32));
    // 2·(lateral − 128) = 2·lateral − 256.
    let zero_point = _mm_set1_epi32(scale.zero_point - 256);
    let lateral = widened(lateral);
    let lateral = [
        _mm_unpacklo_epi16(lateral, _mm_setzero_si128()),
        _mm_unpackhi_epi16(lateral, _mm_setzero_si128()),
    ];
    let low = _mm_set1_epi32(0xffff);
    let (bias, multiplier) = (quarters(scale.bias), quarters(scale.multiplier));
    let mut out = [_mm_setzero_si128(); 2];
    let constants = bias.into_iter().zip(multiplier).zip(lateral);
    for ((out, sum), ((bias, multiplier), lateral)) in out.iter_mut().zip(sums).zip(constants) {
        let kept = _mm_sra_epi32(_mm_add_epi32(sum, bias), pre_shift);
        // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
        let scaled = _mm_madd_epi16(kept, _mm_and_si128(multiplier, low));
        let scaled = _mm_sra_epi32(_mm_add_epi32(scaled, half), post_shift);
        let lateral = _mm_add_epi32(zero_point, _mm_slli_epi32::<1>(lateral));
        *out = _mm_add_epi32(scaled, lateral);
    }
    let words = _mm_packs_epi32(out[0], out[1]);
    _mm_cvtsi128_si64(_mm_packus_epi16(words, words)).to_le_bytes()
}
