//! The kernel for x86-64: `pmaddwd` multiplies pairs of 16-bit numbers and adds the products.

use super::{
    BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Line, Scale, Strip, Sum, TapWeights, Tile,
};
use super::{forwarded, tail, unrolled};
use core::arch::x86_64::*;
use core::mem::MaybeUninit;

#[derive(Clone, Copy)]
pub(in crate::network) struct Sse2;

/// Columns that are read together.
const GROUP: usize = 8;
/// Columns of a group of which the others are padding.
const NARROW: usize = 6;
/// Pixels of the largest tile.
const TILE: usize = 4;

impl Kernel for Sse2 {
    const WIDTH: usize = 2;
    const GROUP: usize = GROUP;
    const TILE: usize = TILE;

    fn stage(self, values: &[u8], zero_point: u8, staged: &mut [u8]) {
        stage(values, zero_point, staged);
    }

    fn dots(self, features: &[u8], rows: &[i8], sums: &mut [i32]) {
        // SAFETY: every x86-64 processor has SSE2.
        unsafe { dots(features, rows, sums) }
    }

    forwarded!();
}

// Not inlined: the compiler then computes the loop's end once, and uses vectors. Of known length
// it unrolls them, which saves a fifth.
#[inline(never)]
fn stage(values: &[u8], zero_point: u8, staged: &mut [u8]) {
    const PART: usize = 64;
    let (parts, rest) = values.as_chunks::<PART>();
    let (staged_parts, _) = staged.as_chunks_mut::<{ 2 * PART }>();
    for (part, staged) in parts.iter().zip(staged_parts) {
        tail::widen(part, zero_point, staged);
    }
    let done = 2 * (values.len() - rest.len());
    tail::widen(rest, zero_point, staged.get_mut(done..).unwrap_or(&mut []));
}

/// Tiles of pixels × blocks whose sums fill eight of the sixteen registers: 2×2, and 4×1 for a
/// block that is left.
#[target_feature(enable = "sse2")]
fn conv2d(mut strip: Strip<'_>) {
    let mut wide = Wide([const { MaybeUninit::uninit() }; WIDE_PAIRS]);
    let mut block = 0;
    while let left @ 1.. = strip.blocks().saturating_sub(block) {
        block += match left {
            // The windows of one channel, whose padding takes a fourth of the work.
            1 if strip.filled() <= NARROW => tiles::<NARROW, TILE, 1>(&mut strip, block, &mut wide),
            1 => tiles::<GROUP, TILE, 1>(&mut strip, block, &mut wide),
            _ => tiles::<GROUP, { TILE / 2 }, 2>(&mut strip, block, &mut wide),
        };
    }
}

/// Most pairs of columns, times blocks, whose weights are widened at once: two blocks of 80
/// columns, the most that our models have.
const WIDE_PAIRS: usize = 80;

/// Weights as 16-bit numbers: `[pair of columns][block][8 channels][2]`. SSE2 has no instruction
/// that widens them as it reads them, so that they are widened once for all pixels of a strip.
struct Wide([MaybeUninit<[__m128i; 2]>; WIDE_PAIRS]);

impl Wide {
    /// Widens the weights of `pairs` pairs of columns of `B` blocks, `block_weights` apart.
    ///
    /// # Safety
    /// The weights of these pairs lie from `weights` on.
    #[target_feature(enable = "sse2")]
    #[inline]
    unsafe fn fill<const B: usize>(
        &mut self,
        weights: *const i8,
        block_weights: usize,
        pairs: usize,
    ) {
        let of_pairs = self.0.as_chunks_mut::<B>().0.iter_mut().take(pairs);
        for (pair, wide) in of_pairs.enumerate() {
            for (b, wide) in wide.iter_mut().enumerate() {
                let at = weights.wrapping_add(b * block_weights + pair * 2 * BLOCK);
                // SAFETY: as the caller promises; a pair of columns of a block has 16 weights.
                wide.write(signed(unsafe { _mm_loadu_si128(at.cast()) }));
            }
        }
    }
}

/// All pixels of `B` blocks from `block` on, `P` pixels at a time. Only the first `C` columns of
/// each group have weights. Returns `B`.
#[target_feature(enable = "sse2")]
#[inline]
fn tiles<const C: usize, const P: usize, const B: usize>(
    strip: &mut Strip<'_>,
    block: usize,
    wide: &mut Wide,
) -> usize {
    let (pixels, channels) = (strip.pixels(), strip.channels());
    let pairs = strip.rows().len() * strip.columns() / 2;
    let at_once = pairs * B <= WIDE_PAIRS;
    if at_once {
        let weights = strip
            .weights()
            .as_ptr()
            .wrapping_add(block * strip.block_weights());
        // SAFETY: `conv2d` takes only blocks that the strip has.
        unsafe { wide.fill::<B>(weights, strip.block_weights(), pairs) };
    }
    let scale = *strip.scale();
    let requantization = Requantization::new(&scale);
    let constants: [_; B] = core::array::from_fn(|b| Constants::new(&scale, block + b));
    let mut out = strip.out().as_mut_ptr().wrapping_add(block * BLOCK);
    let mut first = 0;
    while first < pixels {
        let tile = strip.tile(first, P);
        let mut sums = [[[_mm_setzero_si128(); 2]; B]; P];
        // SAFETY: the strip has these blocks, and the outputs of all its blocks at all pixels.
        unsafe {
            if at_once {
                let mut weights = wide.0.as_ptr().cast();
                for row in strip.rows() {
                    let window = tile.window.wrapping_add(*row);
                    let groups = strip.columns() / GROUP;
                    weights =
                        add_products::<C, P, B>(&mut sums, window, tile.step, weights, groups);
                }
            } else {
                add_by_part(&mut sums, strip, tile, block, wide);
            }
            unrolled!(p < P => {
                if p < tile.present {
                    requantization.store::<false, B>(&sums[p], &constants, out);
                    out = out.wrapping_add(channels);
                }
            });
        }
        first += tile.present;
    }
    B
}

/// Adds products as [`add_products`] does, for windows whose weights do not all fit in `wide`.
///
/// # Safety
/// The strip has `B` blocks from `block` on.
#[target_feature(enable = "sse2")]
unsafe fn add_by_part<const P: usize, const B: usize>(
    sums: &mut [[[__m128i; 2]; B]; P],
    strip: &Strip<'_>,
    tile: Tile,
    block: usize,
    wide: &mut Wide,
) {
    const PART: usize = WIDE_PAIRS / 2 * 2 / GROUP;
    let block_weights = strip.block_weights();
    let mut weights = strip.weights().as_ptr().wrapping_add(block * block_weights);
    for row in strip.rows() {
        let mut window = tile.window.wrapping_add(*row);
        let groups = strip.columns() / GROUP;
        for first in (0..groups).step_by(PART) {
            let part = PART.min(groups - first);
            // SAFETY: a block has the weights, and a window the values, of all columns.
            unsafe {
                wide.fill::<B>(weights, block_weights, part * GROUP / 2);
                let weights = wide.0.as_ptr().cast();
                add_products::<GROUP, P, B>(sums, window, tile.step, weights, part);
            }
            weights = weights.wrapping_add(part * GROUP * BLOCK);
            window = window.wrapping_add(part * GROUP * 2);
        }
    }
}

/// Multiplies the groups of values of the windows of `P` pixels, `step` bytes apart, by the
/// weights of `B` blocks, and adds the products of the first `C` columns of each group. Returns
/// where the next group's weights are.
///
/// # Safety
/// The windows have these groups, and from `weights` on there are their weights as [`Wide`] has
/// them.
#[target_feature(enable = "sse2")]
#[inline]
unsafe fn add_products<const C: usize, const P: usize, const B: usize>(
    sums: &mut [[[__m128i; 2]; B]; P],
    window: *const u8,
    step: usize,
    mut weights: *const __m128i,
    groups: usize,
) -> *const __m128i {
    let mut totals = *sums;
    for group in 0..groups {
        let mut values = [_mm_setzero_si128(); P];
        unrolled!(p < P => {
            let at = window.wrapping_add(p * step + group * 2 * GROUP);
            // SAFETY: a group is eight two-byte values.
            values[p] = unsafe { _mm_loadu_si128(at.cast()) };
        });
        // SAFETY: there are the weights of four pairs for each group.
        unsafe {
            weights = multiply::<0b00_00_00_00, P, B>(&mut totals, &values, weights);
            weights = multiply::<0b01_01_01_01, P, B>(&mut totals, &values, weights);
            weights = multiply::<0b10_10_10_10, P, B>(&mut totals, &values, weights);
            weights = match C {
                NARROW => weights.wrapping_add(2 * B),
                _ => multiply::<0b11_11_11_11, P, B>(&mut totals, &values, weights),
            };
        }
    }
    *sums = totals;
    weights
}

/// Multiplies one pair of the values of each pixel, which `PAIR` copies to all places, by the
/// weights of `B` blocks. Returns where the next pair's weights are.
///
/// # Safety
/// `weights` is valid for `2·B` vectors.
#[target_feature(enable = "sse2")]
#[inline]
unsafe fn multiply<const PAIR: i32, const P: usize, const B: usize>(
    sums: &mut [[[__m128i; 2]; B]; P],
    values: &[__m128i; P],
    weights: *const __m128i,
) -> *const __m128i {
    unrolled!(p < P => {
        let pair = _mm_shuffle_epi32::<PAIR>(values[p]);
        unrolled!(b < B => {
            let [low, high] = sums[p][b];
            // SAFETY: as the caller promises.
            let weights = unsafe { [*weights.add(2 * b), *weights.add(2 * b + 1)] };
            sums[p][b] = [
                _mm_add_epi32(low, _mm_madd_epi16(pair, weights[0])),
                _mm_add_epi32(high, _mm_madd_epi16(pair, weights[1])),
            ];
        });
    });
    weights.wrapping_add(2 * B)
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

/// What a [`Scale`] says of all blocks, in registers.
struct Requantization {
    pre_shift: __m128i,
    post_shift: __m128i,
    half: __m128i,
    /// The zero point; less 2·128 where a lateral is added.
    offset: __m128i,
    lateral: bool,
}

/// What a [`Scale`] says of one block.
#[derive(Clone, Copy)]
struct Constants {
    bias: [__m128i; 2],
    multiplier: [__m128i; 2],
}

impl Constants {
    #[target_feature(enable = "sse2")]
    #[inline]
    fn new(scale: &Scale<'_>, block: usize) -> Self {
        let [bias, multiplier] = [scale.bias, scale.multiplier].map(|of| {
            let [a, b, c, d, e, f, g, h] = of.get(block).copied().unwrap_or_default();
            [_mm_setr_epi32(a, b, c, d), _mm_setr_epi32(e, f, g, h)]
        });
        Constants {
            bias,
            // Only the lower 16 bits of each factor are multiplied: the upper ones meet zeros.
            multiplier: multiplier.map(|m| _mm_and_si128(m, _mm_set1_epi32(0xffff))),
        }
    }
}

impl Requantization {
    #[target_feature(enable = "sse2")]
    #[inline]
    fn new(scale: &Scale<'_>) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        Requantization {
            pre_shift: _mm_cvtsi32_si128(pre_shift as i32),
            post_shift: _mm_cvtsi32_si128(post_shift as i32),
            half: _mm_set1_epi32(half),
            offset: _mm_set1_epi16((scale.zero_point + lateral) as i16),
            lateral: scale.lateral,
        }
    }

    /// Writes the outputs of one or two blocks at a pixel; with `PLAIN`, nothing is added to them.
    ///
    /// # Safety
    /// `out` is valid for eight bytes of each block.
    #[target_feature(enable = "sse2")]
    #[inline]
    unsafe fn store<const PLAIN: bool, const B: usize>(
        &self,
        sums: &[[__m128i; 2]; B],
        constants: &[Constants; B],
        out: *mut u8,
    ) {
        let mut words = [_mm_setzero_si128(); 2];
        for ((words, sums), constants) in words.iter_mut().zip(sums).zip(constants) {
            let [low, high] = self.scaled(*sums, constants);
            // What saturates here is clamped below anyway.
            *words = _mm_packs_epi32(low, high);
        }
        if !PLAIN {
            let mut offsets = [self.offset; 2];
            if self.lateral {
                // SAFETY: as the caller promises.
                let lateral = unsafe {
                    match B {
                        1 => _mm_loadl_epi64(out.cast_const().cast()),
                        _ => _mm_loadu_si128(out.cast_const().cast()),
                    }
                };
                for (offset, lateral) in offsets.iter_mut().zip(unsigned(lateral)) {
                    *offset = _mm_add_epi16(*offset, _mm_slli_epi16::<1>(lateral));
                }
            }
            for (words, offset) in words.iter_mut().zip(offsets) {
                *words = _mm_adds_epi16(*words, offset);
            }
        }
        let bytes = _mm_packus_epi16(words[0], words[1]);
        // SAFETY: as the caller promises.
        unsafe {
            match B {
                1 => _mm_storel_epi64(out.cast(), bytes),
                _ => _mm_storeu_si128(out.cast(), bytes),
            }
        };
    }

    /// The sums of a block, scaled.
    #[target_feature(enable = "sse2")]
    #[inline]
    fn scaled(&self, sums: [__m128i; 2], constants: &Constants) -> [__m128i; 2] {
        let mut scaled = sums;
        let constants = constants.bias.iter().zip(&constants.multiplier);
        for (sum, (bias, multiplier)) in scaled.iter_mut().zip(constants) {
            let kept = _mm_sra_epi32(_mm_add_epi32(*sum, *bias), self.pre_shift);
            let product = _mm_madd_epi16(kept, *multiplier);
            *sum = _mm_sra_epi32(_mm_add_epi32(product, self.half), self.post_shift);
        }
        scaled
    }
}

/// Eight channels of all pixels, then the next eight.
#[target_feature(enable = "sse2")]
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
        let constants = [Constants::new(scale, block)];
        let at = block * BLOCK;
        for (rows, out) in input.rows(out) {
            let pixels = out.len() / channels.max(1);
            let inner = rows.inner(pixels);
            let out = out.as_mut_ptr().wrapping_add(at);
            for x in (0..inner.start).chain(inner.end..pixels) {
                let taps = rows.tap_starts(x);
                // SAFETY: every tap has all channels, as have the outputs of every pixel.
                unsafe {
                    let sums = depthwise8(weights, |k| taps[k].add(at));
                    requantization.store::<true, 1>(&[sums], &constants, out.add(x * channels));
                }
            }
            let out = out.wrapping_add(inner.start * channels);
            let lines = rows.lines(inner.start).map(|line| line.at_channel(at));
            // SAFETY: as above.
            unsafe {
                inner_pixels(
                    lines,
                    inner.len(),
                    weights,
                    &requantization,
                    &constants,
                    (out, channels),
                )
            };
        }
    }
}

/// The outputs of a block at `pixels` neighbouring pixels.
///
/// # Safety
/// There are taps and outputs of the block at each; outputs are `channels` bytes apart.
// Not inlined: too few registers would be left for the pointers.
#[target_feature(enable = "sse2")]
#[inline(never)]
unsafe fn inner_pixels(
    mut lines: [Line; 3],
    pixels: usize,
    weights: &TapWeights,
    requantization: &Requantization,
    constants: &[Constants; 1],
    (mut out, channels): (*mut u8, usize),
) {
    for _ in 0..pixels {
        // SAFETY: as the caller promises.
        unsafe {
            let sums = depthwise8(weights, |k| lines[k / 3].tap(k % 3));
            requantization.store::<true, 1>(&[sums], constants, out);
        }
        unrolled!(k < 3 => { lines[k].advance() });
        out = out.wrapping_add(channels);
    }
}

/// The sums of eight channels, from their nine taps.
///
/// # Safety
/// Every tap is valid for eight bytes.
#[target_feature(enable = "sse2")]
#[inline]
unsafe fn depthwise8(weights: &TapWeights, tap: impl Fn(usize) -> *const u8) -> [__m128i; 2] {
    let mut sums = [_mm_setzero_si128(); 2];
    unrolled!(pair < 5 => {
        // SAFETY: as the caller promises.
        let first = unsafe { _mm_loadl_epi64(tap(2 * pair).cast()) };
        // The tenth tap is 0.
        let second = match pair {
            4 => _mm_setzero_si128(),
            // SAFETY: as the caller promises.
            _ => unsafe { _mm_loadl_epi64(tap(2 * pair + 1).cast()) },
        };
        let values = unsigned(_mm_unpacklo_epi8(first, second));
        let of_pair = weights[pair].as_ptr().cast::<__m128i>();
        // SAFETY: a pair of taps has sixteen weights.
        let weights = unsafe { [_mm_loadu_si128(of_pair), _mm_loadu_si128(of_pair.add(1))] };
        for ((sum, values), weights) in sums.iter_mut().zip(values).zip(weights) {
            *sum = _mm_add_epi32(*sum, _mm_madd_epi16(values, weights));
        }
    });
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
    let [sum] = dot_with(features, [weights]);
    sum
}

/// The products with `R` rows of weights, for which the features are widened once.
#[target_feature(enable = "sse2")]
#[inline]
fn dot_with<const R: usize>(features: &[u8], rows: [&[i8]; R]) -> [i32; R] {
    let (vectors, rest) = features.as_chunks::<16>();
    let rows = rows.map(|row| row.as_chunks::<16>());
    let mut sums = [[_mm_setzero_si128(); 2]; R];
    for (k, features) in vectors.iter().enumerate() {
        // SAFETY: sixteen bytes.
        let features = unsafe { unsigned(_mm_loadu_si128(features.as_ptr().cast())) };
        unrolled!(r < R => {
            if let Some(weights) = rows[r].0.get(k) {
                // SAFETY: sixteen bytes.
                let weights = unsafe { signed(_mm_loadu_si128(weights.as_ptr().cast())) };
                unrolled!(h < 2 => {
                    let products = _mm_madd_epi16(features[h], weights[h]);
                    sums[r][h] = _mm_add_epi32(sums[r][h], products);
                });
            }
        });
    }
    let mut rows = rows.iter();
    sums.map(|[low, high]| {
        let sums = _mm_add_epi32(low, high);
        let sums = _mm_add_epi32(sums, _mm_shuffle_epi32::<0b1110>(sums));
        let sum = _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_shuffle_epi32::<0b01>(sums)));
        let rest_of_row = rows.next().map_or(&[][..], |(_, rest)| rest);
        sum.wrapping_add(tail::dot(rest, rest_of_row))
    })
}

#[target_feature(enable = "sse2")]
fn dots(features: &[u8], rows: &[i8], sums: &mut [i32]) {
    let mut rows = rows.chunks_exact(features.len().max(1));
    let present = rows.len().min(sums.len());
    let (fours, rest) = sums
        .get_mut(..present)
        .unwrap_or(&mut [])
        .as_chunks_mut::<4>();
    for sums in fours {
        let [Some(a), Some(b), Some(c), Some(d)] = [(); 4].map(|()| rows.next()) else {
            return;
        };
        *sums = dot_with(features, [a, b, c, d]);
    }
    for (sum, row) in rest.iter_mut().zip(rows) {
        *sum = dot(features, row);
    }
}
