//! The kernels in portable Rust.

use super::{BLOCK, Scale, TILE, TapWeights, Taps, Tile};

pub(super) fn conv2d(tile: &Tile<'_>, weights: &[i16], scale: &Scale<'_>) -> [[u8; BLOCK]; TILE] {
    let mut out = [[0; BLOCK]; TILE];
    for ((out, columns), lateral) in out.iter_mut().zip(tile.columns).zip(tile.lateral) {
        *out = requantize(products(columns, weights), scale, lateral);
    }
    out
}

pub(super) fn depthwise3x3(
    taps: &Taps<'_>,
    weights: &TapWeights,
    scale: &Scale<'_>,
) -> [u8; BLOCK] {
    let mut sums = [0i32; BLOCK];
    for ([first, second], weights) in taps.iter().zip(weights) {
        let values = first.iter().zip(*second);
        let weights = weights.as_chunks::<2>().0;
        for ((sum, (a, b)), [w0, w1]) in sums.iter_mut().zip(values).zip(weights) {
            *sum += *a as i32 * *w0 as i32 + *b as i32 * *w1 as i32;
        }
    }
    requantize(sums, scale, &super::NO_LATERAL)
}

pub(super) fn dot(features: &[[u8; 2 * BLOCK]], weights: &[[i8; 2 * BLOCK]]) -> i32 {
    let pairs = features.as_flattened().iter().zip(weights.as_flattened());
    // 16-bit factors, for which SIMD units have a multiply-add of pairs.
    pairs
        .map(|(f, w)| (*f as i16) as i32 * (*w as i16) as i32)
        .sum()
}

fn products(columns: &[i16], weights: &[i16]) -> [i32; BLOCK] {
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

fn requantize(sums: [i32; BLOCK], scale: &Scale<'_>, lateral: &[u8; BLOCK]) -> [u8; BLOCK] {
    let (pre_shift, post_shift) = (scale.pre_shift & 31, scale.post_shift & 31);
    let half = 1i32 << (post_shift.wrapping_sub(1) & 31);
    let mut out = [0; BLOCK];
    let constants = scale.bias.iter().zip(scale.multiplier);
    for (((out, sum), (bias, multiplier)), lateral) in
        out.iter_mut().zip(sums).zip(constants).zip(lateral)
    {
        let kept = (sum.wrapping_add(*bias) >> pre_shift) as i16 as i32;
        let scaled = (kept * *multiplier as i16 as i32).wrapping_add(half) >> post_shift;
        let value = scaled + scale.zero_point + 2 * (*lateral as i32 - 128);
        *out = value.clamp(0, 255) as u8;
    }
    out
}
