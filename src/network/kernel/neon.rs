//! The kernel for AArch64: `smull` and `smlal` multiply bytes and add two products in 16 bits, as
//! no weight is −128; `sadalp` adds pairs of these to 32-bit sums.

use super::aarch64::{Requantization, SIGN, add, depthwise3x3, halves, signed_bytes};
use super::{BLOCK, Kernel, Strip, Tile};
use super::{forwarded, tail, unrolled};
use core::arch::aarch64::*;
use core::arch::asm;

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
        let mut values = [tile.window; P];
        unrolled!(p < P => { values[p] = tile.window.wrapping_add(*row + p * tile.step) });
        for _ in 0..strip.columns() / 8 {
            // SAFETY: a window has a byte for each column, and a block eight weights for each.
            unsafe { multiply(&mut sums, &mut values, weights, block_weights) };
            weights = weights.wrapping_add(8 * BLOCK);
        }
    }
    sums
}

/// Multiplies the next eight values of each pixel by the weights of `B` blocks, and moves on.
///
/// What needs the result of an instruction comes four instructions after it, and reads stand
/// between those that compute: in-order cores want both. The compiler knows nothing about
/// instructions in assembly but that they must not move past reads. If they could, it would read so
/// much before that sums go to the stack.
///
/// # Safety
/// There are eight values of each pixel. `weights` is valid for 64 bytes of each block, which are
/// `block_weights` apart.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn multiply<const P: usize, const B: usize>(
    sums: &mut [[[int32x4_t; 2]; B]; P],
    values: &mut [*const u8; P],
    weights: *const i8,
    block_weights: usize,
) {
    // The weights of two pairs of values.
    let pairs = |half: usize| {
        // SAFETY: as the caller promises.
        [0, B - 1].map(|b| unsafe {
            let weights = weights.add(b * block_weights + half * 32);
            [vld1q_s8(weights), vld1q_s8(weights.add(16))]
        })
    };
    // A pair of values for each of two blocks of one pixel, or of two pixels for one block.
    let mut next = |group: usize| {
        // SAFETY: as the caller promises.
        unsafe {
            let first = next_pair(&mut values[group % 4 * P / 4]);
            match B {
                1 => [first, next_pair(&mut values[group % 4 * P / 4 + 1])],
                _ => [first; 2],
            }
        }
    };
    let mut weights = pairs(0);
    let (mut first, mut second) = (next(0), next(0));
    unrolled!(group < 8 => {
        let (p, q) = (group % 4 * P / 4, group % 4 * P / 4 + 2 - B);
        let these = second;
        let mut products = products([weights[0][0], weights[1][0]], first);
        if group < 7 {
            first = next(group + 1);
        }
        add_products(&mut products, [weights[0][1], weights[1][1]], these);
        if group < 7 {
            second = next(group + 1);
        }
        if group == 3 {
            weights = pairs(1);
        }
        let mut pair = [sums[p][0], sums[q][B - 1]];
        add_pairs(&mut pair, products);
        [sums[p][0], sums[q][B - 1]] = pair;
    });
}

/// Reads two values, which are put beside the weights of each channel, and moves on: in one
/// instruction, where the compiler takes two.
///
/// # Safety
/// They are there.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn next_pair(values: &mut *const u8) -> int8x16_t {
    let pair;
    // SAFETY: as the caller promises.
    unsafe {
        asm!(
            "ld1r {{{pair:v}.8h}}, [{values}], #2",
            pair = out(vreg) pair,
            values = inout(reg) *values,
            options(nostack, preserves_flags, readonly),
        );
    }
    pair
}

/// The products of a pair of values with the weights of eight channels, twice.
#[target_feature(enable = "neon")]
#[inline]
fn products(weights: [int8x16_t; 2], values: [int8x16_t; 2]) -> [int16x8_t; 4] {
    let (a, b, c, d);
    // SAFETY: the instructions read and write only these registers.
    unsafe {
        asm!(
            "smull {a:v}.8h, {w0:v}.8b, {v0:v}.8b",
            "smull2 {b:v}.8h, {w0:v}.16b, {v0:v}.16b",
            "smull {c:v}.8h, {w1:v}.8b, {v1:v}.8b",
            "smull2 {d:v}.8h, {w1:v}.16b, {v1:v}.16b",
            a = out(vreg) a,
            b = out(vreg) b,
            c = out(vreg) c,
            d = lateout(vreg) d,
            w0 = in(vreg) weights[0],
            w1 = in(vreg) weights[1],
            v0 = in(vreg) values[0],
            v1 = in(vreg) values[1],
            options(nostack, preserves_flags),
        );
    }
    [a, b, c, d]
}

/// Adds those of the other pair of values.
#[target_feature(enable = "neon")]
#[inline]
fn add_products(
    [a, b, c, d]: &mut [int16x8_t; 4],
    weights: [int8x16_t; 2],
    values: [int8x16_t; 2],
) {
    // SAFETY: the instructions read and write only these registers.
    unsafe {
        asm!(
            "smlal {a:v}.8h, {w0:v}.8b, {v0:v}.8b",
            "smlal2 {b:v}.8h, {w0:v}.16b, {v0:v}.16b",
            "smlal {c:v}.8h, {w1:v}.8b, {v1:v}.8b",
            "smlal2 {d:v}.8h, {w1:v}.16b, {v1:v}.16b",
            a = inout(vreg) *a,
            b = inout(vreg) *b,
            c = inout(vreg) *c,
            d = inout(vreg) *d,
            w0 = in(vreg) weights[0],
            w1 = in(vreg) weights[1],
            v0 = in(vreg) values[0],
            v1 = in(vreg) values[1],
            options(nostack, preserves_flags),
        );
    }
}

/// Adds the products of both values of a pair to the sums.
#[target_feature(enable = "neon")]
#[inline]
fn add_pairs([[a, b], [c, d]]: &mut [[int32x4_t; 2]; 2], products: [int16x8_t; 4]) {
    // SAFETY: the instructions read and write only these registers.
    unsafe {
        asm!(
            "sadalp {a:v}.4s, {p0:v}.8h",
            "sadalp {b:v}.4s, {p1:v}.8h",
            "sadalp {c:v}.4s, {p2:v}.8h",
            "sadalp {d:v}.4s, {p3:v}.8h",
            a = inout(vreg) *a,
            b = inout(vreg) *b,
            c = inout(vreg) *c,
            d = inout(vreg) *d,
            p0 = in(vreg) products[0],
            p1 = in(vreg) products[1],
            p2 = in(vreg) products[2],
            p3 = in(vreg) products[3],
            options(nostack, preserves_flags),
        );
    }
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
