//! The kernel for x86-64 with AVX2: `vpmaddwd` multiplies pairs of 16-bit numbers and adds the
//! products.
//!
//! `vpmaddubsw`, which multiplies bytes, saturates on 8–35 % of the weight pairs of our models.

use super::avx::{Requantization, add, conv2d_by_tile, eight, sum_of};
use super::avx_depthwise::{Layer, bytes, depthwise_by_block};
use super::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Scale, Strip, Tile};
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

/// Columns that are multiplied together.
const GROUP: usize = 2;

impl Kernel for Avx2 {
    const WIDTH: usize = 2;
    const GROUP: usize = GROUP;
    const TILE: usize = 6;
    const PAIRED: bool = false;

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

conv2d_by_tile!("avx2", threes: true, multiplied);

/// Weights of a block for a pair of columns.
///
/// # Safety
/// There are sixteen of them.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn of_group(weights: *const i8) -> __m256i {
    // SAFETY: as the caller promises.
    _mm256_cvtepi8_epi16(unsafe { _mm_loadu_si128(weights.cast()) })
}

#[target_feature(enable = "avx2")]
#[inline]
fn multiplied(sums: __m256i, pair: __m256i, weights: __m256i) -> __m256i {
    _mm256_add_epi32(sums, _mm256_madd_epi16(pair, weights))
}

depthwise_by_block!("avx2");

/// Weights of sixteen channels, by pair of taps: four channels in each half of a vector, both the
/// same. The tenth tap is 0.
#[derive(Clone, Copy)]
struct Taps([[__m256i; 4]; 5]);

impl Taps {
    /// Reads the weights of `B` blocks; those of the next tap are `channels` further on.
    ///
    /// # Safety
    /// They are there.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn read<const B: usize>(weights: *const i8, channels: usize) -> Self {
        let mut taps = [[_mm256_setzero_si256(); 4]; 5];
        for (pair, taps) in taps.iter_mut().enumerate() {
            // SAFETY: as the caller promises.
            let [first, second] = [2 * pair, 2 * pair + 1].map(|k| match k {
                9 => _mm_setzero_si128(),
                _ => unsafe { bytes::<B>(weights.add(k * channels).cast()) },
            });
            let low = _mm_unpacklo_epi8(first, second);
            let high = _mm_unpackhi_epi8(first, second);
            let fours = [
                low,
                _mm_unpackhi_epi64(low, low),
                high,
                _mm_unpackhi_epi64(high, high),
            ];
            *taps = fours.map(|four| _mm256_broadcastsi128_si256(_mm_cvtepi8_epi16(four)));
        }
        Taps(taps)
    }

    /// Output pixels that are computed together: one for each half of the vectors.
    const fn together(_stride: usize) -> usize {
        2
    }

    /// The sums of the pixels whose input columns start at `tap(row, 0)` and so on; the second
    /// ones are not used.
    ///
    /// # Safety
    /// There are `B` blocks at each.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn sums<const B: usize, const STRIDE: usize>(
        &self,
        bias: [__m256i; 4],
        tap: impl Fn(usize, usize) -> *const u8,
    ) -> [[__m256i; 4]; 2] {
        let mut sums = bias;
        let value = |k: usize| match k {
            9 => _mm256_setzero_si256(),
            _ => {
                // SAFETY: as the caller promises.
                let [low, high] = [0, STRIDE].map(|c| unsafe { bytes::<B>(tap(k / 3, k % 3 + c)) });
                _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(low), high)
            }
        };
        let zero = _mm256_setzero_si256();
        unrolled!(pair < 5 => {
            let [first, second] = [value(2 * pair), value(2 * pair + 1)];
            let low = _mm256_unpacklo_epi8(first, second);
            let high = _mm256_unpackhi_epi8(first, second);
            let values = [
                _mm256_unpacklo_epi8(low, zero),
                _mm256_unpackhi_epi8(low, zero),
                _mm256_unpacklo_epi8(high, zero),
                _mm256_unpackhi_epi8(high, zero),
            ];
            unrolled!(q < 4 => {
                if q < 2 * B {
                    let products = _mm256_madd_epi16(values[q], self.0[pair][q]);
                    sums[q] = _mm256_add_epi32(sums[q], products);
                }
            });
        });
        [sums, bias]
    }
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
