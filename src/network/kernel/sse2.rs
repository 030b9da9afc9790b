//! The kernel for x86-64: `pmaddwd` multiplies pairs of 16-bit numbers and adds the products.

use super::{BLOCK, DepthwiseWeights, Kernel, Rows, Scale, Strip, Sum, TapWeights, Tile};
use super::{conv2d_by_block, depthwise3x3_by_block, forwarded, tail, unrolled};
use core::arch::x86_64::*;

#[derive(Clone, Copy)]
pub(in crate::network) struct Sse2;

impl Kernel for Sse2 {
    const WIDTH: usize = 2;
    const GROUP: usize = 8;
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

/// Pixels of a tile, whose sums fill eight of the sixteen registers.
const TILE: usize = 4;

conv2d_by_block!("sse2");

/// The sums of the pixels of a tile in a block.
///
/// # Safety
/// The strip has this block.
#[target_feature(enable = "sse2")]
#[inline]
unsafe fn sums(strip: &Strip<'_>, tile: Tile, block: usize) -> [[__m128i; 2]; TILE] {
    let mut sums = [[_mm_setzero_si128(); 2]; TILE];
    let mut weights = strip
        .weights()
        .as_ptr()
        .wrapping_add(block * strip.block_weights());
    for row in strip.rows() {
        let mut window = tile.window.wrapping_add(*row);
        for _ in 0..strip.columns() / 8 {
            // SAFETY: a window has eight two-byte values for each eight columns.
            let mut values = [_mm_setzero_si128(); TILE];
            for (p, values) in values.iter_mut().enumerate() {
                // SAFETY: a window has eight two-byte values for each eight columns.
                *values = unsafe { _mm_loadu_si128(window.add(p * tile.step).cast()) };
            }
            // SAFETY: a block has 64 weights for each eight columns of each row.
            unsafe {
                multiply::<0b00_00_00_00>(&mut sums, &values, weights);
                multiply::<0b01_01_01_01>(&mut sums, &values, weights.add(16));
                multiply::<0b10_10_10_10>(&mut sums, &values, weights.add(32));
                multiply::<0b11_11_11_11>(&mut sums, &values, weights.add(48));
            }
            weights = weights.wrapping_add(8 * BLOCK);
            window = window.wrapping_add(16);
        }
    }
    sums
}

/// Multiplies one pair of the values of each pixel, which `PAIR` copies to all places, by sixteen
/// weights.
///
/// # Safety
/// `weights` is valid for sixteen bytes.
#[target_feature(enable = "sse2")]
#[inline]
unsafe fn multiply<const PAIR: i32>(
    sums: &mut [[__m128i; 2]; TILE],
    values: &[__m128i; TILE],
    weights: *const i8,
) {
    // SAFETY: as the caller promises.
    let bytes = unsafe { _mm_loadu_si128(weights.cast()) };
    let weights = signed(bytes);
    for ([low, high], values) in sums.iter_mut().zip(values) {
        let pair = _mm_shuffle_epi32::<PAIR>(*values);
        *low = _mm_add_epi32(*low, _mm_madd_epi16(pair, weights[0]));
        *high = _mm_add_epi32(*high, _mm_madd_epi16(pair, weights[1]));
    }
}

/// Sixteen signed bytes as 16-bit numbers.
#[target_feature(enable = "sse2")]
#[inline]
fn signed(bytes: __m128i) -> [__m128i; 2] {
    let sign = _mm_cmpgt_epi8(_mm_setzero_si128(), bytes);
    [
        _mm_unpacklo_epi8(bytes, sign),
        _mm_unpackhi_epi8(bytes, sign),
    ]
}

/// Sixteen unsigned bytes as 16-bit numbers.
#[target_feature(enable = "sse2")]
#[inline]
fn unsigned(bytes: __m128i) -> [__m128i; 2] {
    let zero = _mm_setzero_si128();
    [
        _mm_unpacklo_epi8(bytes, zero),
        _mm_unpackhi_epi8(bytes, zero),
    ]
}

/// A [`Scale`] in registers; bias and multiplier are those of one block.
#[derive(Clone, Copy)]
struct Requantization {
    bias: [__m128i; 2],
    multiplier: [__m128i; 2],
    pre_shift: __m128i,
    post_shift: __m128i,
    half: __m128i,
    /// The zero point; less 2·128 where a lateral is added.
    offset: __m128i,
    lateral: bool,
}

impl Requantization {
    #[target_feature(enable = "sse2")]
    #[inline]
    fn new(scale: &Scale<'_>) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        Requantization {
            bias: [_mm_setzero_si128(); 2],
            multiplier: [_mm_setzero_si128(); 2],
            pre_shift: _mm_cvtsi32_si128(pre_shift as i32),
            post_shift: _mm_cvtsi32_si128(post_shift as i32),
            half: _mm_set1_epi32(half),
            offset: _mm_set1_epi16((scale.zero_point + lateral) as i16),
            lateral: scale.lateral,
        }
    }

    #[target_feature(enable = "sse2")]
    #[inline]
    fn of_block(&self, scale: &Scale<'_>, block: usize) -> Self {
        let [bias, multiplier] = [scale.bias, scale.multiplier].map(|of| {
            let [a, b, c, d, e, f, g, h] = of.get(block).copied().unwrap_or_default();
            [_mm_setr_epi32(a, b, c, d), _mm_setr_epi32(e, f, g, h)]
        });
        Requantization {
            bias,
            // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
            multiplier: multiplier.map(|m| _mm_and_si128(m, _mm_set1_epi32(0xffff))),
            ..*self
        }
    }

    /// Writes the outputs of the block at a pixel; with `PLAIN`, nothing is added to them.
    ///
    /// # Safety
    /// `out` is valid for eight bytes.
    #[target_feature(enable = "sse2")]
    #[inline]
    unsafe fn store<const PLAIN: bool>(&self, mut sums: [__m128i; 2], out: *mut u8) {
        let constants = self.bias.iter().zip(&self.multiplier);
        for (sum, (bias, multiplier)) in sums.iter_mut().zip(constants) {
            let kept = _mm_sra_epi32(_mm_add_epi32(*sum, *bias), self.pre_shift);
            let scaled = _mm_madd_epi16(kept, *multiplier);
            *sum = _mm_sra_epi32(_mm_add_epi32(scaled, self.half), self.post_shift);
        }
        // What saturates here is clamped below anyway.
        let mut words = _mm_packs_epi32(sums[0], sums[1]);
        let mut offset = self.offset;
        if !PLAIN && self.lateral {
            // SAFETY: as the caller promises.
            let [lateral, _] = unsigned(unsafe { _mm_loadl_epi64(out.cast_const().cast()) });
            offset = _mm_add_epi16(offset, _mm_slli_epi16::<1>(lateral));
        }
        if !PLAIN {
            words = _mm_adds_epi16(words, offset);
        }
        // SAFETY: as the caller promises.
        unsafe { _mm_storel_epi64(out.cast(), _mm_packus_epi16(words, words)) };
    }
}

depthwise3x3_by_block!("sse2");

/// The sums of eight channels from `at` on.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "sse2")]
#[inline]
unsafe fn depthwise8(
    taps: &[*const u8; 10],
    at: usize,
    weights: *const TapWeights,
) -> [__m128i; 2] {
    let mut sums = [_mm_setzero_si128(); 2];
    let mut weights = weights.cast::<__m128i>();
    for pair in taps.as_chunks::<2>().0 {
        // SAFETY: as the caller promises.
        let [first, second] = pair.map(|tap| unsafe { _mm_loadl_epi64(tap.add(at).cast()) });
        for (sum, pairs) in sums
            .iter_mut()
            .zip(unsigned(_mm_unpacklo_epi8(first, second)))
        {
            // SAFETY: as the caller promises.
            let of_pairs = unsafe { _mm_loadu_si128(weights) };
            weights = weights.wrapping_add(1);
            *sum = _mm_add_epi32(*sum, _mm_madd_epi16(pairs, of_pairs));
        }
    }
    sums
}

#[target_feature(enable = "sse2")]
fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
    let (pre_shift, post_shift, half) = sum.shifts();
    let [own, second] = sum.factors.map(|f| f as u16 as u32);
    let factors = _mm_set1_epi32((own | second << 16) as i32);
    let half = _mm_set1_epi32(half);
    let [pre_shift, post_shift] = [pre_shift, post_shift].map(|s| _mm_cvtsi32_si128(s as i32));
    let (vectors, rest) = out.as_chunks_mut::<16>();
    let (others, rest_of_other) = other.as_chunks::<16>();
    for (out, other) in vectors.iter_mut().zip(others) {
        // SAFETY: both are sixteen bytes.
        let [own, other] = [&*out, other].map(|v| unsafe { _mm_loadu_si128(v.as_ptr().cast()) });
        let pairs = [_mm_unpacklo_epi8(own, other), _mm_unpackhi_epi8(own, other)];
        let words = pairs.map(|pairs| {
            let [low, high] = unsigned(pairs).map(|pairs| {
                let sum = _mm_sra_epi32(_mm_madd_epi16(pairs, factors), pre_shift);
                _mm_sra_epi32(_mm_add_epi32(sum, half), post_shift)
            });
            _mm_packs_epi32(low, high)
        });
        // SAFETY: the output is sixteen bytes.
        unsafe {
            _mm_storeu_si128(
                out.as_mut_ptr().cast(),
                _mm_packus_epi16(words[0], words[1]),
            )
        };
    }
    tail::add(sum, rest_of_other, rest);
}

#[target_feature(enable = "sse2")]
fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<16>();
    let (rows, rest_of_row) = weights.as_chunks::<16>();
    let mut sums = [_mm_setzero_si128(); 2];
    for (features, weights) in vectors.iter().zip(rows) {
        // SAFETY: both are sixteen bytes.
        let (features, weights) = unsafe {
            (
                unsigned(_mm_loadu_si128(features.as_ptr().cast())),
                signed(_mm_loadu_si128(weights.as_ptr().cast())),
            )
        };
        for ((sum, features), weights) in sums.iter_mut().zip(features).zip(weights) {
            *sum = _mm_add_epi32(*sum, _mm_madd_epi16(features, weights));
        }
    }
    let sums = _mm_add_epi32(sums[0], sums[1]);
    let sums = _mm_add_epi32(sums, _mm_shuffle_epi32::<0b1110>(sums));
    let sum = _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_shuffle_epi32::<0b01>(sums)));
    sum.wrapping_add(tail::dot(rest, rest_of_row))
}
