//! The kernel for AArch64: `smull` and `smlal` multiply bytes and add two products in 16 bits, as
//! no weight is −128; `sadalp` adds pairs of these to 32-bit sums.

use super::aarch64::{
    Requantization, SIGN, add, depthwise3x3, halves, signed_bytes, smlal2_bytes, smull2_bytes,
};
use super::{BLOCK, Kernel, Strip, Tile};
use super::{forwarded, tail, unrolled};
use core::arch::aarch64::*;

#[derive(Clone, Copy)]
pub(in crate::network) struct Neon;

impl Kernel for Neon {
    signed_bytes!();

    forwarded!();
}

/// Tiles of pixels × blocks whose sums fill sixteen of the 32 registers: 4×2, for one block that is
/// left 8×1.
#[target_feature(enable = "neon")]
fn conv2d(mut strip: Strip<'_>) {
    let mut block = 0;
    while let left @ 1.. = strip.blocks().saturating_sub(block) {
        block += match left {
            1 => tiles::<8, 1>(&mut strip, block),
            _ => tiles::<4, 2>(&mut strip, block),
        };
    }
}

/// All pixels of `B` blocks from `block` on, `P` pixels at a time. Returns `B`.
#[target_feature(enable = "neon")]
#[inline]
fn tiles<const P: usize, const B: usize>(strip: &mut Strip<'_>, block: usize) -> usize {
    let (pixels, channels) = (strip.pixels(), strip.channels());
    let scale = *strip.scale();
    let requantization = Requantization::new(&scale);
    let mut requantizations = [requantization; B];
    unrolled!(b < B => {
        requantizations[b] = requantization.of_block(&scale, block + b);
    });
    let mut out = strip.out().as_mut_ptr().wrapping_add(block * BLOCK);
    let mut first = 0;
    while first < pixels {
        let tile = strip.tile(first, P);
        // SAFETY: `conv2d` takes only blocks that the strip has, which has the outputs of all its
        // blocks at all pixels.
        unsafe {
            let sums = sums::<P, B>(strip, tile, block);
            let whole = scale.is_plain() && tile.present == P;
            unrolled!(p < P => {
                if whole || p < tile.present {
                    unrolled!(b < B => {
                        let out = out.wrapping_add(b * BLOCK);
                        match whole {
                            true => requantizations[b].store::<true>(sums[p][b], out),
                            false => requantizations[b].store::<false>(sums[p][b], out),
                        }
                    });
                    out = out.wrapping_add(channels);
                }
            });
        }
        first += tile.present;
    }
    B
}

/// The sums of the `P` pixels of a tile in `B` blocks from `block` on.
///
/// # Safety
/// The strip has these blocks.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn sums<const P: usize, const B: usize>(
    strip: &Strip<'_>,
    tile: Tile,
    block: usize,
) -> [[[int32x4_t; 2]; B]; P] {
    let mut biases = [[vdupq_n_s32(0); 2]; B];
    unrolled!(b < B => { biases[b] = halves(strip.scale().bias, block + b) });
    let mut sums = [biases; P];
    let block_weights = strip.block_weights();
    let mut weights = strip.weights().as_ptr().wrapping_add(block * block_weights);
    for row in strip.rows() {
        let mut window = tile.window.wrapping_add(*row);
        for _ in 0..strip.columns() / 8 {
            let mut values = [vdup_n_s16(0); P];
            // SAFETY: a window has a byte for each column, and a block eight weights for each.
            unsafe {
                unrolled!(p < P => {
                    values[p] = vld1_s16(window.add(p * tile.step).cast());
                });
                multiply::<0, 1, P, B>(&mut sums, &values, weights, block_weights);
                multiply::<2, 3, P, B>(&mut sums, &values, weights.add(32), block_weights);
            }
            weights = weights.wrapping_add(8 * BLOCK);
            window = window.wrapping_add(8);
        }
    }
    sums
}

/// Multiplies two pairs of the values of each pixel by the weights of `B` blocks.
///
/// # Safety
/// `weights` is valid for 32 bytes of each block, which are `block_weights` apart.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn multiply<const FIRST: i32, const SECOND: i32, const P: usize, const B: usize>(
    sums: &mut [[[int32x4_t; 2]; B]; P],
    values: &[int16x4_t; P],
    weights: *const i8,
    block_weights: usize,
) {
    let mut pairs = [[vdupq_n_s8(0); 2]; B];
    unrolled!(b < B => {
        // SAFETY: as the caller promises.
        pairs[b] = unsafe {
            let weights = weights.add(b * block_weights);
            [vld1q_s8(weights), vld1q_s8(weights.add(16))]
        };
    });
    unrolled!(p < P => {
        // A pair of values beside the weights of each channel.
        let first = vreinterpretq_s8_s16(vdupq_lane_s16::<FIRST>(values[p]));
        let second = vreinterpretq_s8_s16(vdupq_lane_s16::<SECOND>(values[p]));
        unrolled!(b < B => {
            let low = vmull_s8(vget_low_s8(pairs[b][0]), vget_low_s8(first));
            let low = vmlal_s8(low, vget_low_s8(pairs[b][1]), vget_low_s8(second));
            let high = smull2_bytes(pairs[b][0], first);
            let high = smlal2_bytes(high, pairs[b][1], second);
            let [low_sums, high_sums] = sums[p][b];
            sums[p][b] = [vpadalq_s16(low_sums, low), vpadalq_s16(high_sums, high)];
        });
    });
}

#[target_feature(enable = "neon")]
fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<32>();
    let (rows, rest_of_row) = weights.as_chunks::<32>();
    let mut sums = [vdupq_n_s32(0); 2];
    for (features, weights) in vectors.iter().zip(rows) {
        unrolled!(half < 2 => {
            // SAFETY: both are twice sixteen bytes.
            let (features, weights) = unsafe {
                let at = 16 * half;
                (vld1q_u8(features.as_ptr().add(at)), vld1q_s8(weights.as_ptr().add(at)))
            };
            let features = [vmovl_u8(vget_low_u8(features)), vmovl_high_u8(features)];
            let weights = [vmovl_s8(vget_low_s8(weights)), vmovl_high_s8(weights)];
            unrolled!(k < 2 => {
                let features = vreinterpretq_s16_u16(features[k]);
                sums[k] = vmlal_s16(sums[k], vget_low_s16(features), vget_low_s16(weights[k]));
                sums[k] = vmlal_high_s16(sums[k], features, weights[k]);
            });
        });
    }
    vaddvq_s32(vaddq_s32(sums[0], sums[1])).wrapping_add(tail::dot(rest, rest_of_row))
}
