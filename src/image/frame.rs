//! A view over one camera frame: checked once, then readable at any pixel without failure.

use super::format::LumaEncoding;
use super::layout::Addressing;
use super::{FrameError, FrameLayout};

/// A checked view over the luma of one frame, upright and unmirrored.
///
/// Coordinates are \[px\]: x right, y down, (0, 0) is the centre of the top-left pixel.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    data: &'a [u8],
    at: Addressing,
    encoding: LumaEncoding,
    /// Whether each pixel is the mean of itself and its eight neighbours.
    box_filtered: bool,
}

impl<'a> Frame<'a> {
    /// Checks that format, size, stride and length agree.
    ///
    /// # Errors
    /// [`FrameError`] names what disagrees.
    pub fn new(layout: &FrameLayout, data: &'a [u8]) -> Result<Self, FrameError> {
        Ok(Frame {
            data,
            at: Addressing::new(layout, data.len())?,
            encoding: layout.format.encoding(),
            box_filtered: false,
        })
    }

    /// The same frame seen through a 3×3 box filter: each pixel is the rounded mean of itself and
    /// its eight neighbours. The deviation of white noise falls to a third; a pixel costs nine
    /// reads.
    pub fn box_filtered(&self) -> Self {
        Frame {
            box_filtered: true,
            ..*self
        }
    }

    /// Whether it is [`box_filtered`](Self::box_filtered).
    #[inline]
    pub(crate) fn is_box_filtered(&self) -> bool {
        self.box_filtered
    }

    /// Upright width \[px\].
    pub fn width(&self) -> i32 {
        self.at.width
    }

    /// Upright height \[px\].
    pub fn height(&self) -> i32 {
        self.at.height
    }

    /// Luma (0..=255) at the upright pixel (x, y); outside the frame, that of the nearest pixel.
    #[inline]
    pub fn luma(&self, x: i32, y: i32) -> u8 {
        match self.box_filtered {
            true => self.filtered_luma(x, y),
            false => self.raw_luma(x, y),
        }
    }

    // Not inlined: it has many callers and would grow each of them.
    #[inline(never)]
    fn filtered_luma(&self, x: i32, y: i32) -> u8 {
        mean(self.raw_3x3(x, y))
    }

    /// As [`Frame::luma`], without the box filter.
    #[inline]
    pub(crate) fn raw_luma(&self, x: i32, y: i32) -> u8 {
        // Not `clamp`: it panics where the compiler cannot see that the size is at least 1.
        let x = x.min(self.at.width - 1).max(0);
        let y = y.min(self.at.height - 1).max(0);
        self.raw_luma_at(self.byte_offset(x, y))
    }

    /// Luma, without the box filter, at (x, y), (x+1, y), (x, y+1) and (x+1, y+1); outside the
    /// frame, that of the nearest pixel.
    #[inline]
    pub(crate) fn raw_2x2(&self, x: i32, y: i32) -> [u8; 4] {
        if x >= 0 && y >= 0 && x < self.at.width - 1 && y < self.at.height - 1 {
            let here = self.byte_offset(x, y);
            let below = here + self.at.step_y;
            let right = self.at.step_x;
            [here, here + right, below, below + right].map(|at| self.raw_luma_at(at))
        } else {
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| self.raw_luma(x + dx, y + dy))
        }
    }

    /// Luma, without the box filter, of the 3×3 neighbourhood of a pixel, row by row. Each row may
    /// run from right to left.
    fn raw_3x3(&self, x: i32, y: i32) -> [[u16; 3]; 3] {
        if x >= 1 && y >= 1 && x < self.at.width - 1 && y < self.at.height - 1 {
            return self.raw_3x3_at(self.byte_offset(x, y));
        }
        [-1, 0, 1].map(|dy| [-1, 0, 1].map(|dx| u16::from(self.raw_luma(x + dx, y + dy))))
    }

    /// As [`Frame::raw_3x3`], for a pixel that is not on the border.
    #[inline]
    fn raw_3x3_at(&self, offset: isize) -> [[u16; 3]; 3] {
        // Fast path of most frames: the three bytes of a row are adjacent.
        let adjacent = self.luma_bytes().filter(|_| self.at.step_x.abs() == 1);
        [-self.at.step_y, 0, self.at.step_y].map(|row| {
            let middle = offset + row;
            match adjacent {
                Some(bytes) => {
                    let row = bytes.get((middle - 1) as usize..);
                    let row = row.and_then(|row| row.first_chunk()).copied();
                    row.unwrap_or([0; 3]).map(u16::from)
                }
                None => [-self.at.step_x, 0, self.at.step_x]
                    .map(|column| u16::from(self.raw_luma_at(middle + column))),
            }
        })
    }

    /// Absolute response, without the box filter, of Immerkær's noise filter
    /// `[1 −2 1; −2 4 −2; 1 −2 1]`: 0 on any plane of grey levels.
    pub(crate) fn noise_response(&self, x: i32, y: i32) -> u16 {
        let rows = self.raw_3x3(x, y);
        let [a, b, c] = rows.map(|[p, q, r]| (p + r) as i16 - 2 * q as i16);
        (a + c - 2 * b).unsigned_abs()
    }

    /// Byte offset of an upright pixel of the frame.
    #[inline]
    pub(crate) fn byte_offset(&self, x: i32, y: i32) -> isize {
        self.at.origin + self.byte_step(x, y)
    }

    /// Bytes from any pixel to the one this far to the right and below it \[px\].
    #[inline]
    pub(crate) fn byte_step(&self, right: i32, below: i32) -> isize {
        right as isize * self.at.step_x + below as isize * self.at.step_y
    }

    /// The bytes that hold the luma of each pixel at its [`byte_offset`](Self::byte_offset); `None`
    /// for formats whose luma is not one byte.
    #[inline]
    pub(crate) fn luma_bytes(&self) -> Option<&'a [u8]> {
        match self.encoding {
            LumaEncoding::Byte(offset) => self.data.get(offset..),
            _ => None,
        }
    }

    /// The luma of an upright row, the nearest one outside of the frame; `None` where its pixels
    /// are not bytes side by side.
    #[cfg(feature = "keyframes")]
    pub(crate) fn luma_row(&self, y: i32) -> Option<&'a [u8]> {
        let bytes = self.luma_bytes().filter(|_| self.at.step_x == 1)?;
        let y = y.min(self.at.height - 1).max(0);
        let start = self.byte_offset(0, y) as usize;
        bytes.get(start..)?.get(..self.at.width as usize)
    }

    #[inline]
    fn raw_luma_at(&self, offset: isize) -> u8 {
        let at = offset as usize;
        // `new` checked the length, so the fallback is never taken; it keeps panics out of the
        // binary.
        let byte = |offset: usize| self.data.get(at + offset).copied().unwrap_or(0);
        match self.encoding {
            LumaEncoding::Byte(offset) => byte(offset),
            LumaEncoding::Word(shift) => {
                let word = byte(0) as u32 | (byte(1) as u32) << 8;
                (word >> shift).min(255) as u8
            }
            // ITU-R BT.601 luma in 1/256.
            LumaEncoding::Rgb([r, g, b]) => {
                ((77 * byte(r) as u32 + 150 * byte(g) as u32 + 29 * byte(b) as u32 + 128) >> 8)
                    as u8
            }
        }
    }
}

/// Rounded mean of a 3×3 neighbourhood.
#[inline]
fn mean(rows: [[u16; 3]; 3]) -> u8 {
    let sum: u16 = rows.map(|[a, b, c]| a + b + c).iter().sum();
    // Division by 9 as a multiplication: exact for all sums of nine bytes.
    (((u32::from(sum) + 4) * 7282) >> 16) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{MAX_SIDE, PixelFormat, Rotation};

    fn layout(format: PixelFormat, width: u32, height: u32, stride: u32) -> FrameLayout {
        FrameLayout {
            format,
            width,
            height,
            stride,
            ..FrameLayout::grey(1, 1)
        }
    }

    #[test]
    fn sizes_strides_and_lengths_are_checked() {
        let bytes = [0u8; 12];
        let new = |l: FrameLayout| Frame::new(&l, &bytes).err();
        assert_eq!(
            new(layout(PixelFormat::Grey, 0, 3, 4)),
            Some(FrameError::Size)
        );
        assert_eq!(
            new(layout(PixelFormat::Grey, MAX_SIDE + 1, 3, u32::MAX)),
            Some(FrameError::Size)
        );
        assert_eq!(
            new(layout(PixelFormat::Grey, 5, 3, 4)),
            Some(FrameError::Stride)
        );
        assert_eq!(
            new(layout(PixelFormat::Yuyv, 3, 2, 5)),
            Some(FrameError::Stride)
        );
        assert_eq!(
            new(layout(PixelFormat::Grey, 4, 4, 4)),
            Some(FrameError::Length)
        );
        assert_eq!(
            new(layout(PixelFormat::Grey, 4, 3, u32::MAX)),
            Some(FrameError::Length)
        );
        assert_eq!(
            new(layout(PixelFormat::Grey, 2, 3, 5)),
            None,
            "last row is unpadded"
        );
    }

    #[test]
    fn rotation_and_mirroring_are_undone() {
        // 3 wide, 2 high: 0 1 2 / 3 4 5
        let bytes = [0, 1, 2, 3, 4, 5];
        let read = |rotation, mirrored| {
            let l = FrameLayout {
                rotation,
                mirrored,
                ..FrameLayout::grey(3, 2)
            };
            let f = Frame::new(&l, &bytes).unwrap();
            let mut out = [9u8; 6];
            for y in 0..f.height() {
                for x in 0..f.width() {
                    out[(y * f.width() + x) as usize] = f.luma(x, y);
                }
            }
            out
        };
        assert_eq!(read(Rotation::None, false), [0, 1, 2, 3, 4, 5]);
        assert_eq!(read(Rotation::Cw90, false), [3, 0, 4, 1, 5, 2]);
        assert_eq!(read(Rotation::Half, false), [5, 4, 3, 2, 1, 0]);
        assert_eq!(read(Rotation::Cw270, false), [2, 5, 1, 4, 0, 3]);
        assert_eq!(read(Rotation::None, true), [2, 1, 0, 5, 4, 3]);
        assert_eq!(read(Rotation::Cw90, true), [5, 2, 4, 1, 3, 0]);
    }

    #[test]
    fn luma_of_every_format() {
        for (format, _) in PixelFormat::FOURCC {
            let mut bytes = [0u8; 8];
            match format.encoding() {
                LumaEncoding::Byte(at) => bytes[format.pixel_bytes() + at] = 200,
                LumaEncoding::Word(shift) => {
                    let word = (200u16 << shift).to_le_bytes();
                    bytes[2..4].copy_from_slice(&word);
                }
                LumaEncoding::Rgb(at) => at
                    .iter()
                    .for_each(|o| bytes[format.pixel_bytes() + o] = 200),
            }
            let stride = 2 * format.pixel_bytes() as u32;
            let frame = Frame::new(&layout(format, 2, 1, stride), &bytes).unwrap();
            assert_eq!(
                (frame.luma(0, 0), frame.luma(1, 0), frame.luma(9, 9)),
                (0, 200, 200),
                "{format:?}"
            );
        }
    }
}
