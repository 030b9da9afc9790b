//! Operands of the kernels. They check once that all their reads and writes are in bounds; the
//! kernels rely on it.

/// Output channels computed together.
pub(in crate::network) const BLOCK: usize = 8;
/// Pairs of taps of a 3×3 window: nine taps and one of weight 0.
pub(in crate::network) const TAP_PAIRS: usize = 5;
/// Most rows of a window \[px\].
pub(in crate::network) const MAX_ROWS: usize = 5;

/// Memory for staged operands \[bytes\]: five rows of the widest window, or three of 58 pixels of 8
/// channels, or 25 pixels of 80 channels.
pub(in crate::network) const STAGING: usize = 4096;

/// Weights of a block of depthwise channels: `[pair of taps][channel][2]`.
pub(in crate::network) type TapWeights = [[i16; 2 * BLOCK]; TAP_PAIRS];

/// Weights of a depthwise convolution. Not every machine's kernels read both.
#[derive(Clone, Copy)]
pub(in crate::network) struct DepthwiseWeights<'a> {
    /// As the model has them: `[9][channels]`.
    #[cfg_attr(
        not(any(
            target_arch = "x86_64",
            target_arch = "aarch64",
            target_feature = "relaxed-simd"
        )),
        expect(dead_code, reason = "for kernels of other machines")
    )]
    pub raw: &'a [i8],
    /// By block, for the kernels with `Kernel::PAIRED`; the tenth tap is 0.
    #[cfg_attr(
        all(
            target_arch = "aarch64",
            simd_kernel,
            not(any(test, feature = "unstable-internals"))
        ),
        expect(dead_code, reason = "for kernels of other machines")
    )]
    pub paired: &'a [TapWeights],
}

/// Memory for the operands of a kernel.
#[derive(Clone)]
#[repr(align(32))]
pub(in crate::network) struct Staging {
    numbers: [[i16; 2 * BLOCK]; STAGING / 4 / BLOCK],
}

impl Staging {
    pub const fn new() -> Self {
        Staging {
            numbers: [[0; 2 * BLOCK]; STAGING / 4 / BLOCK],
        }
    }

    /// The memory as bytes.
    pub fn bytes(&mut self) -> &mut [u8] {
        let numbers = self.numbers.as_flattened_mut();
        // SAFETY: the same memory; every number is two bytes and may have any value.
        unsafe { core::slice::from_raw_parts_mut(numbers.as_mut_ptr().cast(), 2 * numbers.len()) }
    }

    /// The memory as weights of blocks of depthwise channels.
    pub fn tap_weights(&mut self) -> &mut [TapWeights] {
        self.numbers.as_chunks_mut().0
    }
}

/// Requantisation of sums to bytes:
/// `((((sum + bias) >> pre_shift)·multiplier + half) >> post_shift) + zero_point`, clamped to
/// 0..255, with `half = 1 << (post_shift − 1)`. The shifted sum and the multiplier are cut to 16
/// bits; in a valid model they fit.
#[derive(Clone, Copy)]
pub(in crate::network) struct Scale<'a> {
    /// By output channel.
    pub bias: &'a [[i32; BLOCK]],
    /// By output channel.
    pub multiplier: &'a [[i32; BLOCK]],
    pub pre_shift: u32,
    pub post_shift: u32,
    pub zero_point: i32,
    /// Whether `2·(lateral − 128)` is added before the clamp, where `lateral` is the byte that the
    /// output replaces.
    pub lateral: bool,
}

impl Scale<'_> {
    /// Whether nothing is added to the scaled sum: no zero point and no lateral.
    #[inline(always)]
    #[cfg(all(simd_kernel, not(target_arch = "x86_64")))]
    pub fn is_plain(&self) -> bool {
        self.zero_point == 0 && !self.lateral
    }

    /// Shifts of a requantisation, below 32, and the rounding constant of the second.
    #[inline(always)]
    pub fn shifts(&self) -> (u32, u32, i32) {
        let post_shift = self.post_shift & 31;
        let half = 1 << (post_shift.wrapping_sub(1) & 31);
        (self.pre_shift & 31, post_shift, half)
    }
}

/// The weighted sum of two maps: `((a·factors[0] + b·factors[1]) >> pre_shift`, rounded,
/// `>> post_shift`, clamped to 0..255.
#[derive(Clone, Copy)]
pub(in crate::network) struct Sum {
    pub factors: [i16; 2],
    pub pre_shift: u32,
    pub post_shift: u32,
}

impl Sum {
    /// The shifts, below 32, and the rounding constant of the second.
    #[inline(always)]
    pub fn shifts(&self) -> (u32, u32, i32) {
        let post_shift = self.post_shift & 31;
        let half = 1 << (post_shift.wrapping_sub(1) & 31);
        (self.pre_shift & 31, post_shift, half)
    }
}

/// Consecutive output pixels of a full convolution: the staged inputs of their windows, the weights
/// and the outputs.
pub(in crate::network) struct Strip<'a> {
    values: &'a [u8],
    rows: &'a [usize],
    step: usize,
    columns: usize,
    #[cfg_attr(
        not(target_arch = "x86_64"),
        expect(dead_code, reason = "most kernels multiply by the padding too")
    )]
    filled: usize,
    weights: &'a [i8],
    scale: Scale<'a>,
    out: &'a mut [u8],
    channels: usize,
    pixels: usize,
    /// Bytes from the start of a window to its end.
    #[cfg_attr(
        not(simd_kernel),
        expect(dead_code, reason = "the scalar kernel needs no tiles")
    )]
    window: usize,
}

/// Pixels that are computed together.
#[cfg(simd_kernel)]
#[derive(Clone, Copy)]
pub(in crate::network) struct Tile {
    /// The first byte of the first pixel's window.
    pub window: *const u8,
    /// From a pixel's window to the next pixel's \[bytes\]: all windows of the tile, also of those
    /// pixels that are not present, are in bounds.
    pub step: usize,
    /// Pixels whose outputs are to be written, at least one.
    pub present: usize,
}

/// What a [`Strip`] is made of.
pub(in crate::network) struct StripParts<'a> {
    /// Staged input values (`Kernel::stage`).
    pub values: &'a [u8],
    /// Where each row of the first pixel's window starts in `values` \[bytes\].
    pub rows: &'a [usize],
    /// From a pixel's window to the next pixel's \[bytes\].
    pub step: usize,
    /// Values of a row of a window, an even number.
    pub columns: usize,
    /// How many of them are not padding.
    pub filled: usize,
    /// `[block][row][pair of columns][8 channels][2]`.
    pub weights: &'a [i8],
    /// Requantisation of the blocks.
    pub scale: Scale<'a>,
    /// Outputs of the first block; pixels are `channels` apart.
    pub out: &'a mut [u8],
    pub channels: usize,
}

impl<'a> Strip<'a> {
    /// Checks the parts, for values of `width` bytes in `group`s of columns. `None` where one of
    /// them is too short.
    #[inline]
    pub fn new(parts: StripParts<'a>, width: usize, group: usize) -> Option<Self> {
        let StripParts {
            values,
            rows,
            step,
            columns,
            filled,
            weights,
            scale,
            out,
            channels,
        } = parts;
        let blocks = scale.bias.len();
        let rest = out.len().checked_sub(blocks * BLOCK)?;
        let pixels = rest / channels.max(1) + 1;
        let window = rows.iter().max()? + columns * width;
        let valid = (pixels - 1) * step + window <= values.len()
            && columns.is_multiple_of(group)
            && weights.len() >= blocks * rows.len() * columns * BLOCK
            && scale.multiplier.len() == blocks
            && blocks > 0
            && blocks * BLOCK <= channels;
        valid.then_some(Strip {
            values,
            rows,
            step,
            columns,
            filled,
            weights,
            scale,
            out,
            channels,
            pixels,
            window,
        })
    }

    /// Output pixels: every one has room for all blocks.
    #[inline(always)]
    pub fn pixels(&self) -> usize {
        self.pixels
    }

    /// Blocks of output channels.
    #[inline(always)]
    pub fn blocks(&self) -> usize {
        self.scale.bias.len()
    }

    /// Weights of a block.
    #[inline(always)]
    pub fn block_weights(&self) -> usize {
        self.rows.len() * self.columns * BLOCK
    }

    /// Where each row of a window starts, from the window's first byte \[bytes\].
    #[inline(always)]
    pub fn rows(&self) -> &'a [usize] {
        self.rows
    }

    /// Values of a row of a window, an even number.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many columns of a row are not padding: the weights of the others are 0.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn filled(&self) -> usize {
        self.filled
    }

    /// `[block][row][pair of columns][8 channels][2]`, for all blocks.
    #[inline(always)]
    pub fn weights(&self) -> &'a [i8] {
        self.weights
    }

    /// The requantisation, of [`Self::blocks`] blocks.
    #[inline(always)]
    pub fn scale(&self) -> &Scale<'a> {
        &self.scale
    }

    /// From the output of a pixel to the next pixel's \[bytes\].
    #[inline(always)]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The tile of at most `pixels` pixels from `first` on.
    #[cfg(simd_kernel)]
    #[inline(always)]
    pub fn tile(&self, first: usize, pixels: usize) -> Tile {
        let left = self.pixels.saturating_sub(first);
        let at = first * self.step;
        // Behind the last pixel, a tile reads whatever is there.
        let fits = at + (pixels - 1) * self.step + self.window <= self.values.len();
        Tile {
            window: self.values.as_ptr().wrapping_add(at),
            step: if fits { self.step } else { 0 },
            present: if fits { left.min(pixels) } else { 1 },
        }
    }

    /// The values of a pixel.
    #[cfg(any(test, feature = "unstable-internals", not(simd_kernel)))]
    #[inline(always)]
    pub fn values(&self, pixel: usize) -> &'a [u8] {
        self.values.get(pixel * self.step..).unwrap_or(&[])
    }

    /// The outputs, [`Self::pixels`] of them, [`Self::channels`] apart.
    #[inline(always)]
    pub fn out(&mut self) -> &mut [u8] {
        self.out
    }
}
