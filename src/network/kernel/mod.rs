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
mod tile;

pub(super) use tile::{BLOCK, NO_LATERAL, Scale, TAP_PAIRS, TILE, TapWeights, Taps, Tile};

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

    /// Columns of a tile: an even number that is no multiple of a vector.
    const COLUMNS: usize = 26;
    /// Rounds of each test; every third one has extreme numbers only.
    const ROUNDS: u32 = 600;

    /// Marsaglia's xorshift generator, 32 bits.
    struct Numbers {
        state: u32,
        extreme: bool,
    }

    impl Numbers {
        fn new(round: u32) -> Self {
            Numbers {
                state: round.wrapping_mul(2_654_435_761) | 1,
                extreme: round % 3 == 2,
            }
        }

        /// A number in `least..=most`, in extreme rounds one of both.
        fn within(&mut self, least: i32, most: i32) -> i32 {
            self.state ^= self.state << 13;
            self.state ^= self.state >> 17;
            self.state ^= self.state << 5;
            let span = most.abs_diff(least);
            match (self.extreme, self.state & 1) {
                (true, 0) => least,
                (true, _) => most,
                (false, _) => least.wrapping_add_unsigned(self.state % span.saturating_add(1)),
            }
        }

        fn bytes(&mut self) -> [u8; BLOCK] {
            core::array::from_fn(|_| self.within(0, 255) as u8)
        }
    }

    /// What a checked model may hold (plan.rs).
    struct Constants {
        bias: [i32; BLOCK],
        multiplier: [i32; BLOCK],
    }

    impl Constants {
        fn new(numbers: &mut Numbers) -> Self {
            let (bias, multiplier) = ((1 << 28) - 1, (1 << 15) - 1);
            Constants {
                bias: core::array::from_fn(|_| numbers.within(-bias, bias)),
                multiplier: core::array::from_fn(|_| numbers.within(-multiplier, multiplier)),
            }
        }

        fn scale(&self, numbers: &mut Numbers) -> Scale<'_> {
            Scale {
                bias: &self.bias,
                multiplier: &self.multiplier,
                pre_shift: numbers.within(0, 24) as u32,
                post_shift: numbers.within(1, 30) as u32,
                zero_point: 128 * numbers.within(0, 1),
            }
        }
    }

    #[test]
    fn convolutions_agree_with_the_portable_code() {
        for round in 0..ROUNDS {
            let n = &mut Numbers::new(round);
            let columns: [[i16; COLUMNS]; TILE] =
                core::array::from_fn(|_| core::array::from_fn(|_| n.within(-255, 255) as i16));
            let weights: [i16; COLUMNS * BLOCK] =
                core::array::from_fn(|_| n.within(-128, 127) as i16);
            let lateral: [[u8; BLOCK]; TILE] = core::array::from_fn(|_| n.bytes());
            let constants = Constants::new(n);
            let tile = Tile {
                columns: columns.each_ref().map(|c| &c[..]),
                lateral: lateral.each_ref(),
            };
            let scale = constants.scale(n);
            let expected = portable::conv2d(&tile, &weights, &scale);
            assert_eq!(conv2d(&tile, &weights, &scale), expected, "round {round}");
        }
    }

    #[test]
    fn a_convolution_is_the_sum_of_products() {
        let n = &mut Numbers::new(0);
        let columns: [[i16; COLUMNS]; TILE] =
            core::array::from_fn(|_| core::array::from_fn(|_| n.within(-255, 255) as i16));
        let weights: [i16; COLUMNS * BLOCK] = core::array::from_fn(|_| n.within(-128, 127) as i16);
        let scale = Scale {
            bias: &[0; BLOCK],
            multiplier: &[1 << 10; BLOCK],
            pre_shift: 4,
            post_shift: 16,
            zero_point: 128,
        };
        let tile = Tile {
            columns: columns.each_ref().map(|c| &c[..]),
            lateral: [&NO_LATERAL; TILE],
        };
        for (out, columns) in conv2d(&tile, &weights, &scale).iter().zip(columns) {
            for (channel, out) in out.iter().enumerate() {
                let product = |(k, c): (usize, &i16)| {
                    i32::from(*c) * i32::from(weights[k / 2 * 16 + 2 * channel + k % 2])
                };
                let sum: i32 = columns.iter().enumerate().map(product).sum();
                let expected = (((sum >> 4) * 1024 + (1 << 15)) >> 16) + 128;
                assert_eq!(i32::from(*out), expected.clamp(0, 255));
            }
        }
    }

    #[test]
    fn depthwise_convolutions_agree_with_the_portable_code() {
        for round in 0..ROUNDS {
            let n = &mut Numbers::new(round);
            let taps: [[[u8; BLOCK]; 2]; TAP_PAIRS] =
                core::array::from_fn(|_| [n.bytes(), n.bytes()]);
            let taps = taps.each_ref().map(|pair| pair.each_ref());
            let weights: TapWeights =
                core::array::from_fn(|_| core::array::from_fn(|_| n.within(-128, 127) as i16));
            let constants = Constants::new(n);
            let scale = constants.scale(n);
            let expected = portable::depthwise3x3(&taps, &weights, &scale);
            let out = depthwise3x3(&taps, &weights, &scale);
            assert_eq!(out, expected, "round {round}");
        }
    }

    #[test]
    fn dot_products_are_sums_of_products() {
        for round in 0..ROUNDS {
            let n = &mut Numbers::new(round);
            let features: [u8; 16 * 3 + 5] = core::array::from_fn(|_| n.within(0, 255) as u8);
            let weights: [i8; 16 * 3 + 5] = core::array::from_fn(|_| n.within(-128, 127) as i8);
            let pairs = features.iter().zip(weights);
            let sum: i32 = pairs.map(|(f, w)| i32::from(*f) * i32::from(w)).sum();
            assert_eq!(dot(&features, &weights), sum, "round {round}");
            let (blocks, rows) = (features.as_chunks().0, weights.as_chunks().0);
            let whole = portable::dot(blocks, rows);
            assert_eq!(whole, dot(&features[..48], &weights[..48]), "round {round}");
        }
    }
}
