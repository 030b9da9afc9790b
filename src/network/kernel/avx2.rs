//! The kernel for x86-64 with AVX2: `vpmaddwd` multiplies pairs of 16-bit numbers and adds the
//! products.
//!
//! `vpmaddubsw`, which multiplies bytes, saturates on 8–35 % of the weight pairs of our models.

use super::avx::{Requantization, add, conv2d_by_tile, eight, store, sum_of};
use super::{BLOCK, DepthwiseWeights, Kernel, Rows, Scale, Strip, TapWeights, Tile};
use super::{forwarded, tail, unrolled};
use core::arch::x86_64::*;

/// Shows that the machine has AVX2.
#[derive(Clone, Copy)]
pub(in crate::network) struct Avx2(());

impl Avx2 {
    /// # Safety
    /// The machine has AVX2, as [`has_avx2`](super::avx::has_avx2) says.
    #[inline(always)]
    pub(in crate::network) unsafe fn new() -> Self {
        Avx2(())
    }
}

impl Kernel for Avx2 {
    const WIDTH: usize = 2;
    const GROUP: usize = 2;
    const TILE: usize = 6;

    fn stage(self, values: &[u8], zero_point: u8, staged: &mut [u8]) {
        // SAFETY: `self` exists only where the machine has AVX2; so for all below.
        unsafe { stage(values, zero_point, staged) }
    }

    forwarded!();
}

#[target_feature(enable = "avx2")]
fn stage(values: &[u8], zero_point: u8, staged: &mut [u8]) {
    tail::widen(values, zero_point, staged);
}

conv2d_by_tile!("avx2");

/// The sums of the `P` pixels of a tile in `B` blocks from `block` on.
///
/// # Safety
/// The strip has these blocks.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn sums<const P: usize, const B: usize>(
    strip: &Strip<'_>,
    tile: Tile,
    block: usize,
) -> [[__m256i; B]; P] {
    let mut bias = [_mm256_setzero_si256(); B];
    unrolled!(b < B => {
        // SAFETY: as the caller promises.
        bias[b] = unsafe { eight(strip.scale().bias, block + b) };
    });
    let mut sums = [bias; P];
    let block_weights = strip.block_weights();
    let mut weights = strip.weights().as_ptr().wrapping_add(block * block_weights);
    for row in strip.rows() {
        let mut values = [tile.window.wrapping_add(*row); P];
        unrolled!(p < P => {
            values[p] = values[p].wrapping_add(p * tile.step);
        });
        for pair in 0..strip.columns() / 2 {
            let mut pairs = [_mm256_setzero_si256(); B];
            unrolled!(b < B => {
                // SAFETY: a block has sixteen weights for each pair of columns of each row.
                let bytes = unsafe { _mm_loadu_si128(weights.add(b * block_weights).cast()) };
                pairs[b] = _mm256_cvtepi8_epi16(bytes);
            });
            unrolled!(p < P => {
                // SAFETY: a window has a pair of two-byte values for each pair of columns.
                let pair = unsafe { values[p].add(4 * pair).cast::<i32>().read_unaligned() };
                let pair = _mm256_set1_epi32(pair);
                unrolled!(b < B => {
                    sums[p][b] = _mm256_add_epi32(sums[p][b], _mm256_madd_epi16(pair, pairs[b]));
                });
            });
            weights = weights.wrapping_add(2 * BLOCK);
        }
    }
    sums
}

/// Sixteen channels at a time, then eight.
#[target_feature(enable = "avx2")]
fn depthwise3x3(
    rows: &Rows<'_>,
    weights: &DepthwiseWeights<'_>,
    scale: &Scale<'_>,
    out: &mut [u8],
) {
    let weights = weights.paired;
    let channels = rows.channels();
    let blocks = channels / BLOCK;
    if weights.len() < blocks || scale.bias.len() < blocks || scale.multiplier.len() < blocks {
        return;
    }
    let requantization = Requantization::new(scale);
    for (x, out) in out.chunks_exact_mut(channels.max(1)).enumerate() {
        let taps = rows.tap_starts(x);
        for block in (0..blocks).step_by(2) {
            let at = block * BLOCK;
            // SAFETY: every tap has all channels, as have the weights, the scale and the output.
            unsafe {
                let weights = weights.as_ptr().add(block);
                let out = out.as_mut_ptr().add(at);
                if block + 1 < blocks {
                    let bias = [eight(scale.bias, block), eight(scale.bias, block + 1)];
                    let sums = depthwise16(&taps, at, weights, bias);
                    requantization.store16(sums, block, out);
                } else {
                    let sums = depthwise8(&taps, at, weights, eight(scale.bias, block));
                    requantization.store8(sums, block, out);
                }
            }
        }
    }
}

/// The sums of sixteen channels from `at` on, which start with the bias.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn depthwise16(
    taps: &[*const u8; 10],
    at: usize,
    weights: *const TapWeights,
    mut sums: [__m256i; 2],
) -> [__m256i; 2] {
    let weights: [*const __m256i; 2] = [weights.cast(), weights.wrapping_add(1).cast()];
    for (k, pair) in taps.as_chunks::<2>().0.iter().enumerate() {
        // SAFETY: as the caller promises.
        let [first, second] = pair.map(|tap| unsafe { _mm_loadu_si128(tap.add(at).cast()) });
        let pairs = [
            _mm256_cvtepu8_epi16(_mm_unpacklo_epi8(first, second)),
            _mm256_cvtepu8_epi16(_mm_unpackhi_epi8(first, second)),
        ];
        for ((sum, pairs), weights) in sums.iter_mut().zip(pairs).zip(weights) {
            // SAFETY: as the caller promises.
            let weights = unsafe { _mm256_loadu_si256(weights.add(k)) };
            *sum = _mm256_add_epi32(*sum, _mm256_madd_epi16(pairs, weights));
        }
    }
    sums
}

/// The sums of eight channels from `at` on, which start with the bias.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn depthwise8(
    taps: &[*const u8; 10],
    at: usize,
    weights: *const TapWeights,
    mut sums: __m256i,
) -> __m256i {
    for (k, pair) in taps.as_chunks::<2>().0.iter().enumerate() {
        // SAFETY: as the caller promises.
        let [first, second] = pair.map(|tap| unsafe { _mm_loadl_epi64(tap.add(at).cast()) });
        let pairs = _mm256_cvtepu8_epi16(_mm_unpacklo_epi8(first, second));
        // SAFETY: as the caller promises.
        let weights = unsafe { _mm256_loadu_si256(weights.cast::<__m256i>().add(k)) };
        sums = _mm256_add_epi32(sums, _mm256_madd_epi16(pairs, weights));
    }
    sums
}

#[target_feature(enable = "avx2")]
fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<16>();
    let (rows, rest_of_row) = weights.as_chunks::<16>();
    let mut sums = _mm256_setzero_si256();
    for (features, weights) in vectors.iter().zip(rows) {
        // SAFETY: both are sixteen bytes.
        let (features, weights) = unsafe {
            (
                _mm256_cvtepu8_epi16(_mm_loadu_si128(features.as_ptr().cast())),
                _mm256_cvtepi8_epi16(_mm_loadu_si128(weights.as_ptr().cast())),
            )
        };
        sums = _mm256_add_epi32(sums, _mm256_madd_epi16(features, weights));
    }
    sum_of(sums).wrapping_add(tail::dot(rest, rest_of_row))
}
