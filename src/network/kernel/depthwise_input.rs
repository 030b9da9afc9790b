//! The input of a 3×3 depthwise convolution. It checks once that the map has all its pixels; the
//! kernels rely on it.

use super::BLOCK;
use super::operands::TAP_PAIRS;
use crate::network::plan::MAX_CHANNELS;

/// The input of a 3×3 depthwise convolution, a square map.
#[derive(Clone, Copy)]
pub(in crate::network) struct DepthwiseInput<'a> {
    map: &'a [u8],
    side: usize,
    stride: usize,
    channels: usize,
}

impl<'a> DepthwiseInput<'a> {
    /// A map of `side` × `side` pixels; `None` unless it has them.
    #[inline]
    pub fn new(map: &'a [u8], side: usize, channels: usize, stride: usize) -> Option<Self> {
        let valid = channels.is_multiple_of(BLOCK)
            && (1..=OUTSIDE.len()).contains(&channels)
            && side > 0
            && (1..=2).contains(&stride)
            && map.len() >= side * side * channels;
        valid.then_some(DepthwiseInput {
            map,
            side,
            stride,
            channels,
        })
    }

    /// Channels of every pixel, a multiple of [`BLOCK`].
    #[cfg(simd_kernel)]
    #[inline(always)]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// From an output pixel's input to the next one's \[px\].
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The input of each row of the output, with that row.
    #[inline(always)]
    pub fn rows<'o>(self, out: &'o mut [u8]) -> impl Iterator<Item = (Rows<'a>, &'o mut [u8])> {
        let row = self.side.div_ceil(self.stride.max(1)) * self.channels;
        let rows = out.chunks_exact_mut(row.max(1)).enumerate();
        rows.map(move |(y, out)| {
            let top = (y * self.stride).wrapping_sub(1);
            (Rows { input: self, top }, out)
        })
    }
}

/// What is read outside of a map.
static OUTSIDE: [u8; MAX_CHANNELS] = [0; _];

/// The input rows of one output row of a 3×3 depthwise convolution.
#[derive(Clone, Copy)]
pub(in crate::network) struct Rows<'a> {
    input: DepthwiseInput<'a>,
    /// The first of the three; it may be outside of the map.
    top: usize,
}

impl<'a> Rows<'a> {
    /// Channels of every pixel, a multiple of [`BLOCK`].
    #[cfg(any(test, feature = "unstable-internals", not(simd_kernel)))]
    #[inline(always)]
    pub fn channels(&self) -> usize {
        self.input.channels
    }

    /// Number `k` of the rows, `None` where it is outside of the map.
    #[inline(always)]
    fn row(&self, k: usize) -> Option<usize> {
        let row = self.top.wrapping_add(k);
        (row < self.input.side).then_some(row)
    }

    /// The nine taps of output pixel `x`, each of [`Self::channels`] bytes, and a tenth of zeros.
    #[cfg(any(test, feature = "unstable-internals", not(simd_kernel)))]
    #[inline]
    pub fn taps(&self, x: usize) -> [&'a [u8]; 2 * TAP_PAIRS] {
        let input = &self.input;
        let outside = OUTSIDE.get(..input.channels).unwrap_or(&[]);
        let mut taps = [outside; 2 * TAP_PAIRS];
        for (k, tap) in taps.iter_mut().take(9).enumerate() {
            let sx = (x * input.stride + k % 3).wrapping_sub(1);
            if let Some(row) = self.row(k / 3).filter(|_| sx < input.side) {
                let at = (row * input.side + sx) * input.channels;
                let values = input.map.get(at..at + input.channels);
                *tap = values.unwrap_or(outside);
            }
        }
        taps
    }

    /// The first bytes of [`Self::taps`].
    #[cfg(simd_kernel)]
    #[inline(always)]
    pub fn tap_starts(&self, x: usize) -> [*const u8; 2 * TAP_PAIRS] {
        let outside = OUTSIDE.as_ptr();
        let middle = x * self.input.stride;
        let (left, right) = (middle > 0, middle + 1 < self.input.side);
        let mut starts = [outside; 2 * TAP_PAIRS];
        let of_rows = starts.as_chunks_mut::<3>().0.iter_mut();
        for (starts, line) in of_rows.zip(self.lines(x)) {
            *starts = [
                if left { line.tap(0) } else { outside },
                line.tap(1),
                if right { line.tap(2) } else { outside },
            ];
        }
        starts
    }

    /// The first bytes of `N` input columns, from the one to the left of output pixel `x` on.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn columns<const N: usize>(&self, x: usize) -> [[*const u8; N]; 3] {
        let input = &self.input;
        let first = (x * input.stride).wrapping_sub(1);
        core::array::from_fn(|row| {
            let row = self.row(row).map(|row| row * input.side);
            core::array::from_fn(|k| {
                let column = first.wrapping_add(k);
                let inside = row.filter(|_| column < input.side);
                inside.map_or(OUTSIDE.as_ptr(), |row| {
                    let at = (row + column) * input.channels;
                    input.map.as_ptr().wrapping_add(at)
                })
            })
        })
    }

    /// Whether this number of [`Self::columns`] is in the map.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn has_columns(&self, x: usize, columns: usize) -> bool {
        let first = (x * self.input.stride).wrapping_sub(1);
        first < self.input.side && first + columns <= self.input.side
    }

    /// Those of the first `pixels` output pixels whose taps lie between the map's left and right
    /// edges.
    #[cfg(any(target_arch = "aarch64", target_arch = "x86_64"))]
    #[inline(always)]
    pub fn inner(&self, pixels: usize) -> core::ops::Range<usize> {
        let stride = self.input.stride.max(1);
        let end = (self.input.side.saturating_sub(1).div_ceil(stride)).min(pixels);
        1.min(end)..end
    }

    /// The rows of taps at output pixel `x`; only at one of [`Self::inner`] are all in the map.
    #[cfg(simd_kernel)]
    #[inline(always)]
    pub fn lines(&self, x: usize) -> [Line; 3] {
        let input = &self.input;
        let row = input.side * input.channels;
        let first = (x * input.stride).wrapping_sub(1);
        let at = self.top.wrapping_mul(row);
        let at = at.wrapping_add(first.wrapping_mul(input.channels));
        let at = input.map.as_ptr().wrapping_add(at);
        core::array::from_fn(|k| match self.row(k) {
            None => Line {
                at: OUTSIDE.as_ptr(),
                column: 0,
                pixel: 0,
            },
            Some(_) => Line {
                at: at.wrapping_add(k * row),
                column: input.channels,
                pixel: input.stride * input.channels,
            },
        })
    }
}

/// Three neighbouring taps of a row.
#[cfg(simd_kernel)]
#[derive(Clone, Copy)]
pub(in crate::network) struct Line {
    /// The left tap.
    at: *const u8,
    /// Bytes to the next tap.
    column: usize,
    /// Bytes to the next output pixel's taps.
    #[cfg_attr(
        not(any(target_arch = "aarch64", target_arch = "x86_64")),
        expect(dead_code, reason = "other kernels do not step from pixel to pixel")
    )]
    pixel: usize,
}

#[cfg(simd_kernel)]
impl Line {
    /// The first byte of a tap, 0 to 2.
    #[inline(always)]
    pub fn tap(&self, k: usize) -> *const u8 {
        self.at.wrapping_add(k * self.column)
    }

    /// The line from another channel on.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn at_channel(self, channel: usize) -> Self {
        Line {
            at: self.at.wrapping_add(channel),
            ..self
        }
    }

    /// Goes to the next output pixel.
    #[cfg(any(target_arch = "aarch64", target_arch = "x86_64"))]
    #[inline(always)]
    pub fn advance(&mut self) {
        self.at = self.at.wrapping_add(self.pixel);
    }
}
