//! The kernel for WebAssembly with 128-bit SIMD: `i32x4.dot_i16x8` multiplies pairs of 16-bit
//! numbers and adds the products.
//!
//! A module that holds such instructions loads only where they exist, so it is chosen when
//! compiling, by `-Ctarget-feature=+simd128`.

use super::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Scale, Strip, Sum, TapWeights, Tile};
use super::{conv2d_by_block, forwarded, tail, unrolled};
use core::arch::wasm32::*;

/// The module's `sums`, by its `of_group`, which reads a block's weights for `GROUP` columns, and
/// by `$multiplied`, which adds to sums the products of the four bytes of these columns with them.
macro_rules! sums_by_group {
    ($features:literal, $multiplied:ident) => {
        /// The sums of the pixels of a tile in a block.
        ///
        /// # Safety
        /// The strip has this block.
        #[target_feature(enable = $features)]
        #[inline]
        unsafe fn sums(strip: &Strip<'_>, tile: Tile, block: usize) -> [[v128; 2]; TILE] {
            let mut sums = [[i32x4_splat(0); 2]; TILE];
            let at = block * strip.block_weights();
            let mut weights = strip.weights().as_ptr().wrapping_add(at);
            for row in strip.rows() {
                let mut window = tile.window.wrapping_add(*row);
                for _ in 0..strip.columns() / GROUP {
                    // SAFETY: a block has the weights of each group of columns of each row.
                    let of_group = unsafe { of_group(weights) };
                    unrolled!(p < TILE => {
                        // SAFETY: a window has the four bytes of each group of columns.
                        let four = unsafe { v128_load32_splat(window.add(p * tile.step).cast()) };
                        unrolled!(half < 2 => {
                            sums[p][half] = $multiplied(of_group[half], four, sums[p][half]);
                        });
                    });
                    weights = weights.wrapping_add(GROUP * BLOCK);
                    window = window.wrapping_add(4);
                }
            }
            sums
        }
    };
}
#[cfg(target_feature = "relaxed-simd")]
pub(super) use sums_by_group;

#[derive(Clone, Copy)]
pub(in crate::network) struct Simd128;

/// Columns that are multiplied together.
const GROUP: usize = 2;

#[allow(
    unused_unsafe,
    reason = "WebAssembly checks a module's features when it is loaded"
)]
impl Kernel for Simd128 {
    const WIDTH: usize = 2;
    const GROUP: usize = GROUP;
    const TILE: usize = TILE;

    fn stage(self, values: &[u8], zero_point: u8, staged: &mut [u8]) {
        stage(values, zero_point, staged);
    }

    forwarded!();
}

// Not inlined: the compiler then computes the loop's end once, and uses vectors.
#[inline(never)]
fn stage(values: &[u8], zero_point: u8, staged: &mut [u8]) {
    tail::widen(values, zero_point, staged);
}

/// Pixels of a tile, whose sums fill eight registers.
const TILE: usize = 4;

conv2d_by_block!("simd128");

sums_by_group!("simd128", multiplied);

/// Weights of a block for a pair of columns.
///
/// # Safety
/// There are sixteen of them.
#[inline(always)]
unsafe fn of_group(weights: *const i8) -> [v128; 2] {
    // SAFETY: as the caller promises.
    [0, 8].map(|at| unsafe { i16x8_load_extend_i8x8(weights.add(at)) })
}

#[inline(always)]
fn multiplied(weights: v128, pair: v128, sums: v128) -> v128 {
    i32x4_add(sums, i32x4_dot_i16x8(pair, weights))
}

/// A [`Scale`] in registers; bias and multiplier are those of one block.
#[derive(Clone, Copy)]
pub(super) struct Requantization {
    bias: [v128; 2],
    multiplier: [v128; 2],
    pre_shift: u32,
    post_shift: u32,
    half: v128,
    /// The zero point; less 2·128 where a lateral is added.
    offset: v128,
    lateral: bool,
}

impl Requantization {
    #[target_feature(enable = "simd128")]
    #[inline]
    pub(super) fn new(scale: &Scale<'_>) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        Requantization {
            bias: [i32x4_splat(0); 2],
            multiplier: [i32x4_splat(0); 2],
            pre_shift,
            post_shift,
            half: i32x4_splat(half),
            offset: i16x8_splat((scale.zero_point + lateral) as i16),
            lateral: scale.lateral,
        }
    }

    #[target_feature(enable = "simd128")]
    #[inline]
    pub(super) fn of_block(&self, scale: &Scale<'_>, block: usize) -> Self {
        let [bias, multiplier] = [scale.bias, scale.multiplier].map(|of| {
            let [a, b, c, d, e, f, g, h] = of.get(block).copied().unwrap_or_default();
            [i32x4(a, b, c, d), i32x4(e, f, g, h)]
        });
        Requantization {
            bias,
            // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
            multiplier: multiplier.map(|m| v128_and(m, i32x4_splat(0xffff))),
            ..*self
        }
    }

    /// Writes the outputs of the block at a pixel; with `PLAIN`, nothing is added to them.
    ///
    /// # Safety
    /// `out` is valid for eight bytes.
    #[target_feature(enable = "simd128")]
    #[inline]
    pub(super) unsafe fn store<const PLAIN: bool>(&self, mut sums: [v128; 2], out: *mut u8) {
        unrolled!(half < 2 => {
            let kept = i32x4_shr(i32x4_add(sums[half], self.bias[half]), self.pre_shift);
            let scaled = i32x4_dot_i16x8(kept, self.multiplier[half]);
            sums[half] = i32x4_shr(i32x4_add(scaled, self.half), self.post_shift);
        });
        // What saturates here is clamped below anyway.
        let mut words = i16x8_narrow_i32x4(sums[0], sums[1]);
        let mut offset = self.offset;
        if !PLAIN && self.lateral {
            // SAFETY: as the caller promises.
            let lateral = unsafe { i16x8_load_extend_u8x8(out) };
            offset = i16x8_add(offset, i16x8_shl(lateral, 1));
        }
        if !PLAIN {
            words = i16x8_add_sat(words, offset);
        }
        // SAFETY: as the caller promises.
        unsafe { v128_store64_lane::<0>(u8x16_narrow_i16x8(words, words), out.cast()) };
    }
}

/// Eight channels of a pixel at a time.
#[target_feature(enable = "simd128")]
fn depthwise3x3(
    input: DepthwiseInput<'_>,
    weights: &DepthwiseWeights<'_>,
    scale: &Scale<'_>,
    out: &mut [u8],
) {
    let channels = input.channels();
    let requantization = Requantization::new(scale);
    let blocks = weights.paired.iter().take(channels / BLOCK);
    for (block, weights) in blocks.enumerate() {
        let requantization = requantization.of_block(scale, block);
        for (rows, out) in input.rows(out) {
            for (x, out) in out.chunks_exact_mut(channels.max(1)).enumerate() {
                let taps = rows.tap_starts(x);
                // SAFETY: every tap has all channels, as has the output.
                unsafe {
                    let sums = depthwise8(&taps, block * BLOCK, weights);
                    let out = out.as_mut_ptr().add(block * BLOCK);
                    requantization.store::<true>(sums, out);
                }
            }
        }
    }
}

/// The sums of eight channels from `at` on.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "simd128")]
#[inline]
unsafe fn depthwise8(taps: &[*const u8; 10], at: usize, weights: *const TapWeights) -> [v128; 2] {
    let mut sums = [i32x4_splat(0); 2];
    let mut weights = weights.cast::<v128>();
    for pair in taps.as_chunks::<2>().0 {
        // SAFETY: as the caller promises.
        let [first, second] = pair.map(|tap| unsafe { v128_load64_zero(tap.add(at).cast()) });
        let [pairs, _] = by_bytes(first, second);
        for (sum, pairs) in sums.iter_mut().zip(unsigned(pairs)) {
            // SAFETY: as the caller promises.
            let of_pairs = unsafe { v128_load(weights) };
            weights = weights.wrapping_add(1);
            *sum = i32x4_add(*sum, i32x4_dot_i16x8(pairs, of_pairs));
        }
    }
    sums
}

/// The bytes of both by turns.
#[inline(always)]
pub(super) fn by_bytes(a: v128, b: v128) -> [v128; 2] {
    [
        i8x16_shuffle::<0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23>(a, b),
        i8x16_shuffle::<8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31>(a, b),
    ]
}

/// Sixteen unsigned bytes as 16-bit numbers.
#[target_feature(enable = "simd128")]
#[inline]
fn unsigned(bytes: v128) -> [v128; 2] {
    [
        u16x8_extend_low_u8x16(bytes),
        u16x8_extend_high_u8x16(bytes),
    ]
}

#[target_feature(enable = "simd128")]
pub(super) fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
    let (pre_shift, post_shift, half) = sum.shifts();
    let [own, second] = sum.factors;
    let factors = i16x8(own, second, own, second, own, second, own, second);
    let half = i32x4_splat(half);
    let (vectors, rest) = out.as_chunks_mut::<8>();
    let (others, rest_of_other) = other.as_chunks::<8>();
    for (out, other) in vectors.iter_mut().zip(others) {
        // SAFETY: both are eight bytes.
        let [own, other] = [&*out, other].map(|v| unsafe { v128_load64_zero(v.as_ptr().cast()) });
        let [pairs, _] = by_bytes(own, other);
        let [low, high] = unsigned(pairs).map(|pairs| {
            let sum = i32x4_shr(i32x4_dot_i16x8(pairs, factors), pre_shift);
            i32x4_shr(i32x4_add(sum, half), post_shift)
        });
        let words = i16x8_narrow_i32x4(low, high);
        // SAFETY: the output is eight bytes.
        unsafe {
            v128_store64_lane::<0>(u8x16_narrow_i16x8(words, words), out.as_mut_ptr().cast());
        }
    }
    tail::add(sum, rest_of_other, rest);
}

#[target_feature(enable = "simd128")]
fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<8>();
    let (rows, rest_of_row) = weights.as_chunks::<8>();
    let mut sums = i32x4_splat(0);
    for (features, weights) in vectors.iter().zip(rows) {
        // SAFETY: both are eight bytes.
        let (features, weights) = unsafe {
            (
                i16x8_load_extend_u8x8(features.as_ptr()),
                i16x8_load_extend_i8x8(weights.as_ptr()),
            )
        };
        sums = i32x4_add(sums, i32x4_dot_i16x8(features, weights));
    }
    sum_of(sums).wrapping_add(tail::dot(rest, rest_of_row))
}

/// The sum of four numbers.
#[target_feature(enable = "simd128")]
#[inline]
pub(super) fn sum_of(numbers: v128) -> i32 {
    let numbers = [
        i32x4_extract_lane::<0>(numbers),
        i32x4_extract_lane::<1>(numbers),
        i32x4_extract_lane::<2>(numbers),
        i32x4_extract_lane::<3>(numbers),
    ];
    numbers.iter().fold(0, |a, b| a.wrapping_add(*b))
}
