//! The kernel for x86-64 with AVX2: `vpmaddwd` multiplies pairs of 16-bit numbers and adds the
//! products.
//!
//! `vpmaddubsw`, which multiplies bytes, saturates on 8–35 % of the weight pairs of our models. The
//! file is long because a kernel is one file.

use super::{BLOCK, DepthwiseWeights, Kernel, Rows, Scale, Strip, Sum, TapWeights, Tile};
use super::{forwarded, tail, unrolled};
use core::arch::x86_64::*;

/// Shows that the machine has AVX2.
#[derive(Clone, Copy)]
pub(in crate::network) struct Avx2(());

impl Avx2 {
    /// # Safety
    /// The machine has AVX2, as [`is_available`] says.
    #[inline(always)]
    pub(in crate::network) unsafe fn new() -> Self {
        Avx2(())
    }
}

/// Whether the processor has AVX2, and the operating system keeps its registers.
pub(super) fn is_available() -> bool {
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

/// Extended control register 0.
#[target_feature(enable = "xsave")]
fn xcr0() -> u64 {
    // SAFETY: register 0 exists where XSAVE does.
    unsafe { _xgetbv(0) }
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

/// Tiles of pixels × blocks that fill twelve of the sixteen registers: 6×2, for three blocks that
/// are left 4×3, for one that is left 8×1.
#[target_feature(enable = "avx2")]
fn conv2d(mut strip: Strip<'_>) {
    let mut block = 0;
    while let left @ 1.. = strip.blocks().saturating_sub(block) {
        block += match left {
            1 => tiles::<8, 1>(&mut strip, block),
            3 => tiles::<4, 3>(&mut strip, block),
            _ => tiles::<6, 2>(&mut strip, block),
        };
    }
}

/// All pixels of `B` blocks from `block` on, `P` pixels at a time. Returns `B`.
#[target_feature(enable = "avx2")]
#[inline]
fn tiles<const P: usize, const B: usize>(strip: &mut Strip<'_>, block: usize) -> usize {
    let (pixels, channels) = (strip.pixels(), strip.channels());
    let scale = *strip.scale();
    let requantization = Requantization::new(&scale);
    let out = strip.out().as_mut_ptr().wrapping_add(block * BLOCK);
    let mut first = 0;
    while first < pixels {
        let tile = strip.tile(first, P);
        // SAFETY: `conv2d` takes only blocks that the strip has.
        let sums = unsafe { sums::<P, B>(strip, tile, block) };
        unrolled!(p < P => {
            if p < tile.present {
                let out = out.wrapping_add((first + p) * channels);
                // SAFETY: the strip has the outputs of all its blocks at all its pixels.
                unsafe { store(&requantization, &sums[p], block, out) };
            }
        });
        first += tile.present;
    }
    B
}

/// Writes the outputs of `B` blocks from `block` on at a pixel.
///
/// # Safety
/// The scale has these blocks, and `out` is valid for their channels.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn store<const B: usize>(
    requantization: &Requantization<'_>,
    sums: &[__m256i; B],
    block: usize,
    out: *mut u8,
) {
    // SAFETY: as the caller promises.
    unsafe {
        if B >= 2 {
            requantization.store16([sums[0], sums[1]], block, out);
        }
        if B % 2 == 1 {
            let last = B - 1;
            requantization.store8(sums[last], block + last, out.add(last * BLOCK));
        }
    }
}

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
    let mut sums = [[_mm256_setzero_si256(); B]; P];
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

/// A [`Scale`] in registers.
struct Requantization<'a> {
    scale: &'a Scale<'a>,
    pre_shift: __m128i,
    post_shift: __m128i,
    half: __m256i,
    /// The zero point; less 2·128 where a lateral is added.
    offset: __m256i,
}

impl<'a> Requantization<'a> {
    #[target_feature(enable = "avx2")]
    #[inline]
    fn new(scale: &'a Scale<'a>) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        Requantization {
            scale,
            pre_shift: _mm_cvtsi32_si128(pre_shift as i32),
            post_shift: _mm_cvtsi32_si128(post_shift as i32),
            half: _mm256_set1_epi32(half),
            offset: _mm256_set1_epi16((scale.zero_point + lateral) as i16),
        }
    }

    /// The sums of a block, scaled.
    ///
    /// # Safety
    /// The scale has the block.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn scaled(&self, sums: __m256i, block: usize) -> __m256i {
        // SAFETY: the caller promises that both exist.
        let [bias, multiplier] = unsafe {
            [self.scale.bias, self.scale.multiplier]
                .map(|of| _mm256_loadu_si256(of.as_ptr().add(block).cast()))
        };
        let kept = _mm256_sra_epi32(_mm256_add_epi32(sums, bias), self.pre_shift);
        // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
        let multiplier = _mm256_and_si256(multiplier, _mm256_set1_epi32(0xffff));
        let scaled = _mm256_madd_epi16(kept, multiplier);
        _mm256_sra_epi32(_mm256_add_epi32(scaled, self.half), self.post_shift)
    }

    /// Writes the outputs of two blocks of channels of a pixel.
    ///
    /// # Safety
    /// The scale has both blocks, and `out` is valid for sixteen bytes.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn store16(&self, sums: [__m256i; 2], block: usize, out: *mut u8) {
        // SAFETY: as the caller promises.
        let (first, second) =
            unsafe { (self.scaled(sums[0], block), self.scaled(sums[1], block + 1)) };
        // In units of four channels, 0 2 | 1 3. What saturates here is clamped below anyway.
        let words = _mm256_packs_epi32(first, second);
        let mut offset = self.offset;
        if self.scale.lateral {
            // SAFETY: as the caller promises.
            let lateral = unsafe { _mm_loadu_si128(out.cast()) };
            let lateral = _mm256_cvtepu8_epi16(_mm_shuffle_epi32::<0b11_01_10_00>(lateral));
            offset = _mm256_add_epi16(offset, _mm256_slli_epi16::<1>(lateral));
        }
        let words = _mm256_adds_epi16(words, offset);
        let (low, high) = (
            _mm256_castsi256_si128(words),
            _mm256_extracti128_si256::<1>(words),
        );
        let bytes = _mm_shuffle_epi32::<0b11_01_10_00>(_mm_packus_epi16(low, high));
        // SAFETY: as the caller promises.
        unsafe { _mm_storeu_si128(out.cast(), bytes) };
    }

    /// Writes the outputs of a block of channels of a pixel.
    ///
    /// # Safety
    /// The scale has the block, and `out` is valid for eight bytes.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn store8(&self, sums: __m256i, block: usize, out: *mut u8) {
        // SAFETY: as the caller promises.
        let scaled = unsafe { self.scaled(sums, block) };
        let (low, high) = (
            _mm256_castsi256_si128(scaled),
            _mm256_extracti128_si256::<1>(scaled),
        );
        let words = _mm_packs_epi32(low, high);
        let mut offset = _mm256_castsi256_si128(self.offset);
        if self.scale.lateral {
            // SAFETY: as the caller promises.
            let lateral = _mm_cvtepu8_epi16(unsafe { _mm_loadl_epi64(out.cast_const().cast()) });
            offset = _mm_add_epi16(offset, _mm_slli_epi16::<1>(lateral));
        }
        let words = _mm_adds_epi16(words, offset);
        // SAFETY: as the caller promises.
        unsafe { _mm_storel_epi64(out.cast(), _mm_packus_epi16(words, words)) };
    }
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
                    let sums = depthwise16(&taps, at, weights);
                    requantization.store16(sums, block, out);
                } else {
                    let sums = depthwise8(&taps, at, weights);
                    requantization.store8(sums, block, out);
                }
            }
        }
    }
}

/// The sums of sixteen channels from `at` on.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn depthwise16(
    taps: &[*const u8; 10],
    at: usize,
    weights: *const TapWeights,
) -> [__m256i; 2] {
    let mut sums = [_mm256_setzero_si256(); 2];
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

/// The sums of eight channels from `at` on.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn depthwise8(taps: &[*const u8; 10], at: usize, weights: *const TapWeights) -> __m256i {
    let mut sums = _mm256_setzero_si256();
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
fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
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
    let (low, high) = (
        _mm256_castsi256_si128(sums),
        _mm256_extracti128_si256::<1>(sums),
    );
    let sums = _mm_add_epi32(low, high);
    let sums = _mm_add_epi32(sums, _mm_shuffle_epi32::<0b1110>(sums));
    let sum = _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_shuffle_epi32::<0b01>(sums)));
    sum.wrapping_add(tail::dot(rest, rest_of_row))
}
