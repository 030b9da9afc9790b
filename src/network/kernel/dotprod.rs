//! The kernel for AArch64 with dot products: `sdot` adds four products of signed bytes to each of
//! four sums.
//!
//! Values x are staged as x − 128, which fits a signed byte; the bias makes up for it:
//! Σ w·(x − z) = Σ w·(x − 128) + (128 − z)·Σ w, where z is the zero point.

use super::neon::{Requantization, add, depthwise3x3, dot};
use super::{BLOCK, Kernel, Strip, Tile, conv2d_by_block, forwarded, unrolled};
use core::arch::aarch64::*;
use core::arch::asm;

/// Shows that the machine has dot products.
#[derive(Clone, Copy)]
pub(in crate::network) struct Dotprod(());

impl Dotprod {
    /// # Safety
    /// The machine has dot products.
    #[inline(always)]
    pub(in crate::network) unsafe fn new() -> Self {
        Dotprod(())
    }
}

/// Flips the sign bit: x − 128 as a signed byte.
const SIGN: u8 = 128;

impl Kernel for Dotprod {
    const WIDTH: usize = 1;
    const GROUP: usize = 8;
    const TILE: usize = TILE;

    fn stage(self, values: &[u8], _zero_point: u8, staged: &mut [u8]) {
        flip_signs(values, staged);
    }

    fn padding(self, zero_point: u8) -> u8 {
        zero_point ^ SIGN
    }

    fn correct(self, weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
        let lack = i32::from(SIGN) - i32::from(zero_point);
        let blocks = weights.chunks_exact((weights.len() / bias.len().max(1)).max(1));
        for (bias, weights) in bias.iter_mut().zip(blocks) {
            let mut sums = [0i32; BLOCK];
            for pairs in weights.as_chunks::<{ 2 * BLOCK }>().0 {
                for (sum, [even, odd]) in sums.iter_mut().zip(pairs.as_chunks::<2>().0) {
                    *sum += i32::from(*even) + i32::from(*odd);
                }
            }
            for (bias, sum) in bias.iter_mut().zip(sums) {
                *bias = bias.wrapping_add(lack * sum);
            }
        }
    }

    forwarded!();
}

// Not inlined: the compiler then computes the loop's end once, and uses vectors.
#[inline(never)]
fn flip_signs(values: &[u8], staged: &mut [u8]) {
    for (out, value) in staged.iter_mut().zip(values) {
        *out = value ^ SIGN;
    }
}

/// Pixels of a tile, whose sums fill sixteen of the 32 registers.
const TILE: usize = 8;

conv2d_by_block!("neon,dotprod");

/// The sums of the pixels of a tile in a block.
///
/// # Safety
/// The strip has this block.
#[target_feature(enable = "neon,dotprod")]
#[inline]
unsafe fn sums(strip: &Strip<'_>, tile: Tile, block: usize) -> [[int32x4_t; 2]; TILE] {
    let mut sums = [[vdupq_n_s32(0); 2]; TILE];
    let mut weights = strip
        .weights()
        .as_ptr()
        .wrapping_add(block * strip.block_weights());
    for row in strip.rows() {
        let mut window = tile.window.wrapping_add(*row);
        for _ in 0..strip.columns() / 8 {
            // SAFETY: a block has 64 weights for each eight columns of each row.
            let pairs = unsafe { vld1q_s8_x4(weights) };
            let [a, b, c, d] =
                [pairs.0, pairs.1, pairs.2, pairs.3].map(|p| vreinterpretq_s16_s8(p));
            // Four channels × four columns each.
            let quads = [
                [vzip1q_s16(a, b), vzip2q_s16(a, b)],
                [vzip1q_s16(c, d), vzip2q_s16(c, d)],
            ];
            unrolled!(p < TILE => {
                // SAFETY: a window has a byte for each column.
                let values = vcombine_s8(
                    unsafe { vld1_s8(window.add(p * tile.step).cast()) },
                    vdup_n_s8(0),
                );
                unrolled!(half < 2 => {
                    sums[p][half] = sdot::<0>(sums[p][half], quads[0][half], values);
                    sums[p][half] = sdot::<1>(sums[p][half], quads[1][half], values);
                });
            });
            weights = weights.wrapping_add(8 * BLOCK);
            window = window.wrapping_add(8);
        }
    }
    sums
}

/// Adds to each sum the products of its four weights with the four values of `GROUP`.
#[target_feature(enable = "neon,dotprod")]
#[inline]
fn sdot<const GROUP: i32>(mut sums: int32x4_t, weights: int16x8_t, values: int8x16_t) -> int32x4_t {
    // SAFETY: the instruction reads and writes only these registers.
    unsafe {
        asm!(
            "sdot {sums:v}.4s, {weights:v}.16b, {values:v}.4b[{group}]",
            sums = inout(vreg) sums,
            weights = in(vreg) weights,
            values = in(vreg) values,
            group = const GROUP,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    sums
}
