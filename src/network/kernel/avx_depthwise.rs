//! The depthwise convolution that the kernels for x86-64 with 256-bit registers share.

use super::{Scale, unrolled};
use core::arch::x86_64::*;

/// `depthwise3x3` by the module's `Taps`, which has the same target features.
macro_rules! depthwise_by_block {
    ($features:literal) => {
        /// Two blocks of channels of all pixels, then the next two.
        #[target_feature(enable = $features)]
        fn depthwise3x3(
            input: DepthwiseInput<'_>,
            weights: &DepthwiseWeights<'_>,
            scale: &Scale<'_>,
            out: &mut [u8],
        ) {
            let channels = input.channels();
            let blocks = channels / BLOCK;
            let weights = weights.raw;
            if weights.len() < 9 * channels
                || scale.bias.len() < blocks
                || scale.multiplier.len() < blocks
            {
                return;
            }
            for block in (0..blocks).step_by(2) {
                // SAFETY: there are the weights and the scale of all channels.
                unsafe {
                    match (block + 1 < blocks, input.stride()) {
                        (true, 1) => depthwise::<2, 1>(input, weights, scale, block, out),
                        (true, _) => depthwise::<2, 2>(input, weights, scale, block, out),
                        (false, 1) => depthwise::<1, 1>(input, weights, scale, block, out),
                        (false, _) => depthwise::<1, 2>(input, weights, scale, block, out),
                    }
                }
            }
        }

        /// The outputs of `B` blocks from `block` on, where output pixels are `STRIDE` input pixels
        /// apart. The lower half of each vector is of one or two pixels, the upper half of the next
        /// ones.
        ///
        /// # Safety
        /// The input, the nine weights of each channel and the scale have these blocks.
        #[target_feature(enable = $features)]
        #[inline]
        unsafe fn depthwise<const B: usize, const STRIDE: usize>(
            input: DepthwiseInput<'_>,
            weights: &[i8],
            scale: &Scale<'_>,
            block: usize,
            out: &mut [u8],
        ) {
            let (channels, at) = (input.channels(), block * BLOCK);
            let together = Taps::together(STRIDE);
            // SAFETY: the caller promises the weights and the scale; every output pixel and every
            // input column has all channels.
            unsafe {
                let weights = Taps::read::<B>(weights.as_ptr().add(at), channels);
                let layer = Layer::<B>::new(scale, block);
                for (rows, out) in input.rows(out) {
                    let pixels = out.len() / channels.max(1);
                    let out = out.as_mut_ptr().add(at);
                    for x in (0..pixels).step_by(together) {
                        let sums = if rows.has_columns(x, (together - 1) * STRIDE + 3) {
                            let lines = rows.lines(x);
                            weights
                                .sums::<B, STRIDE>(layer.bias, |row, k| lines[row].tap(k).add(at))
                        } else {
                            let columns = rows.columns::<6>(x);
                            weights.sums::<B, STRIDE>(layer.bias, |row, k| columns[row][k].add(at))
                        };
                        let (present, half) = (pixels - x, together / 2);
                        let out = out.add(x * channels);
                        layer.store(sums[0], [out, out.add(half * channels)], present > half);
                        if together == 4 && present > 1 {
                            let next = [out.add(channels), out.add(3 * channels)];
                            layer.store(sums[1], next, present > 3);
                        }
                    }
                }
            }
        }
    };
}
pub(super) use depthwise_by_block;

/// The scale of `B` blocks: four channels in each half of a vector, both the same.
#[derive(Clone, Copy)]
pub(super) struct Layer<const B: usize> {
    pub(super) bias: [__m256i; 4],
    multiplier: [__m256i; 4],
    pre_shift: __m128i,
    post_shift: __m128i,
    half: __m256i,
}

impl<const B: usize> Layer<B> {
    /// # Safety
    /// The scale has the blocks from `block` on.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(super) unsafe fn new(scale: &Scale<'_>, block: usize) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let [mut bias, mut multiplier] = [[_mm256_setzero_si256(); 4]; 2];
        unrolled!(q < 4 => {
            if q < 2 * B {
                let [of_bias, of_multiplier] = [scale.bias, scale.multiplier].map(|of| {
                    let four = of.as_ptr().wrapping_add(block).cast::<__m128i>().wrapping_add(q);
                    // SAFETY: as the caller promises.
                    _mm256_broadcastsi128_si256(unsafe { _mm_loadu_si128(four) })
                });
                bias[q] = of_bias;
                // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
                multiplier[q] = _mm256_and_si256(of_multiplier, _mm256_set1_epi32(0xffff));
            }
        });
        Layer {
            bias,
            multiplier,
            pre_shift: _mm_cvtsi32_si128(pre_shift as i32),
            post_shift: _mm_cvtsi32_si128(post_shift as i32),
            half: _mm256_set1_epi32(half),
        }
    }

    /// Writes the outputs of the lower halves, and those of the upper halves where they are
    /// wanted.
    ///
    /// # Safety
    /// What is written to is valid for `B` blocks.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(super) unsafe fn store(&self, sums: [__m256i; 4], out: [*mut u8; 2], upper: bool) {
        let mut scaled = sums;
        unrolled!(q < 4 => {
            if q < 2 * B {
                let kept = _mm256_sra_epi32(sums[q], self.pre_shift);
                let product = _mm256_madd_epi16(kept, self.multiplier[q]);
                scaled[q] =
                    _mm256_sra_epi32(_mm256_add_epi32(product, self.half), self.post_shift);
            }
        });
        // What saturates here is clamped to bytes anyway.
        let words = [
            _mm256_packs_epi32(scaled[0], scaled[1]),
            _mm256_packs_epi32(scaled[2], scaled[3]),
        ];
        let bytes = _mm256_packus_epi16(words[0], words[1]);
        let halves = [
            _mm256_castsi256_si128(bytes),
            _mm256_extracti128_si256::<1>(bytes),
        ];
        // SAFETY: as the caller promises.
        unsafe {
            write::<B>(halves[0], out[0]);
            if upper {
                write::<B>(halves[1], out[1]);
            }
        }
    }
}

/// Writes the bytes of one or two blocks.
///
/// # Safety
/// There is room.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn write<const B: usize>(bytes: __m128i, out: *mut u8) {
    // SAFETY: as the caller promises.
    unsafe {
        match B {
            1 => _mm_storel_epi64(out.cast(), bytes),
            _ => _mm_storeu_si128(out.cast(), bytes),
        }
    }
}

/// Reads the bytes of one or two blocks.
///
/// # Safety
/// They are there.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) unsafe fn bytes<const B: usize>(from: *const u8) -> __m128i {
    // SAFETY: as the caller promises.
    unsafe {
        match B {
            1 => _mm_loadl_epi64(from.cast()),
            _ => _mm_loadu_si128(from.cast()),
        }
    }
}
