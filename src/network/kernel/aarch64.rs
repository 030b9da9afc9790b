//! What the kernels for AArch64 share.
//!
//! Values x are multiplied as x − 128, which fits a signed byte; the bias makes up for it:
//! Σ w·(x − z) = Σ w·(x − 128) + (128 − z)·Σ w, where z is the zero point.

use super::{BLOCK, DepthwiseInput, DepthwiseWeights, Scale, Sum, tail, unrolled};
use core::arch::aarch64::*;
use core::arch::asm;
use core::array;

/// Flips the sign bit: x − 128 as a signed byte.
pub(super) const SIGN: u8 = 128;

/// The methods of [`Kernel`](super::Kernel) for values that are staged as signed bytes.
macro_rules! signed_bytes {
    () => {
        const WIDTH: usize = 1;
        const GROUP: usize = 8;
        const TILE: usize = 8;
        const PAIRED: bool = false;

        fn stage(self, values: &[u8], _zero_point: u8, staged: &mut [u8]) {
            $crate::network::kernel::aarch64::stage(values, staged);
        }

        fn padding(self, zero_point: u8) -> u8 {
            zero_point ^ SIGN
        }

        fn correct(self, weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
            $crate::network::kernel::aarch64::correct(weights, zero_point, bias);
        }
    };
}
pub(super) use signed_bytes;

/// Adds to each block's bias what its values lack.
pub(super) fn correct(weights: &[i8], zero_point: u8, bias: &mut [[i32; BLOCK]]) {
    let lack = i32::from(SIGN) - i32::from(zero_point);
    let blocks = weights.chunks_exact((weights.len() / bias.len().max(1)).max(1));
    for (bias, weights) in bias.iter_mut().zip(blocks) {
        for (bias, sum) in bias.iter_mut().zip(sums_of(weights)) {
            *bias = bias.wrapping_add(lack * sum);
        }
    }
}

/// The sum of each channel's weights, `[pair of columns][8 channels][2]`.
fn sums_of(weights: &[i8]) -> [i32; BLOCK] {
    let mut out = [0; BLOCK];
    // SAFETY: every AArch64 processor has NEON. Reads are of sixteen weights, writes of four sums.
    unsafe {
        let [mut low, mut high] = [vdupq_n_s32(0); 2];
        for pairs in weights.as_chunks::<{ 2 * BLOCK }>().0 {
            let pairs = vpaddlq_s8(vld1q_s8(pairs.as_ptr()));
            low = vaddw_s16(low, vget_low_s16(pairs));
            high = vaddw_high_s16(high, pairs);
        }
        vst1q_s32(out.as_mut_ptr(), low);
        vst1q_s32(out.as_mut_ptr().add(4), high);
    }
    out
}

// Not inlined: the compiler then computes the loop's end once, and uses vectors.
#[inline(never)]
pub(super) fn stage(values: &[u8], staged: &mut [u8]) {
    for (out, value) in staged.iter_mut().zip(values) {
        *out = value ^ SIGN;
    }
}

/// A [`Scale`] in registers, but for the bias, with which the sums start; the multiplier is that of
/// one block.
#[derive(Clone, Copy)]
pub(super) struct Requantization {
    multiplier: int16x8_t,
    /// Left shifts by negative numbers, which are right shifts.
    pre_shift: int32x4_t,
    post_shift: int32x4_t,
    /// The zero point; less 2·128 where a lateral is added.
    offset: int16x8_t,
    lateral: bool,
}

impl Requantization {
    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) fn new(scale: &Scale<'_>) -> Self {
        let (pre_shift, post_shift, _) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        Requantization {
            multiplier: vdupq_n_s16(0),
            pre_shift: vdupq_n_s32(-(pre_shift as i32)),
            post_shift: vdupq_n_s32(-(post_shift as i32)),
            offset: vdupq_n_s16((scale.zero_point + lateral) as i16),
            lateral: scale.lateral,
        }
    }

    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) fn of_block(&self, scale: &Scale<'_>, block: usize) -> Self {
        let [low, high] = halves(scale.multiplier, block);
        Requantization {
            multiplier: lower_words(low, high),
            ..*self
        }
    }

    /// The words of eight sums, before what is added to the scaled ones.
    #[target_feature(enable = "neon")]
    #[inline]
    fn scaled(&self, sums: [int32x4_t; 2]) -> int16x8_t {
        let [low, high] = sums.map(|sum| vshlq_s32(sum, self.pre_shift));
        let words = lower_words(low, high);
        let low = vmull_s16(vget_low_s16(words), vget_low_s16(self.multiplier));
        let high = smull2_words(words, self.multiplier);
        // The shift rounds. What saturates here is clamped below anyway.
        let [low, high] = [low, high].map(|sum| vrshlq_s32(sum, self.post_shift));
        vqmovn_high_s32(vqmovn_s32(low), high)
    }

    /// Writes the outputs of the block at a pixel; with `PLAIN`, nothing is added to them.
    ///
    /// # Safety
    /// `out` is valid for eight bytes.
    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) unsafe fn store<const PLAIN: bool>(&self, sums: [int32x4_t; 2], out: *mut u8) {
        let mut words = self.scaled(sums);
        if !PLAIN {
            words = vqaddq_s16(words, self.offset);
        }
        if !PLAIN && self.lateral {
            // SAFETY: as the caller promises.
            let lateral = vshll_n_u8::<1>(unsafe { vld1_u8(out) });
            words = vqaddq_s16(words, vreinterpretq_s16_u16(lateral));
        }
        // SAFETY: as the caller promises.
        unsafe { vst1_u8(out, vqmovun_s16(words)) };
    }
}

/// The eight numbers of a block, zeros where there is none.
#[target_feature(enable = "neon")]
#[inline]
pub(super) fn halves(of: &[[i32; BLOCK]], block: usize) -> [int32x4_t; 2] {
    let [a, b, c, d, e, f, g, h] = of.get(block).copied().unwrap_or_default();
    // SAFETY: reads the four numbers of the array.
    [[a, b, c, d], [e, f, g, h]].map(|v| unsafe { vld1q_s32(v.as_ptr()) })
}

/// The lower 16 bits of eight numbers.
#[target_feature(enable = "neon")]
#[inline]
fn lower_words(low: int32x4_t, high: int32x4_t) -> int16x8_t {
    vuzp1q_s16(vreinterpretq_s16_s32(low), vreinterpretq_s16_s32(high))
}

/// Two blocks of channels at a time, and in these pixel by pixel, so that the weights stay in
/// registers.
#[target_feature(enable = "neon")]
pub(super) fn depthwise3x3(
    input: DepthwiseInput<'_>,
    weights: &DepthwiseWeights<'_>,
    scale: &Scale<'_>,
    out: &mut [u8],
) {
    let blocks = input.channels() / BLOCK;
    if weights.raw.len() < 9 * input.channels() {
        return;
    }
    for block in (0..blocks).step_by(2) {
        // SAFETY: the weights have nine taps of all channels.
        unsafe {
            match block + 1 < blocks {
                true => depthwise_blocks::<true>(input, weights.raw, scale, block, out),
                false => depthwise_blocks::<false>(input, weights.raw, scale, block, out),
            }
        }
    }
}

/// The outputs of a block, and of the next one where `TWO` are wanted.
///
/// # Safety
/// The input has these blocks, and there are nine weights of each of its channels.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn depthwise_blocks<const TWO: bool>(
    input: DepthwiseInput<'_>,
    weights: &[i8],
    scale: &Scale<'_>,
    block: usize,
    out: &mut [u8],
) {
    let (channels, at) = (input.channels(), block * BLOCK);
    let requantization = Requantization::new(scale);
    let requantizations = [block, block + 1].map(|b| requantization.of_block(scale, b));
    let [first, second] = [block, block + 1].map(|b| halves(scale.bias, b));
    // SAFETY: the caller promises the weights, and every output pixel has all channels.
    unsafe {
        let weights = Taps::read::<TWO>(weights.as_ptr().add(at), channels);
        let bias = weights.bias([first[0], first[1], second[0], second[1]]);
        for (rows, out) in input.rows(out) {
            let pixels = out.len() / channels.max(1);
            let out = out.as_mut_ptr().add(at);
            let store = |[a, b, c, d]: [int32x4_t; 4], x: usize| {
                let out = out.add(x * channels);
                requantizations[0].store::<true>([a, b], out);
                if TWO {
                    requantizations[1].store::<true>([c, d], out.add(BLOCK));
                }
            };
            let inner = rows.inner(pixels);
            for x in (0..inner.start).chain(inner.end..pixels) {
                let taps = rows.tap_starts(x);
                store(weights.sums::<TWO>(bias, |k| taps[k].add(at)), x);
            }
            let mut lines = rows.lines(inner.start);
            for x in inner {
                let tap = |k: usize| lines[k / 3].tap(k % 3).add(at);
                store(weights.sums::<TWO>(bias, tap), x);
                unrolled!(k < 3 => { lines[k].advance() });
            }
        }
    }
}

/// The nine weights of each of sixteen channels.
#[derive(Clone, Copy)]
struct Taps([int8x16_t; 9]);

impl Taps {
    /// Reads the weights of eight channels, or `TWO` times as many; those of the next tap are
    /// `channels` further on.
    ///
    /// # Safety
    /// They are there.
    #[target_feature(enable = "neon")]
    #[inline]
    unsafe fn read<const TWO: bool>(weights: *const i8, channels: usize) -> Self {
        let mut taps = [vdupq_n_s8(0); 9];
        for (k, tap) in taps.iter_mut().enumerate() {
            // SAFETY: as the caller promises.
            let bytes = unsafe { bytes::<TWO>(weights.add(k * channels).cast()) };
            *tap = vreinterpretq_s8_u8(bytes);
        }
        Taps(taps)
    }

    /// The bias for values that are less by [`SIGN`].
    #[target_feature(enable = "neon")]
    #[inline]
    fn bias(&self, bias: [int32x4_t; 4]) -> [int32x4_t; 4] {
        let [mut low, mut high] = [vdupq_n_s16(0); 2];
        for weights in self.0 {
            low = vaddw_s8(low, vget_low_s8(weights));
            high = vaddw_high_s8(high, weights);
        }
        // 9·128·128 takes 18 bits.
        let added = [
            vshll_n_s16::<7>(vget_low_s16(low)),
            vshll_high_n_s16::<7>(low),
            vshll_n_s16::<7>(vget_low_s16(high)),
            vshll_high_n_s16::<7>(high),
        ];
        core::array::from_fn(|k| vaddq_s32(bias[k], added[k]))
    }

    /// The sums of the channels whose values are at `tap(0)` to `tap(8)`.
    ///
    /// # Safety
    /// There are eight bytes at each, or `TWO` times as many.
    #[target_feature(enable = "neon")]
    #[inline]
    unsafe fn sums<const TWO: bool>(
        &self,
        mut sums: [int32x4_t; 4],
        tap: impl Fn(usize) -> *const u8,
    ) -> [int32x4_t; 4] {
        let value = |k| {
            // SAFETY: as the caller promises.
            let bytes = unsafe { bytes::<TWO>(tap(k)) };
            vreinterpretq_s8_u8(veorq_u8(bytes, vdupq_n_u8(SIGN)))
        };
        unrolled!(pair < 5 => {
            let (values, weights) = (value(2 * pair), self.0[2 * pair]);
            let mut low = vmull_s8(vget_low_s8(values), vget_low_s8(weights));
            let mut high = smull2_bytes(values, weights);
            if pair < 4 {
                // Two products fit 16 bits, as no weight is −128.
                let (values, weights) = (value(2 * pair + 1), self.0[2 * pair + 1]);
                low = vmlal_s8(low, vget_low_s8(values), vget_low_s8(weights));
                high = smlal2_bytes(high, values, weights);
            }
            sums[0] = vaddw_s16(sums[0], vget_low_s16(low));
            sums[1] = vaddw_high_s16(sums[1], low);
            sums[2] = vaddw_s16(sums[2], vget_low_s16(high));
            sums[3] = vaddw_high_s16(sums[3], high);
        });
        sums
    }
}

/// Reads eight bytes and adds as many zeros, or reads `TWO` times as many.
///
/// # Safety
/// They are there.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn bytes<const TWO: bool>(from: *const u8) -> uint8x16_t {
    // SAFETY: as the caller promises.
    unsafe {
        match TWO {
            true => vld1q_u8(from),
            false => vcombine_u8(vld1_u8(from), vdup_n_u8(0)),
        }
    }
}

/// Products of the lower or upper halves, alone or added to sums. The compiler would keep the upper
/// half of what a loop does not change in a register of its own, and there are too few. It would
/// also widen bytes to 32 bits before it multiplies them.
macro_rules! products {
    ($name:ident: $from:ty, $to:ty, $instruction:literal) => {
        #[target_feature(enable = "neon")]
        #[inline]
        pub(super) fn $name(a: $from, b: $from) -> $to {
            let products: $to;
            // SAFETY: the instruction reads and writes only these registers.
            unsafe {
                asm!(
                    $instruction,
                    out = lateout(vreg) products,
                    a = in(vreg) a,
                    b = in(vreg) b,
                    options(pure, nomem, nostack, preserves_flags),
                );
            }
            products
        }
    };
    (+ $name:ident: $from:ty, $to:ty, $instruction:literal) => {
        #[target_feature(enable = "neon")]
        #[inline]
        pub(super) fn $name(mut sums: $to, a: $from, b: $from) -> $to {
            // SAFETY: the instruction reads and writes only these registers.
            unsafe {
                asm!(
                    $instruction,
                    out = inout(vreg) sums,
                    a = in(vreg) a,
                    b = in(vreg) b,
                    options(pure, nomem, nostack, preserves_flags),
                );
            }
            sums
        }
    };
}

products!(smull2_bytes: int8x16_t, int16x8_t, "smull2 {out:v}.8h, {a:v}.16b, {b:v}.16b");
products!(+ smlal2_bytes: int8x16_t, int16x8_t, "smlal2 {out:v}.8h, {a:v}.16b, {b:v}.16b");
products!(smull_words: int16x8_t, int32x4_t, "smull {out:v}.4s, {a:v}.4h, {b:v}.4h");
products!(smull2_words: int16x8_t, int32x4_t, "smull2 {out:v}.4s, {a:v}.8h, {b:v}.8h");
products!(+ smlal_words: int16x8_t, int32x4_t, "smlal {out:v}.4s, {a:v}.4h, {b:v}.4h");
products!(+ smlal2_words: int16x8_t, int32x4_t, "smlal2 {out:v}.4s, {a:v}.8h, {b:v}.8h");

#[target_feature(enable = "neon")]
pub(super) fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
    let (pre_shift, post_shift, _) = sum.shifts();
    let factors = sum.factors.map(|f| vdupq_n_s16(f));
    let shifts = [pre_shift, post_shift].map(|s| vdupq_n_s32(-(s as i32)));
    let (vectors, rest) = out.as_chunks_mut::<8>();
    let (others, rest_of_other) = other.as_chunks::<8>();
    // Each sum needs ten instructions, one after the other: in-order cores want several at a time.
    let (fours, vectors) = vectors.as_chunks_mut::<4>();
    let (other_fours, others) = others.as_chunks::<4>();
    for (out, other) in fours.iter_mut().zip(other_fours) {
        add_vectors(factors, shifts, other, out);
    }
    for (out, other) in vectors.iter_mut().zip(others) {
        add_vectors(factors, shifts, &[*other], array::from_mut(out));
    }
    tail::add(sum, rest_of_other, rest);
}

/// Adds eight values `N` times.
#[target_feature(enable = "neon")]
#[inline]
fn add_vectors<const N: usize>(
    [own_factor, other_factor]: [int16x8_t; 2],
    [pre_shift, post_shift]: [int32x4_t; 2],
    other: &[[u8; 8]; N],
    out: &mut [[u8; 8]; N],
) {
    let mut sums = [[vdupq_n_s32(0); 2]; N];
    unrolled!(n < N => {
        // SAFETY: both are eight bytes.
        let [own, other] = [&out[n], &other[n]]
            .map(|v| vreinterpretq_s16_u16(vmovl_u8(unsafe { vld1_u8(v.as_ptr()) })));
        let low = smlal_words(smull_words(own, own_factor), other, other_factor);
        let high = smlal2_words(smull2_words(own, own_factor), other, other_factor);
        sums[n] = [low, high];
    });
    // The second shift rounds.
    let sums = sums
        .map(|sums| sums.map(|sum| vqmovn_s32(vrshlq_s32(vshlq_s32(sum, pre_shift), post_shift))));
    for (out, [low, high]) in out.iter_mut().zip(sums) {
        // SAFETY: the output is eight bytes.
        unsafe { vst1_u8(out.as_mut_ptr(), vqmovun_s16(vcombine_s16(low, high))) };
    }
}
