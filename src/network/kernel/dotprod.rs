//! The kernel for AArch64 with dot products: `sdot` adds four products of signed bytes to each of
//! four sums.

use super::aarch64::{Requantization, SIGN, add, depthwise3x3, halves, signed_bytes};
use super::{BLOCK, Kernel, Strip, Tile, conv2d_by_block, forwarded, tail, unrolled};
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

impl Kernel for Dotprod {
    signed_bytes!();

    forwarded!();
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
    let mut sums = [halves(strip.scale().bias, block); TILE];
    let mut weights = strip
        .weights()
        .as_ptr()
        .wrapping_add(block * strip.block_weights());
    for row in strip.rows() {
        let mut window = tile.window.wrapping_add(*row);
        // SAFETY: a window has a byte for each column, and a block eight weights for each of them.
        unsafe {
            for _ in 0..strip.columns() / 16 {
                let [first, second] = [weights, weights.add(8 * BLOCK)].map(|w| quads(w));
                unrolled!(p < TILE => {
                    let values = vld1q_s8(window.add(p * tile.step).cast());
                    multiply::<0, 1>(&mut sums[p], &first, values);
                    multiply::<2, 3>(&mut sums[p], &second, values);
                });
                weights = weights.wrapping_add(16 * BLOCK);
                window = window.wrapping_add(16);
            }
            if strip.columns() % 16 != 0 {
                let quads = quads(weights);
                unrolled!(p < TILE => {
                    let values = vld1_s8(window.add(p * tile.step).cast());
                    multiply::<0, 1>(&mut sums[p], &quads, vcombine_s8(values, vdup_n_s8(0)));
                });
                weights = weights.wrapping_add(8 * BLOCK);
            }
        }
    }
    sums
}

/// Weights of a block for eight columns: four columns of each of four channels in a vector.
///
/// # Safety
/// There are 64 of them.
#[target_feature(enable = "neon,dotprod")]
#[inline]
unsafe fn quads(weights: *const i8) -> [[int16x8_t; 2]; 2] {
    // SAFETY: as the caller promises.
    let pairs = unsafe { vld1q_s8_x4(weights) };
    let [a, b, c, d] = [pairs.0, pairs.1, pairs.2, pairs.3].map(|p| vreinterpretq_s16_s8(p));
    [
        [vzip1q_s16(a, b), vzip2q_s16(a, b)],
        [vzip1q_s16(c, d), vzip2q_s16(c, d)],
    ]
}

/// Multiplies eight of a pixel's values, in groups of four, by their weights.
#[target_feature(enable = "neon,dotprod")]
#[inline]
fn multiply<const FIRST: i32, const SECOND: i32>(
    sums: &mut [int32x4_t; 2],
    quads: &[[int16x8_t; 2]; 2],
    values: int8x16_t,
) {
    unrolled!(half < 2 => {
        sums[half] = sdot::<FIRST>(sums[half], quads[0][half], values);
        sums[half] = sdot::<SECOND>(sums[half], quads[1][half], values);
    });
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

#[target_feature(enable = "neon,dotprod")]
fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<32>();
    let (rows, rest_of_row) = weights.as_chunks::<32>();
    let ones = vdupq_n_s8(1);
    // Σ w·(x − 128) and Σ w.
    let [mut products, mut sums] = [vdupq_n_s32(0); 2];
    for (features, weights) in vectors.iter().zip(rows) {
        unrolled!(half < 2 => {
            // SAFETY: both are twice sixteen bytes.
            let (features, weights) = unsafe {
                let at = 16 * half;
                (vld1q_u8(features.as_ptr().add(at)), vld1q_s8(weights.as_ptr().add(at)))
            };
            let features = vreinterpretq_s8_u8(veorq_u8(features, vdupq_n_u8(SIGN)));
            products = sdot_all(products, weights, features);
            sums = sdot_all(sums, weights, ones);
        });
    }
    let sum = vaddvq_s32(products).wrapping_add(i32::from(SIGN) * vaddvq_s32(sums));
    sum.wrapping_add(tail::dot(rest, rest_of_row))
}

/// Adds to each sum the four products of its weights with its values.
#[target_feature(enable = "neon,dotprod")]
#[inline]
fn sdot_all(mut sums: int32x4_t, weights: int8x16_t, values: int8x16_t) -> int32x4_t {
    // SAFETY: the instruction reads and writes only these registers.
    unsafe {
        asm!(
            "sdot {sums:v}.4s, {weights:v}.16b, {values:v}.16b",
            sums = inout(vreg) sums,
            weights = in(vreg) weights,
            values = in(vreg) values,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    sums
}
