//! What the kernels for x86-64 with 256-bit registers share.

use super::{BLOCK, Scale, Sum, tail, unrolled};
use core::arch::x86_64::*;

/// Whether the processor has AVX2, and the operating system keeps its registers.
pub(super) fn has_avx2() -> bool {
    // Miri runs no CPUID.
    if cfg!(any(target_feature = "avx2", miri)) {
        return cfg!(target_feature = "avx2");
    }
    const AVX2: u32 = 1 << 5;
    // The state of XMM and YMM registers.
    keeps_registers(0b110) && __cpuid_count(7, 0).ebx & AVX2 != 0
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

/// Whether the processor has AVX512-VNNI for vectors of 256 bits, and the operating system keeps
/// its registers.
pub(super) fn has_avx512() -> bool {
    if cfg!(miri) {
        return false;
    }
    const F_AND_VL: u32 = 1 << 16 | 1 << 31;
    const AVX512_VNNI: u32 = 1 << 11;
    // Mask registers, the upper halves of ZMM 0 to 15, and ZMM 16 to 31 too.
    if !has_avx2() || !keeps_registers(0b1110_0110) {
        return false;
    }
    let features = __cpuid_count(7, 0);
    features.ebx & F_AND_VL == F_AND_VL && features.ecx & AVX512_VNNI != 0
}

/// Whether there are CPUID's extended features, and the operating system keeps the registers of
/// these bits of XCR0.
fn keeps_registers(bits: u64) -> bool {
    const OSXSAVE_AND_AVX: u32 = 1 << 27 | 1 << 28;
    if __cpuid(0).eax < 7 || __cpuid(1).ecx & OSXSAVE_AND_AVX != OSXSAVE_AND_AVX {
        return false;
    }
    // SAFETY: OSXSAVE says that the instruction may be used.
    let registers = unsafe { xcr0() };
    registers & bits == bits
}

/// Extended control register 0.
#[target_feature(enable = "xsave")]
fn xcr0() -> u64 {
    // SAFETY: register 0 exists where XSAVE does.
    unsafe { _xgetbv(0) }
}

/// `conv2d` by the module's `of_group`, which reads a block's weights for `GROUP` columns, and by
/// `$multiplied`, which adds to sums the products of the four bytes of these columns with them.
macro_rules! conv2d_by_tile {
    ($features:literal, threes: $threes:literal, $multiplied:ident) => {
        /// Tiles of pixels × blocks that fill twelve of the sixteen registers: 6×2, for one that is
        /// left 8×1, for three that are left 4×3 where their weights fit too.
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

        /// The sums of the `P` pixels of a tile in `B` blocks from `block` on.
        ///
        /// # Safety
        /// The strip has these blocks.
        #[target_feature(enable = $features)]
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
                for group in 0..strip.columns() / GROUP {
                    let mut of_blocks = [_mm256_setzero_si256(); B];
                    unrolled!(b < B => {
                        // SAFETY: a block has the weights of each group of columns of each row.
                        of_blocks[b] = unsafe { of_group(weights.add(b * block_weights)) };
                    });
                    unrolled!(p < P => {
                        // SAFETY: a window has the four bytes of each group of columns.
                        let four = unsafe {
                            values[p].add(4 * group).cast::<i32>().read_unaligned()
                        };
                        let four = _mm256_set1_epi32(four);
                        unrolled!(b < B => {
                            sums[p][b] = $multiplied(sums[p][b], four, of_blocks[b]);
                        });
                    });
                    weights = weights.wrapping_add(GROUP * BLOCK);
                }
            }
            sums
        }
    };
}
pub(super) use conv2d_by_tile;

/// The eight numbers of a block.
///
/// # Safety
/// `block` is below the number of blocks.
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
