//! By `smlal`, which adds products of 16-bit numbers to 32-bit sums.

use super::{BLOCK, NO_COARSE, Scale, TILE, TapWeights, Taps, Tile};
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
    for ((out, sums), coarse) in out.iter_mut().zip(sums).zip(tile.coarse) {
        *out = requantize(sums, scale, coarse);
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
    requantize([low, high], scale, &NO_COARSE)
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

/// Those at even places, and those at odd ones.
#[target_feature(enable = "neon")]
#[inline]
fn halves(v: &[i16; 16]) -> int16x8x2_t {
    // SAFETY: sixteen numbers are read from where sixteen lie.
    unsafe { vld2q_s16(v.as_ptr()) }
}

/// Two registers of four.
#[target_feature(enable = "neon")]
#[inline]
fn quarters(v: &[i32; BLOCK]) -> [int32x4_t; 2] {
    let [a, b, c, d, e, f, g, h] = *v;
    // SAFETY: four numbers are read from where four lie.
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
fn requantize(sums: [int32x4_t; 2], scale: &Scale<'_>, coarse: &[u8; BLOCK]) -> [u8; BLOCK] {
    let (before, after) = (scale.before & 31, scale.after & 31);
    let half = vdupq_n_s32(1 << (after.wrapping_sub(1) & 31));
    // To the left by less than nothing is to the right.
    let [before, after] = [before, after].map(|shift| vdupq_n_s32(-(shift as i32)));
    // Twice the coarse map, 256 below.
    let floor = vdupq_n_s32(scale.floor - 256);
    let coarse = vshlq_n_s16::<1>(widened(coarse));
    let coarse = [vget_low_s16(coarse), vget_high_s16(coarse)];
    let (bias, factor) = (quarters(scale.bias), quarters(scale.factor));
    let mut out = [vdupq_n_s32(0); 2];
    let constants = bias.into_iter().zip(factor).zip(coarse);
    for ((out, sum), ((bias, factor), coarse)) in out.iter_mut().zip(sums).zip(constants) {
        let kept = vmovn_s32(vshlq_s32(vaddq_s32(sum, bias), before));
        let scaled = vaddq_s32(vmull_s16(kept, vmovn_s32(factor)), half);
        *out = vaddw_s16(vaddq_s32(vshlq_s32(scaled, after), floor), coarse);
    }
    let words = vcombine_s16(vqmovn_s32(out[0]), vqmovn_s32(out[1]));
    vget_lane_u64::<0>(vreinterpret_u64_u8(vqmovun_s16(words))).to_le_bytes()
}
