//! The kernel for WebAssembly with relaxed SIMD: `i32x4.relaxed_dot_i8x16_i7x16_add_s` adds four
//! products of a signed byte and a byte to each of four sums.
//!
//! What it makes of a byte above 127 is up to the machine: some take it as it is, with sums of all
//! bits (x86-64 with AVX-VNNI), some may cut sums to 16 bits or take it as a signed number. A
//! machine always does the same, so [`is_exact`] tries it, and only where bytes are taken as they
//! are is this kernel chosen. Values x are multiplied as they are; the bias makes up for it, as
//! with AVX-VNNI: Σ w·(x − z) = Σ w·x − z·Σ w.
//!
//! A module that holds such instructions loads only where they exist, so they are chosen when
//! compiling, by `-Ctarget-feature=+simd128,+relaxed-simd`.

use super::simd128::{Requantization, add, by_bytes, sum_of, sums_by_group};
use super::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Scale, Strip, Tile};
use super::{conv2d_by_block, forwarded, tail, unrolled};
use core::arch::wasm32::*;
use core::hint::black_box;

/// Shows that dot products are exact.
#[derive(Clone, Copy)]
pub(in crate::network) struct Relaxed(());

impl Relaxed {
    /// # Safety
    /// [`is_exact`].
    #[inline(always)]
    pub(in crate::network) unsafe fn new() -> Self {
        Relaxed(())
    }
}

/// Whether the machine's dot products take bytes as they are and cut nothing: products at the ends
/// of both ranges, in every place, whose sums in pairs take more than 16 bits.
pub(super) fn is_exact() -> bool {
    const ENDS: [([i8; 4], [u8; 4]); 5] = [
        ([127; 4], [255; 4]),
        ([-127; 4], [255; 4]),
        ([127, 127, -127, -127], [255, 255, 128, 128]),
        ([-127, 127, 1, -1], [254, 128, 255, 129]),
        ([3, -127, -127, 127], [128, 255, 255, 1]),
    ];
    ENDS.iter().all(|(weights, values)| {
        let products = weights
            .iter()
            .zip(values)
            .map(|(w, v)| *w as i32 * *v as i32);
        let sum: i32 = products.sum();
        // The compiler must not work it out itself.
        let [weights, values] = black_box([
            i32x4_splat(i32::from_le_bytes(weights.map(|w| w as u8))),
            i32x4_splat(i32::from_le_bytes(*values)),
        ]);
        let sums = i32x4_relaxed_dot_i8x16_i7x16_add(weights, values, i32x4_splat(-5));
        i32x4_all_true(i32x4_eq(black_box(sums), i32x4_splat(sum - 5)))
    })
}

/// Columns that are multiplied together.
const GROUP: usize = 4;

#[allow(
    unused_unsafe,
    reason = "WebAssembly checks a module's features when it is loaded"
)]
impl Kernel for Relaxed {
    const WIDTH: usize = 1;
    const GROUP: usize = GROUP;
    const TILE: usize = TILE;
    const PAIRED: bool = false;
    const DIRECT: bool = true;

    fn correct(self, weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
        if zero_point != 0 {
            correct(weights, zero_point, bias);
        }
    }

    forwarded!();
}

/// Subtracts what values that stand for 0 add to the sums of each block.
fn correct(weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
    let zero_points = u8x16_splat(zero_point);
    let blocks = weights.chunks_exact((weights.len() / bias.len().max(1)).max(1));
    for (bias, weights) in bias.iter_mut().zip(blocks) {
        let mut sums = [i32x4_splat(0); 2];
        for weights in weights.as_chunks::<{ GROUP * BLOCK }>().0 {
            // SAFETY: a group of columns of a block.
            let weights = unsafe { of_group(weights.as_ptr()) };
            unrolled!(half < 2 => {
                sums[half] =
                    i32x4_relaxed_dot_i8x16_i7x16_add(weights[half], zero_points, sums[half]);
            });
        }
        unrolled!(half < 2 => {
            // SAFETY: a block has eight biases.
            unsafe {
                let bias = bias.as_mut_ptr().add(4 * half).cast::<v128>();
                v128_store(bias, i32x4_sub(v128_load(bias), sums[half]));
            }
        });
    }
}

/// Pixels of a tile, whose sums fill eight registers; six need a register more than there are.
const TILE: usize = 4;

conv2d_by_block!("simd128,relaxed-simd");

sums_by_group!("simd128,relaxed-simd", i32x4_relaxed_dot_i8x16_i7x16_add);

/// Weights of a block for four columns: those of a channel side by side.
///
/// # Safety
/// There are 32 of them.
#[inline(always)]
unsafe fn of_group(weights: *const i8) -> [v128; 2] {
    // SAFETY: as the caller promises.
    let [first, second] = [0, 16].map(|at| unsafe { v128_load(weights.add(at).cast()) });
    by_words(first, second)
}

/// The words of both by turns.
#[inline(always)]
fn by_words(a: v128, b: v128) -> [v128; 2] {
    [
        i16x8_shuffle::<0, 8, 1, 9, 2, 10, 3, 11>(a, b),
        i16x8_shuffle::<4, 12, 5, 13, 6, 14, 7, 15>(a, b),
    ]
}

/// Two blocks of channels of all pixels, then the next two.
#[target_feature(enable = "simd128,relaxed-simd")]
fn depthwise3x3(
    input: DepthwiseInput<'_>,
    weights: &DepthwiseWeights<'_>,
    scale: &Scale<'_>,
    out: &mut [u8],
) {
    let channels = input.channels();
    let blocks = channels / BLOCK;
    let weights = weights.raw;
    if weights.len() < 9 * channels {
        return;
    }
    for block in (0..blocks).step_by(2) {
        // SAFETY: there are the weights of all channels.
        unsafe {
            match block + 1 < blocks {
                true => depthwise::<2>(input, weights, scale, block, out),
                false => depthwise::<1>(input, weights, scale, block, out),
            }
        }
    }
}

/// The outputs of `B` blocks from `block` on.
///
/// # Safety
/// The input and the nine weights of each channel have these blocks.
#[target_feature(enable = "simd128,relaxed-simd")]
#[inline]
unsafe fn depthwise<const B: usize>(
    input: DepthwiseInput<'_>,
    weights: &[i8],
    scale: &Scale<'_>,
    block: usize,
    out: &mut [u8],
) {
    let (channels, at) = (input.channels(), block * BLOCK);
    let taps = |k: usize| weights.as_ptr().wrapping_add(k * channels + at).cast();
    // SAFETY: as the caller promises.
    let weights = unsafe { by_taps::<B>(taps) };
    let plain = Requantization::new(scale);
    let scales = [0, 1].map(|b| plain.of_block(scale, block + b));
    for (rows, out) in input.rows(out) {
        for (x, out) in out.chunks_exact_mut(channels.max(1)).enumerate() {
            let starts = rows.tap_starts(x);
            // SAFETY: every tap has all channels, as has the output.
            unsafe {
                let values = by_taps::<B>(|k| starts[k].wrapping_add(at));
                let mut sums = [i32x4_splat(0); 4];
                unrolled!(q < 4 => {
                    if q < 2 * B {
                        unrolled!(group < 3 => {
                            sums[q] = i32x4_relaxed_dot_i8x16_i7x16_add(
                                weights[group][q],
                                values[group][q],
                                sums[q],
                            );
                        });
                    }
                });
                let out = out.as_mut_ptr().add(at);
                scales[0].store::<true>([sums[0], sums[1]], out);
                if B == 2 {
                    scales[1].store::<true>([sums[2], sums[3]], out.add(BLOCK));
                }
            }
        }
    }
}

/// What is at nine taps of `B` blocks of channels, four taps of each channel side by side; beside
/// the ninth are zeros.
///
/// # Safety
/// There are `B` blocks at each tap.
#[inline(always)]
unsafe fn by_taps<const B: usize>(tap: impl Fn(usize) -> *const u8) -> [[v128; 4]; 3] {
    let mut taps = [i32x4_splat(0); 12];
    unrolled!(k < 8 => {
        // SAFETY: as the caller promises.
        taps[k] = unsafe { bytes::<B>(tap(k)) };
    });
    // SAFETY: as above.
    taps[8] = unsafe { bytes::<B>(tap(8)) };
    let mut quads = [[i32x4_splat(0); 4]; 3];
    unrolled!(group < 3 => {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| taps[4 * group + k]);
        let (first, second) = (by_bytes(a, b), by_bytes(c, d));
        unrolled!(half < 2 => {
            if half < B {
                let words = by_words(first[half], second[half]);
                quads[group][2 * half] = words[0];
                quads[group][2 * half + 1] = words[1];
            }
        });
    });
    quads
}

/// The bytes of `B` blocks.
///
/// # Safety
/// They are there.
#[inline(always)]
unsafe fn bytes<const B: usize>(at: *const u8) -> v128 {
    // SAFETY: as the caller promises.
    unsafe {
        match B {
            1 => v128_load64_zero(at.cast()),
            _ => v128_load(at.cast()),
        }
    }
}

#[target_feature(enable = "simd128,relaxed-simd")]
fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<16>();
    let (rows, rest_of_row) = weights.as_chunks::<16>();
    let mut sums = i32x4_splat(0);
    for (features, weights) in vectors.iter().zip(rows) {
        // SAFETY: both are sixteen bytes.
        let [features, weights] = [features.as_ptr().cast(), weights.as_ptr().cast()]
            .map(|v: *const v128| unsafe { v128_load(v) });
        sums = i32x4_relaxed_dot_i8x16_i7x16_add(weights, features, sums);
    }
    sum_of(sums).wrapping_add(tail::dot(rest, rest_of_row))
}
