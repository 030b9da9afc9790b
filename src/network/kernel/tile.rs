//! Operands of the kernels, in blocks of channels and tiles of pixels.

/// Output channels computed together.
pub(in crate::network) const BLOCK: usize = 8;
/// Output pixels computed together, so that weights are read once for all of them.
pub(in crate::network) const TILE: usize = 4;
/// Pairs of taps of a 3×3 window: nine taps and one of weight 0.
pub(in crate::network) const TAP_PAIRS: usize = 5;

/// Requantisation of a block of sums to bytes:
/// `((((sum + bias) >> pre_shift)·multiplier + half) >> post_shift) + zero_point`, clamped to
/// 0..255, with `half = 1 << (post_shift − 1)`. The shifted sum and the multiplier are cut to 16
/// bits; in a valid model they fit.
#[derive(Clone, Copy)]
pub(in crate::network) struct Scale<'a> {
    pub bias: &'a [i32; BLOCK],
    pub multiplier: &'a [i32; BLOCK],
    pub pre_shift: u32,
    pub post_shift: u32,
    pub zero_point: i32,
}

/// A block of a lateral map that adds nothing.
pub(in crate::network) const NO_LATERAL: [u8; BLOCK] = [128; BLOCK];

/// Inputs of [`TILE`] output pixels.
pub(in crate::network) struct Tile<'a> {
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
    pub(super) fn pairs(&self) -> impl Iterator<Item = [&'a [i16; 2]; TILE]> + use<'a> {
        let [a, b, c, d] = self.columns.map(|columns| columns.as_chunks::<2>().0);
        let pairs = a.iter().zip(b).zip(c.iter().zip(d));
        pairs.map(|((a, b), (c, d))| [a, b, c, d])
    }
}

/// The taps of a 3×3 window, in pairs.
pub(in crate::network) type Taps<'a> = [[&'a [u8; BLOCK]; 2]; TAP_PAIRS];
/// The weights of the taps: `[pair][channel][2]`.
pub(in crate::network) type TapWeights = [[i16; 2 * BLOCK]; TAP_PAIRS];
