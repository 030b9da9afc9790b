//! What the kernels for x86-64 with 256-bit registers share.

use super::{BLOCK, Scale, Sum, tail, unrolled};
use core::arch::x86_64::*;

/// Whether the processor has AVX2, and the operating system keeps its registers.
pub(super) fn has_avx2() -> bool {
    // Miri runs no CPUID.
    if cfg!(any(target_feature = "avx2", miri)) {
        return cfg!(target_feature = "avx2");
    }
    const OSXSAVE_AND_AVX: u32 = 1 << 27 | 1 << 28;
    const AVX2: u32 = 1 << 5;
    /// Bits of XCR0: the state of XMM and YMM registers.
    const REGISTERS: u64 = 0b110;
    if __cpuid(0).eax < 7 || __cpuid(1).ecx & OSXSAVE_AND_AVX != OSXSAVE_AND_AVX {
        return false;
    }
    // SAFETY: OSXSAVE says that the instruction may be used.
    let registers = unsafe { xcr0() };
    registers & REGISTERS == REGISTERS && __cpuid_count(7, 0).ebx & AVX2 != 0
}

/// Whether the processor has AVX-VNNI too.
pub(super) fn has_vnni() -> bool {
    // Miri has no such instruction.
    if cfg!(any(target_feature = "avxvnni", miri)) {
        return cfg!(target_feature = "avxvnni");
    }
    const AVX_VNNI: u32 = 1 << 4;
    has_avx2() && __cpuid_count(7, 0).eax >= 1 && __cpuid_count(7, 1).eax & AVX_VNNI != 0
}

/// Extended control register 0.
#[target_feature(enable = "xsave")]
fn xcr0() -> u64 {
    // SAFETY: register 0 exists where XSAVE does.
    unsafe { _xgetbv(0) }
}

/// `conv2d` by the module's `sums`, which has the same target features.
macro_rules! conv2d_by_tile {
    ($features:literal, threes: $threes:literal) => {
        /// Tiles of pixels × blocks that fill twelve of the sixteen registers: 6×2, for one that is
        /// left 8×1, for three that are left 4×3 where so many weights fit too.
        #[target_feature(enable = $features)]
        fn conv2d(mut strip: Strip<'_>) {
            let mut block = 0;
            while let left @ 1.. = strip.blocks().saturating_sub(block) {
                block += match left {
                    1 => tiles::<8, 1>(&mut strip, block),
                    3 if $threes => tiles::<4, 3>(&mut strip, block),
                    _ => tiles::<6, 2>(&mut strip, block),
                };
            }
        }

        /// All pixels of `B` blocks from `block` on, `P` pixels at a time, an even number. Returns
        /// `B`.
        #[target_feature(enable = $features)]
        #[inline]
        fn tiles<const P: usize, const B: usize>(strip: &mut Strip<'_>, block: usize) -> usize {
            let (pixels, channels) = (strip.pixels(), strip.channels());
            // SAFETY: `conv2d` takes only blocks that the strip has.
            let requantization = unsafe { Requantization::<B>::new(strip.scale(), block) };
            let mut out = strip.out().as_mut_ptr().wrapping_add(block * BLOCK);
            let mut first = 0;
            while first < pixels {
                let tile = strip.tile(first, P);
                // SAFETY: as above.
                let sums = unsafe { sums::<P, B>(strip, tile, block) };
                unrolled!(pair < P / 2 => {
                    let left = tile.present.saturating_sub(2 * pair);
                    if left > 0 {
                        let next = out.wrapping_add(if left > 1 { channels } else { 0 });
                        let [a, b] = [&sums[2 * pair], &sums[2 * pair + 1]];
                        // SAFETY: the strip has the outputs of all its blocks at all its pixels.
                        unsafe { requantization.store([a, b], [out, next]) };
                        out = out.wrapping_add(2 * channels);
                    }
                });
                first += tile.present;
                if tile.present % 2 == 1 {
                    out = out.wrapping_sub(channels);
                }
            }
            B
        }
    };
}
pub(super) use conv2d_by_tile;

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

        /// The outputs of `B` blocks from `block` on, where output pixels are `STRIDE` input pixels apart.
        /// The lower half of each vector is of one or two pixels, the upper half of the next ones.
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
            // SAFETY: the caller promises the weights and the scale; every output pixel and every input
            // column has all channels.
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

/// The eight numbers of a block.
///
/// # Safety
/// There are so many blocks.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) unsafe fn eight(of: &[[i32; BLOCK]], block: usize) -> __m256i {
    // SAFETY: as the caller promises.
    unsafe { _mm256_loadu_si256(of.as_ptr().add(block).cast()) }
}

/// The scale of `B` blocks in registers, but for the bias, with which the sums start.
pub(super) struct Requantization<const B: usize> {
    multiplier: [__m256i; B],
    pre_shift: __m128i,
    post_shift: __m128i,
    half: __m256i,
    /// The zero point; less 2·128 where a lateral is added.
    offset: __m256i,
    lateral: bool,
}

impl<const B: usize> Requantization<B> {
    /// # Safety
    /// The scale has these blocks.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(super) unsafe fn new(scale: &Scale<'_>, block: usize) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        let mut multiplier = [_mm256_setzero_si256(); B];
        unrolled!(b < B => {
            // SAFETY: as the caller promises.
            let of_block = unsafe { eight(scale.multiplier, block + b) };
            // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
            multiplier[b] = _mm256_and_si256(of_block, _mm256_set1_epi32(0xffff));
        });
        Requantization {
            multiplier,
            pre_shift: _mm_cvtsi32_si128(pre_shift as i32),
            post_shift: _mm_cvtsi32_si128(post_shift as i32),
            half: _mm256_set1_epi32(half),
            offset: _mm256_set1_epi16((scale.zero_point + lateral) as i16),
            lateral: scale.lateral,
        }
    }

    /// Writes the outputs of two pixels. They may be written to the same place, where those of the
    /// first stay.
    ///
    /// # Safety
    /// `out` is valid for eight bytes of each block.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(super) unsafe fn store(&self, sums: [&[__m256i; B]; 2], out: [*mut u8; 2]) {
        // SAFETY: as the caller promises.
        unsafe {
            if B >= 2 {
                self.store16(sums.map(|s| [s[0], s[1]]), [0, 1], out);
            }
            if B % 2 == 1 {
                let last = B - 1;
                self.store8(
                    sums.map(|s| s[last]),
                    last,
                    out.map(|o| o.add(last * BLOCK)),
                );
            }
        }
    }

    /// The sums of a block, scaled.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn scaled(&self, sums: __m256i, block: usize) -> __m256i {
        let kept = _mm256_sra_epi32(sums, self.pre_shift);
        let scaled = _mm256_madd_epi16(kept, self.multiplier[block]);
        _mm256_sra_epi32(_mm256_add_epi32(scaled, self.half), self.post_shift)
    }

    /// Writes the outputs of two blocks of channels of two pixels.
    ///
    /// # Safety
    /// `out` is valid for sixteen bytes.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn store16(&self, sums: [[__m256i; 2]; 2], blocks: [usize; 2], out: [*mut u8; 2]) {
        let words = [0, 1].map(|p: usize| {
            let [first, second] = [0, 1].map(|b: usize| self.scaled(sums[p][b], blocks[b]));
            // In units of four channels, 0 2 | 1 3. What saturates here is clamped below anyway.
            let words = _mm256_packs_epi32(first, second);
            let mut offset = self.offset;
            if self.lateral {
                // SAFETY: as the caller promises.
                let lateral = unsafe { _mm_loadu_si128(out[p].cast_const().cast()) };
                let lateral = _mm256_cvtepu8_epi16(_mm_shuffle_epi32::<0b11_01_10_00>(lateral));
                offset = _mm256_add_epi16(offset, _mm256_slli_epi16::<1>(lateral));
            }
            _mm256_adds_epi16(words, offset)
        });
        let bytes = _mm256_packus_epi16(words[0], words[1]);
        let order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
        let bytes = _mm256_permutevar8x32_epi32(bytes, order);
        // SAFETY: as the caller promises.
        unsafe {
            _mm_storeu_si128(out[1].cast(), _mm256_extracti128_si256::<1>(bytes));
            _mm_storeu_si128(out[0].cast(), _mm256_castsi256_si128(bytes));
        }
    }

    /// Writes the outputs of a block of channels of two pixels.
    ///
    /// # Safety
    /// `out` is valid for eight bytes.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn store8(&self, sums: [__m256i; 2], block: usize, out: [*mut u8; 2]) {
        let [first, second] = sums.map(|sums| self.scaled(sums, block));
        // In units of four channels, of both pixels in turn.
        let words = _mm256_packs_epi32(first, second);
        let mut offset = self.offset;
        if self.lateral {
            // SAFETY: as the caller promises.
            let [first, second] = out.map(|o| unsafe { _mm_loadl_epi64(o.cast_const().cast()) });
            let lateral = _mm256_cvtepu8_epi16(_mm_unpacklo_epi32(first, second));
            offset = _mm256_add_epi16(offset, _mm256_slli_epi16::<1>(lateral));
        }
        let words = _mm256_adds_epi16(words, offset);
        let bytes = _mm_unpacklo_epi32(
            _mm_packus_epi16(_mm256_castsi256_si128(words), _mm_setzero_si128()),
            _mm_packus_epi16(_mm256_extracti128_si256::<1>(words), _mm_setzero_si128()),
        );
        // SAFETY: as the caller promises.
        unsafe {
            _mm_storel_epi64(out[1].cast(), _mm_unpackhi_epi64(bytes, bytes));
            _mm_storel_epi64(out[0].cast(), bytes);
        }
    }
}

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

#[target_feature(enable = "avx2")]
pub(super) fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
    let (pre_shift, post_shift, half) = sum.shifts();
    let [own, second] = sum.factors.map(|f| f as u16 as u32);
    let factors = _mm256_set1_epi32((own | second << 16) as i32);
    let half = _mm256_set1_epi32(half);
    let [pre_shift, post_shift] = [pre_shift, post_shift].map(|s| _mm_cvtsi32_si128(s as i32));
    let (vectors, rest) = out.as_chunks_mut::<16>();
    let (others, rest_of_other) = other.as_chunks::<16>();
    for (out, other) in vectors.iter_mut().zip(others) {
        // SAFETY: both are sixteen bytes.
        let [own, other] = [&*out, other]
            .map(|v| unsafe { _mm256_cvtepu8_epi16(_mm_loadu_si128(v.as_ptr().cast())) });
        let pairs = [
            _mm256_unpacklo_epi16(own, other),
            _mm256_unpackhi_epi16(own, other),
        ];
        let [low, high] = pairs.map(|pairs| {
            let sum = _mm256_sra_epi32(_mm256_madd_epi16(pairs, factors), pre_shift);
            _mm256_sra_epi32(_mm256_add_epi32(sum, half), post_shift)
        });
        let words = _mm256_packs_epi32(low, high);
        let (low, high) = (
            _mm256_castsi256_si128(words),
            _mm256_extracti128_si256::<1>(words),
        );
        // SAFETY: the output is sixteen bytes.
        unsafe { _mm_storeu_si128(out.as_mut_ptr().cast(), _mm_packus_epi16(low, high)) };
    }
    tail::add(sum, rest_of_other, rest);
}

/// The sum of eight numbers.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn sum_of(numbers: __m256i) -> i32 {
    let (low, high) = (
        _mm256_castsi256_si128(numbers),
        _mm256_extracti128_si256::<1>(numbers),
    );
    let sums = _mm_add_epi32(low, high);
    let sums = _mm_add_epi32(sums, _mm_shuffle_epi32::<0b1110>(sums));
    _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_shuffle_epi32::<0b01>(sums)))
}
