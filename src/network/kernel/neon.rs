//! The kernel for AArch64: `smlal` multiplies 16-bit numbers and adds the products to 32-bit sums.

use super::{BLOCK, Kernel, Rows, Scale, Strip, Sum, TapWeights, Tile};
use super::{conv2d_by_block, depthwise3x3_by_block, forwarded, tail, unrolled};
use core::arch::aarch64::*;

#[derive(Clone, Copy)]
pub(in crate::network) struct Neon;

impl Kernel for Neon {
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

/// Pixels of a tile, whose sums fill sixteen of the 32 registers.
const TILE: usize = 8;

conv2d_by_block!("neon");

/// The sums of the pixels of a tile in a block.
///
/// # Safety
/// The strip has this block.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn sums(strip: &Strip<'_>, tile: Tile, block: usize) -> [[int32x4_t; 2]; TILE] {
    let mut sums = [[vdupq_n_s32(0); 2]; TILE];
    let mut weights = strip
        .weights()
        .as_ptr()
        .wrapping_add(block * strip.block_weights());
    for row in strip.rows() {
        let mut window = tile.window.wrapping_add(*row);
        for _ in 0..strip.columns() / 8 {
            let mut values = [vdupq_n_s16(0); TILE];
            unrolled!(p < TILE => {
                // SAFETY: a window has eight two-byte values for each eight columns.
                values[p] = unsafe { vld1q_s16(window.add(p * tile.step).cast()) };
            });
            // SAFETY: a block has 64 weights for each eight columns of each row.
            unsafe {
                multiply::<0, 1>(&mut sums, &values, weights);
                multiply::<2, 3>(&mut sums, &values, weights.add(16));
                multiply::<4, 5>(&mut sums, &values, weights.add(32));
                multiply::<6, 7>(&mut sums, &values, weights.add(48));
            }
            weights = weights.wrapping_add(8 * BLOCK);
            window = window.wrapping_add(16);
        }
    }
    sums
}

/// Multiplies one pair of the values of each pixel by sixteen weights.
///
/// # Safety
/// `weights` is valid for sixteen bytes.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn multiply<const EVEN: i32, const ODD: i32>(
    sums: &mut [[int32x4_t; 2]; TILE],
    values: &[int16x8_t; TILE],
    weights: *const i8,
) {
    // SAFETY: as the caller promises.
    let pairs = vreinterpretq_s16_s8(unsafe { vld1q_s8(weights) });
    let even = vshrq_n_s16::<8>(vshlq_n_s16::<8>(pairs));
    let odd = vshrq_n_s16::<8>(pairs);
    unrolled!(p < TILE => {
        let [low, high] = sums[p];
        let low = vmlal_laneq_s16::<EVEN>(low, vget_low_s16(even), values[p]);
        let high = vmlal_high_laneq_s16::<EVEN>(high, even, values[p]);
        sums[p] = [
            vmlal_laneq_s16::<ODD>(low, vget_low_s16(odd), values[p]),
            vmlal_high_laneq_s16::<ODD>(high, odd, values[p]),
        ];
    });
}

/// A [`Scale`] in registers; bias and multiplier are those of one block.
#[derive(Clone, Copy)]
pub(super) struct Requantization {
    bias: [int32x4_t; 2],
    multiplier: [int16x4_t; 2],
    /// Left shifts by negative numbers, which are right shifts.
    pre_shift: int32x4_t,
    post_shift: int32x4_t,
    half: int32x4_t,
    /// The zero point; less 2·128 where a lateral is added.
    offset: int16x8_t,
    lateral: bool,
}

impl Requantization {
    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) fn new(scale: &Scale<'_>) -> Self {
        let (pre_shift, post_shift, half) = scale.shifts();
        let lateral = if scale.lateral { -256 } else { 0 };
        Requantization {
            bias: [vdupq_n_s32(0); 2],
            multiplier: [vdup_n_s16(0); 2],
            pre_shift: vdupq_n_s32(-(pre_shift as i32)),
            post_shift: vdupq_n_s32(-(post_shift as i32)),
            half: vdupq_n_s32(half),
            offset: vdupq_n_s16((scale.zero_point + lateral) as i16),
            lateral: scale.lateral,
        }
    }

    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) fn of_block(&self, scale: &Scale<'_>, block: usize) -> Self {
        let [bias, multiplier] = [scale.bias, scale.multiplier].map(|of| {
            let [a, b, c, d, e, f, g, h] = of.get(block).copied().unwrap_or_default();
            // SAFETY: reads the four numbers of the array.
            [[a, b, c, d], [e, f, g, h]].map(|v| unsafe { vld1q_s32(v.as_ptr()) })
        });
        Requantization {
            bias,
            multiplier: [vmovn_s32(multiplier[0]), vmovn_s32(multiplier[1])],
            ..*self
        }
    }

    /// Writes the outputs of the block at a pixel.
    ///
    /// # Safety
    /// `out` is valid for eight bytes.
    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) unsafe fn store(&self, mut sums: [int32x4_t; 2], out: *mut u8) {
        unrolled!(half < 2 => {
            let shifted = vshlq_s32(vaddq_s32(sums[half], self.bias[half]), self.pre_shift);
            let scaled = vmlal_s16(self.half, vmovn_s32(shifted), self.multiplier[half]);
            sums[half] = vshlq_s32(scaled, self.post_shift);
        });
        // What saturates here is clamped below anyway.
        let words = vcombine_s16(vqmovn_s32(sums[0]), vqmovn_s32(sums[1]));
        let mut offset = self.offset;
        if self.lateral {
            // SAFETY: as the caller promises.
            let lateral = vshll_n_u8::<1>(unsafe { vld1_u8(out) });
            offset = vaddq_s16(offset, vreinterpretq_s16_u16(lateral));
        }
        // SAFETY: as the caller promises.
        unsafe { vst1_u8(out, vqmovun_s16(vqaddq_s16(words, offset))) };
    }
}

depthwise3x3_by_block!("neon");

/// The sums of eight channels from `at` on.
///
/// # Safety
/// Every tap and the weights have these channels.
#[target_feature(enable = "neon")]
#[inline]
unsafe fn depthwise8(
    taps: &[*const u8; 10],
    at: usize,
    weights: *const TapWeights,
) -> [int32x4_t; 2] {
    let [mut low, mut high] = [vdupq_n_s32(0); 2];
    let weights = weights.cast::<i16>();
    unrolled!(pair < 5 => {
        // SAFETY: as the caller promises.
        let weights = unsafe { vld2q_s16(weights.add(pair * 2 * BLOCK)) };
        let weights = [weights.0, weights.1];
        unrolled!(k < 2 => {
            // The tenth tap has weight 0.
            if pair * 2 + k < 9 {
                // SAFETY: as the caller promises.
                let values = vmovl_u8(unsafe { vld1_u8(taps[pair * 2 + k].add(at)) });
                let values = vreinterpretq_s16_u16(values);
                low = vmlal_s16(low, vget_low_s16(values), vget_low_s16(weights[k]));
                high = vmlal_high_s16(high, values, weights[k]);
            }
        });
    });
    [low, high]
}

#[target_feature(enable = "neon")]
pub(super) fn add(sum: &Sum, other: &[u8], out: &mut [u8]) {
    let (pre_shift, post_shift, half) = sum.shifts();
    let [own_factor, other_factor] = sum.factors;
    let half = vdupq_n_s32(half);
    let [pre_shift, post_shift] = [pre_shift, post_shift].map(|s| vdupq_n_s32(-(s as i32)));
    let (vectors, rest) = out.as_chunks_mut::<8>();
    let (others, rest_of_other) = other.as_chunks::<8>();
    for (out, other) in vectors.iter_mut().zip(others) {
        // SAFETY: both are eight bytes.
        let [own, other] =
            [&*out, other].map(|v| vreinterpretq_s16_u16(vmovl_u8(unsafe { vld1_u8(v.as_ptr()) })));
        let low = vmull_n_s16(vget_low_s16(own), own_factor);
        let low = vmlal_n_s16(low, vget_low_s16(other), other_factor);
        let high = vmull_high_n_s16(own, own_factor);
        let high = vmlal_high_n_s16(high, other, other_factor);
        let [low, high] = [low, high].map(|sum| {
            let sum = vaddq_s32(vshlq_s32(sum, pre_shift), half);
            vqmovn_s32(vshlq_s32(sum, post_shift))
        });
        // SAFETY: the output is eight bytes.
        unsafe { vst1_u8(out.as_mut_ptr(), vqmovun_s16(vcombine_s16(low, high))) };
    }
    tail::add(sum, rest_of_other, rest);
}

#[target_feature(enable = "neon")]
pub(super) fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (vectors, rest) = features.as_chunks::<16>();
    let (rows, rest_of_row) = weights.as_chunks::<16>();
    let mut sums = [vdupq_n_s32(0); 2];
    for (features, weights) in vectors.iter().zip(rows) {
        // SAFETY: both are sixteen bytes.
        let (features, weights) =
            unsafe { (vld1q_u8(features.as_ptr()), vld1q_s8(weights.as_ptr())) };
        let features = [vmovl_u8(vget_low_u8(features)), vmovl_high_u8(features)];
        let weights = [vmovl_s8(vget_low_s8(weights)), vmovl_high_s8(weights)];
        for ((sum, features), weights) in sums.iter_mut().zip(features).zip(weights) {
            let features = vreinterpretq_s16_u16(features);
            *sum = vmlal_s16(*sum, vget_low_s16(features), vget_low_s16(weights));
            *sum = vmlal_high_s16(*sum, features, weights);
        }
    }
    vaddvq_s32(vaddq_s32(sums[0], sums[1])).wrapping_add(tail::dot(rest, rest_of_row))
}
