//! The kernels for AArch64: `smlal` adds products of 16-bit numbers to 32-bit sums.

use super::{BLOCK, NO_LATERAL, Scale, TILE, TapWeights, Taps, Tile};
use core::arch::aarch64::{
    int16x8_t, int16x8x2_t, int32x4_t, vaddq_s32, vaddvq_s32, vaddw_s16, vcombine_s16, vcreate_s8,
    vcreate_u8, vdupq_n_s32, vget_high_s16, vget_lane_u64, vget_low_s16, vld1q_s32, vld2q_s16,
    vmlal_high_n_s16, vmlal_high_s16, vmlal_n_s16, vmlal_s16, vmovl_s8, vmovl_u8, vmovn_s32,
    vmull_s16, vqmovn_s32, vqmovun_s16, vreinterpret_u64_u8, vreinterpretq_s16_u16, vshlq_n_s16,
    vshlq_s32,
};

#[target_feature(enable = "neon")]
#[inline]
pub(super) fn conv2d(tile: &Tile<'_>, weights: &[i16], scale: &Scale<'_>) -> [[u8; BLOCK]; TILE] {
    let mut sums = [[vdupq_n_s32(0); 2]; TILE];
    for (pairs, weights) in tile.pairs().zip(weights.as_chunks::<16>().0) {
        let int16x8x2_t(first, second) = halves(weights);
        for ([low, high], [x0, x1]) in sums.iter_mut().zip(pairs) {
            *low = vmlal_n_s16(*low, vget_low_s16(first), *x0);
            *high = vmlal_high_n_s16(*high, first, *x0);
            *low = vmlal_n_s16(*low, vget_low_s16(second), *x1);
            *high = vmlal_high_n_s16(*high, second, *x1);
        }
    }
    let mut out = [[0; BLOCK]; TILE];
    for ((out, sums), lateral) in out.iter_mut().zip(sums).zip(tile.lateral) {
        *out = requantize(sums, scale, lateral);
    }
    out
}

#[target_feature(enable = "neon")]
#[inline]
pub(super) fn depthwise3x3(
    taps: &Taps<'_>,
    weights: &TapWeights,
    scale: &Scale<'_>,
) -> [u8; BLOCK] {
    let [mut low, mut high] = [vdupq_n_s32(0); 2];
    for (taps, weights) in taps.iter().zip(weights) {
        let int16x8x2_t(first, second) = halves(weights);
        for (tap, weights) in taps.iter().zip([first, second]) {
            let tap = widened(tap);
            low = vmlal_s16(low, vget_low_s16(tap), vget_low_s16(weights));
            high = vmlal_high_s16(high, tap, weights);
        }
    }
    requantize([low, high], scale, &NO_LATERAL)
}

#[target_feature(enable = "neon")]
#[inline]
pub(super) fn dot(features: &[[u8; 2 * BLOCK]], weights: &[[i8; 2 * BLOCK]]) -> i32 {
    let mut sums = [vdupq_n_s32(0); 2];
    for (features, weights) in features.iter().zip(weights) {
        let (features, weights) = (features.as_chunks().0, weights.as_chunks().0);
        for ((sum, features), weights) in sums.iter_mut().zip(features).zip(weights) {
            let (features, weights) = (widened(features), signed(weights));
            *sum = vmlal_s16(*sum, vget_low_s16(features), vget_low_s16(weights));
            *sum = vmlal_high_s16(*sum, features, weights);
        }
    }
    vaddvq_s32(vaddq_s32(sums[0], sums[1]))
}

/// Signed bytes as 16-bit numbers.
#[target_feature(enable = "neon")]
#[inline]
fn signed(v: &[i8; BLOCK]) -> int16x8_t {
    let bytes = v.map(|v| v as u8);
    vmovl_s8(vcreate_s8(u64::from_le_bytes(bytes)))
}

/// Deinterleaves: the numbers at even places, then those at odd places.
#[target_feature(enable = "neon")]
#[inline]
fn halves(v: &[i16; 16]) -> int16x8x2_t {
    // SAFETY: reads the sixteen numbers of the array.
    unsafe { vld2q_s16(v.as_ptr()) }
}

/// Eight 32-bit numbers in two registers.
#[target_feature(enable = "neon")]
#[inline]
fn quarters(v: &[i32; BLOCK]) -> [int32x4_t; 2] {
    let [a, b, c, d, e, f, g, h] = *v;
    // SAFETY: reads the four numbers of the array.
    [[a, b, c, d], [e, f, g, h]].map(|v| unsafe { vld1q_s32(v.as_ptr()) })
}

/// Bytes as 16-bit numbers.
#[target_feature(enable = "neon")]
#[inline]
fn widened(v: &[u8; BLOCK]) -> int16x8_t {
    vreinterpretq_s16_u16(vmovl_u8(vcreate_u8(u64::from_le_bytes(*v))))
}

#[target_feature(enable = "neon")]
#[inline]
fn requantize(sums: [int32x4_t; 2], scale: &Scale<'_>, lateral: &[u8; BLOCK]) -> [u8; BLOCK] {
    let (pre_shift, post_shift) = (scale.pre_shift & 31, scale.post_shift & 31);
    let half = vdupq_n_s32(1 << (post_shift.wrapping_sub(1) & 31));
    // A left shift by a negative number is a right shift.
    let [pre_shift, post_shift] = [pre_shift, post_shift].map(|shift| vdupq_n_s32(-(shift as i32)));
    // 2·(lateral − 128) = 2·lateral − 256.
    let zero_point = vdupq_n_s32(scale.zero_point - 256);
    let lateral = vshlq_n_s16::<1>(widened(lateral));
    let lateral = [vget_low_s16(lateral), vget_high_s16(lateral)];
    let (bias, multiplier) = (quarters(scale.bias), quarters(scale.multiplier));
    let mut out = [vdupq_n_s32(0); 2];
    let constants = bias.into_iter().zip(multiplier).zip(lateral);
    for ((out, sum), ((bias, multiplier), lateral)) in out.iter_mut().zip(sums).zip(constants) {
        let kept = vmovn_s32(vshlq_s32(vaddq_s32(sum, bias), pre_shift));
        let scaled = vaddq_s32(vmull_s16(kept, vmovn_s32(multiplier)), half);
        *out = vaddw_s16(
            vaddq_s32(vshlq_s32(scaled, post_shift), zero_point),
            lateral,
        );
    }
    let words = vcombine_s16(vqmovn_s32(out[0]), vqmovn_s32(out[1]));
    vget_lane_u64::<0>(vreinterpret_u64_u8(vqmovun_s16(words))).to_le_bytes()
}
