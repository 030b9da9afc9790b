//! Inner loops of the network: nearly all time of a step is spent here. The SIMD versions for
//! x86-64 and AArch64 give the same integers as the portable code, which the other machines run.

// SIMD kernels are one of the places where `unsafe` is allowed.
#![allow(unsafe_code)]

#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(any(test, not(any(target_arch = "x86_64", target_arch = "aarch64"))))]
mod portable;
#[cfg(target_arch = "x86_64")]
mod sse2;

/// Output channels computed together.
pub(super) const BLOCK: usize = 8;
/// Output pixels computed together, so that weights are read once for all of them.
pub(super) const TILE: usize = 4;
/// Pairs of taps of a 3×3 window: nine taps and one of weight 0.
pub(super) const TAP_PAIRS: usize = 5;

/// Requantisation of a block of sums to bytes:
/// `((((sum + bias) >> pre_shift)·multiplier + half) >> post_shift) + zero_point`, clamped to
/// 0..255, with `half = 1 << (post_shift − 1)`. The shifted sum and the multiplier are cut to 16
/// bits; in a valid model they fit.
#[derive(Clone, Copy)]
pub(super) struct Scale<'a> {
    pub bias: &'a [i32; BLOCK],
    pub multiplier: &'a [i32; BLOCK],
    pub pre_shift: u32,
    pub post_shift: u32,
    pub zero_point: i32,
}

/// A block of a lateral map that adds nothing.
pub(super) const NO_LATERAL: [u8; BLOCK] = [128; BLOCK];

/// Inputs of [`TILE`] output pixels.
pub(super) struct Tile<'a> {
    /// The input window of each pixel (im2col), all of the same even length.
    pub columns: [&'a [i16]; TILE],
    /// A block of the lateral map at each pixel.
    pub lateral: [&'a [u8; BLOCK]; TILE],
}

// The portable code computes one pixel after the other.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
impl<'a> Tile<'a> {
    /// The windows, two columns of each pixel at a time.
    #[inline]
    fn pairs(&self) -> impl Iterator<Item = [&'a [i16; 2]; TILE]> + use<'a> {
        let [a, b, c, d] = self.columns.map(|columns| columns.as_chunks::<2>().0);
        let pairs = a.iter().zip(b).zip(c.iter().zip(d));
        pairs.map(|((a, b), (c, d))| [a, b, c, d])
    }
}

/// The taps of a 3×3 window, in pairs.
pub(super) type Taps<'a> = [[&'a [u8; BLOCK]; 2]; TAP_PAIRS];
/// The weights of the taps: `[pair][channel][2]`.
pub(super) type TapWeights = [[i16; 2 * BLOCK]; TAP_PAIRS];

/// Full convolution, a block of channels for each pixel of a tile:
/// `Σₖ columns[k]·weights[k/2][channel][k%2]`, requantised, plus `2·(lateral − 128)`.
/// `weights` holds [`BLOCK`] channels for each pair of columns.
#[inline]
pub(super) fn conv2d(tile: &Tile<'_>, weights: &[i16], scale: &Scale<'_>) -> [[u8; BLOCK]; TILE] {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: SSE2 is part of x86-64.
    return unsafe { sse2::conv2d(tile, weights, scale) };
    #[cfg(target_arch = "aarch64")]
    // SAFETY: NEON is part of AArch64 with an operating system's floats, which its targets name.
    return unsafe { neon::conv2d(tile, weights, scale) };
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    portable::conv2d(tile, weights, scale)
}

/// Depthwise 3×3 convolution of a block of channels at one pixel.
#[inline]
pub(super) fn depthwise3x3(
    taps: &Taps<'_>,
    weights: &TapWeights,
    scale: &Scale<'_>,
) -> [u8; BLOCK] {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: SSE2 is part of x86-64.
    return unsafe { sse2::depthwise3x3(taps, weights, scale) };
    #[cfg(target_arch = "aarch64")]
    // SAFETY: as above.
    return unsafe { neon::depthwise3x3(taps, weights, scale) };
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    portable::depthwise3x3(taps, weights, scale)
}

/// `Σ feature·weight`.
#[inline]
pub(crate) fn dot(features: &[u8], weights: &[i8]) -> i32 {
    let (blocks, rest) = features.as_chunks::<{ 2 * BLOCK }>();
    let (rows, rest_of_row) = weights.as_chunks::<{ 2 * BLOCK }>();
    let tail = rest.iter().zip(rest_of_row);
    let tail: i32 = tail.map(|(f, w)| *f as i32 * *w as i32).sum();
    #[cfg(target_arch = "x86_64")]
    // SAFETY: SSE2 is part of x86-64.
    return tail + unsafe { sse2::dot(blocks, rows) };
    #[cfg(target_arch = "aarch64")]
    // SAFETY: as above.
    return tail + unsafe { neon::dot(blocks, rows) };
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    return tail + portable::dot(blocks, rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(k: usize) -> i16 {
        ((k * 7919 + 13) % 511) as i16 - 255
    }

    fn bytes(k: usize) -> [u8; BLOCK] {
        core::array::from_fn(|i| noise(k * BLOCK + i).unsigned_abs() as u8)
    }

    const BIAS: [i32; BLOCK] = [0, 1000, -1000, 30_000, -200_000, 7, 123_456, -8];
    const MULTIPLIER: [i32; BLOCK] = [32_767, 1, 0, 12_345, 20_000, 30_000, 999, -400];

    fn scales() -> impl Iterator<Item = Scale<'static>> {
        let shifts = [(0, 1), (4, 14), (6, 18), (12, 30)];
        shifts.into_iter().flat_map(|(pre_shift, post_shift)| {
            [0, 128].map(|zero_point| Scale {
                bias: &BIAS,
                multiplier: &MULTIPLIER,
                pre_shift,
                post_shift,
                zero_point,
            })
        })
    }

    #[test]
    fn convolutions_agree() {
        let columns: [[i16; 26]; TILE] =
            core::array::from_fn(|p| core::array::from_fn(|k| noise(k + 100 * p)));
        let columns = columns.each_ref().map(|c| &c[..]);
        let weights: [i16; 26 * BLOCK] = core::array::from_fn(|k| noise(k + 7) / 2);
        let lateral: [[u8; BLOCK]; TILE] = core::array::from_fn(bytes);
        for scale in scales() {
            for lateral in [lateral, [NO_LATERAL; TILE]] {
                let lateral = lateral.each_ref();
                let tile = Tile { columns, lateral };
                assert_eq!(
                    conv2d(&tile, &weights, &scale),
                    portable::conv2d(&tile, &weights, &scale)
                );
            }
        }
        // One case against plain arithmetic.
        let plain = Scale {
            bias: &[0; BLOCK],
            multiplier: &[1 << 10; BLOCK],
            pre_shift: 4,
            post_shift: 16,
            zero_point: 128,
        };
        let lateral = [&NO_LATERAL; TILE];
        let out = conv2d(&Tile { columns, lateral }, &weights, &plain);
        let sum = |p: usize| -> i32 {
            let one = |k: usize| columns[p][k] as i32 * weights[k / 2 * 16 + k % 2] as i32;
            (0..26).map(one).sum()
        };
        for (p, out) in out.iter().enumerate() {
            let want = (((sum(p) >> 4) * 1024 + (1 << 15)) >> 16) + 128;
            assert_eq!(out[0] as i32, want.clamp(0, 255));
        }
    }

    #[test]
    fn products_agree() {
        let features: [u8; 16 * 3 + 5] = core::array::from_fn(|k| noise(k).unsigned_abs() as u8);
        let weights: [i8; 16 * 3 + 5] = core::array::from_fn(|k| (noise(k + 3) / 2) as i8);
        let pairs = features.iter().zip(weights);
        let sum: i32 = pairs.map(|(f, w)| i32::from(*f) * i32::from(w)).sum();
        assert_eq!(dot(&features, &weights), sum);
        let (blocks, rows) = (features.as_chunks().0, weights.as_chunks().0);
        let whole = portable::dot(blocks, rows);
        assert_eq!(whole, dot(&features[..48], &weights[..48]));
    }

    #[test]
    fn windows_agree() {
        let taps: [[[u8; BLOCK]; 2]; TAP_PAIRS] =
            core::array::from_fn(|k| [bytes(2 * k), bytes(2 * k + 50)]);
        let taps = taps.each_ref().map(|pair| pair.each_ref());
        let weights: TapWeights =
            core::array::from_fn(|k| core::array::from_fn(|i| noise(k * 16 + i) / 2));
        for scale in scales() {
            assert_eq!(
                depthwise3x3(&taps, &weights, &scale),
                portable::depthwise3x3(&taps, &weights, &scale)
            );
        }
    }
}
