//! The kernels for x86-64 whose instruction `vpdpbusd` adds four products of a byte and a signed
//! byte to each of eight sums: AVX-VNNI, and AVX512-VNNI on vectors of 256 bits.
//!
//! Values x are multiplied as they are; the bias makes up for it: Σ w·(x − z) = Σ w·x − z·Σ w,
//! where z is the zero point.

use super::avx_depthwise::bytes;
use super::unrolled;
use core::arch::x86_64::*;

/// Columns that are multiplied together.
pub(super) const GROUP: usize = 4;

/// The kernel `$kernel` by the intrinsic `$dot_product`, which needs `$features`.
macro_rules! kernel_by_dot_products {
    ($kernel:ident, $features:literal, $dot_product:ident) => {
        use super::avx::{Requantization, add, conv2d_by_tile, eight, sum_of};
        use super::avx_depthwise::{Layer, depthwise_by_block};
        use super::avx_dot_products::{GROUP, of_group, quads_of};
        use super::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Scale, Strip, Tile};
        use super::{forwarded, tail, unrolled};
        use core::arch::x86_64::*;

        /// Shows that the machine has these features.
        #[derive(Clone, Copy)]
        pub(in crate::network) struct $kernel(());

        impl $kernel {
            /// # Safety
            /// The machine has them.
            #[inline(always)]
            pub(in crate::network) unsafe fn new() -> Self {
                $kernel(())
            }
        }

        impl Kernel for $kernel {
            const WIDTH: usize = 1;
            const GROUP: usize = GROUP;
            const TILE: usize = 6;
            const PAIRED: bool = false;
            const DIRECT: bool = true;

            fn correct(self, weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
                if zero_point != 0 {
                    // SAFETY: `self` exists only where the machine has the features.
                    unsafe { correct(weights, zero_point, bias) }
                }
            }

            forwarded!();
        }

        /// Subtracts what values that stand for 0 add to the sums of each block.
        #[target_feature(enable = $features)]
        fn correct(weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
            let zero_points = _mm256_set1_epi8(zero_point as i8);
            let blocks = weights.chunks_exact((weights.len() / bias.len().max(1)).max(1));
            for (bias, weights) in bias.iter_mut().zip(blocks) {
                let mut sums = _mm256_setzero_si256();
                for weights in weights.as_chunks::<{ GROUP * BLOCK }>().0 {
                    // SAFETY: a group of columns of a block.
                    let weights = unsafe { of_group(weights.as_ptr()) };
                    sums = $dot_product(sums, zero_points, weights);
                }
                // SAFETY: a block has eight biases.
                unsafe {
                    let bias = bias.as_mut_ptr().cast();
                    _mm256_storeu_si256(bias, _mm256_sub_epi32(_mm256_loadu_si256(bias), sums));
                }
            }
        }

        conv2d_by_tile!($features, threes: false, $dot_product);

        depthwise_by_block!($features);

        /// Weights of sixteen channels, by row: four channels in each half of a vector, both the
        /// same.
        #[derive(Clone, Copy)]
        struct Taps {
            /// Left, middle, right, 0.
            first: [[__m256i; 4]; 3],
            /// 0, left, middle, right.
            second: [[__m256i; 4]; 3],
        }

        impl Taps {
            /// Reads the weights of `B` blocks; those of the next tap are `channels` further on.
            ///
            /// # Safety
            /// They are there.
            #[target_feature(enable = "avx2")]
            #[inline]
            unsafe fn read<const B: usize>(weights: *const i8, channels: usize) -> Self {
                let mut first = [[_mm256_setzero_si256(); 4]; 3];
                let mut second = first;
                for (row, (first, second)) in first.iter_mut().zip(&mut second).enumerate() {
                    let tap = |k| weights.wrapping_add((3 * row + k) * channels).cast();
                    // SAFETY: as the caller promises.
                    *first = unsafe { quads_of::<B, 2>(|_, k| tap(k)) };
                    *second = first.map(|w| _mm256_slli_epi32::<8>(w));
                }
                Taps { first, second }
            }

            /// Output pixels that are computed together: two for each half of the vectors where
            /// they are neighbours in the input too, else one.
            const fn together(stride: usize) -> usize {
                4 / stride
            }

            /// The sums of the pixels whose input columns start at `tap(row, 0)` and so on: of the
            /// first pixel of each half and, where `STRIDE` is 1, of the second.
            ///
            /// # Safety
            /// There are `B` blocks at each.
            #[target_feature(enable = $features)]
            #[inline]
            unsafe fn sums<const B: usize, const STRIDE: usize>(
                &self,
                bias: [__m256i; 4],
                tap: impl Fn(usize, usize) -> *const u8,
            ) -> [[__m256i; 4]; 2] {
                let [mut first, mut second] = [bias; 2];
                unrolled!(row < 3 => {
                    // SAFETY: as the caller promises.
                    let quads = unsafe { quads_of::<B, STRIDE>(|half, k| tap(row, 2 * half + k)) };
                    unrolled!(q < 4 => {
                        if q < 2 * B {
                            first[q] = $dot_product(first[q], quads[q], self.first[row][q]);
                            if STRIDE == 1 {
                                second[q] =
                                    $dot_product(second[q], quads[q], self.second[row][q]);
                            }
                        }
                    });
                });
                [first, second]
            }
        }

        #[target_feature(enable = $features)]
        fn dot(features: &[u8], weights: &[i8]) -> i32 {
            let (vectors, rest) = features.as_chunks::<32>();
            let (rows, rest_of_row) = weights.as_chunks::<32>();
            let mut sums = _mm256_setzero_si256();
            for (features, weights) in vectors.iter().zip(rows) {
                // SAFETY: both are 32 bytes.
                let [features, weights] = [features.as_ptr().cast(), weights.as_ptr().cast()]
                    .map(|v| unsafe { _mm256_loadu_si256(v) });
                sums = $dot_product(sums, features, weights);
            }
            sum_of(sums).wrapping_add(tail::dot(rest, rest_of_row))
        }
    };
}
pub(super) use kernel_by_dot_products;

/// Weights of a block for four columns: those of a channel side by side.
///
/// # Safety
/// There are 32 of them.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) unsafe fn of_group(weights: *const i8) -> __m256i {
    // SAFETY: as the caller promises.
    let pairs = unsafe { _mm256_loadu_si256(weights.cast()) };
    // Two pairs of columns of channels 0 to 3 | 4 to 7.
    let halves = _mm256_permute4x64_epi64::<0b11_01_10_00>(pairs);
    let order = _mm_setr_epi8(0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15);
    _mm256_shuffle_epi8(halves, _mm256_broadcastsi128_si256(order))
}

/// Four columns of `B` blocks side by side, those of each half of the vectors from `column(half,
/// k)` on; where `STRIDE` is 2 the fourth is 0.
///
/// # Safety
/// There are `B` blocks at each.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) unsafe fn quads_of<const B: usize, const STRIDE: usize>(
    column: impl Fn(usize, usize) -> *const u8,
) -> [__m256i; 4] {
    let mut columns = [_mm256_setzero_si256(); 4];
    unrolled!(k < 4 => {
        if k < 3 || STRIDE == 1 {
            // SAFETY: as the caller promises.
            let [low, high] = unsafe { [bytes::<B>(column(0, k)), bytes::<B>(column(1, k))] };
            columns[k] = _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(low), high);
        }
    });
    let [a, b, c, d] = columns;
    let low = [_mm256_unpacklo_epi8(a, b), _mm256_unpacklo_epi8(c, d)];
    let high = [_mm256_unpackhi_epi8(a, b), _mm256_unpackhi_epi8(c, d)];
    [
        _mm256_unpacklo_epi16(low[0], low[1]),
        _mm256_unpackhi_epi16(low[0], low[1]),
        _mm256_unpacklo_epi16(high[0], high[1]),
        _mm256_unpackhi_epi16(high[0], high[1]),
    ]
}
