//! A view over one camera frame: checked once, then readable at any pixel without failure.

/// Longest side of a frame \[px\]; keeps every fixed-point coordinate inside 32 bits.
pub const MAX_SIDE: u32 = 16_384;

/// Memory layouts of the luma plane; values of the same names in V4L2 (see [`PixelFormat::from_fourcc`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// 8-bit grey.
    Grey,
    /// 10-bit grey in 16-bit little-endian words.
    Y10,
    /// 16-bit grey, little-endian.
    Y16,
    /// 4:2:2 packed, luma first.
    Yuyv,
    /// 4:2:2 packed, chroma first.
    Uyvy,
    /// 4:2:0 with interleaved chroma after the luma plane (NV12); chroma is not read.
    Nv12,
    /// 4:2:0 with interleaved chroma after the luma plane (NV21); chroma is not read.
    Nv21,
    /// 4:2:0 planar (I420); chroma is not read.
    Yu12,
    /// 24-bit R, G, B.
    Rgb24,
    /// 24-bit B, G, R.
    Bgr24,
    /// 32-bit R, G, B, unused.
    Rgbx32,
    /// 32-bit B, G, R, unused.
    Bgrx32,
    /// 32-bit unused, R, G, B.
    Xrgb32,
    /// 32-bit unused, B, G, R.
    Xbgr32,
}

const fn fourcc(code: &[u8; 4]) -> u32 {
    u32::from_le_bytes(*code)
}

impl PixelFormat {
    /// All formats with their V4L2 fourcc codes (`linux/videodev2.h`).
    pub const FOURCC: [(PixelFormat, u32); 18] = [
        (PixelFormat::Grey, fourcc(b"GREY")),
        (PixelFormat::Y10, fourcc(b"Y10 ")),
        (PixelFormat::Y16, fourcc(b"Y16 ")),
        (PixelFormat::Yuyv, fourcc(b"YUYV")),
        (PixelFormat::Uyvy, fourcc(b"UYVY")),
        (PixelFormat::Nv12, fourcc(b"NV12")),
        (PixelFormat::Nv21, fourcc(b"NV21")),
        (PixelFormat::Yu12, fourcc(b"YU12")),
        (PixelFormat::Rgb24, fourcc(b"RGB3")),
        (PixelFormat::Bgr24, fourcc(b"BGR3")),
        // The kernel's names tell the order in a 32-bit word, these tell the order in memory.
        (PixelFormat::Rgbx32, fourcc(b"XB24")),
        (PixelFormat::Rgbx32, fourcc(b"AB24")),
        (PixelFormat::Bgrx32, fourcc(b"XR24")),
        (PixelFormat::Bgrx32, fourcc(b"AR24")),
        (PixelFormat::Xrgb32, fourcc(b"BX24")),
        (PixelFormat::Xrgb32, fourcc(b"BA24")),
        (PixelFormat::Xbgr32, fourcc(b"RX24")),
        (PixelFormat::Xbgr32, fourcc(b"RA24")),
    ];

    /// The format of a V4L2 fourcc code, if it is one that posewise reads.
    pub fn from_fourcc(code: u32) -> Option<PixelFormat> {
        Self::FOURCC
            .iter()
            .find(|(_, known)| *known == code)
            .map(|(format, _)| *format)
    }

    /// Bytes from one pixel's luma to the next.
    const fn pixel_bytes(self) -> usize {
        match self {
            PixelFormat::Grey | PixelFormat::Nv12 | PixelFormat::Nv21 | PixelFormat::Yu12 => 1,
            PixelFormat::Y10 | PixelFormat::Y16 | PixelFormat::Yuyv | PixelFormat::Uyvy => 2,
            PixelFormat::Rgb24 | PixelFormat::Bgr24 => 3,
            _ => 4,
        }
    }

    /// How the bytes at a pixel become luma.
    const fn reading(self) -> Reading {
        match self {
            PixelFormat::Uyvy => Reading::Byte(1),
            PixelFormat::Y10 => Reading::Word(2),
            PixelFormat::Y16 => Reading::Word(8),
            PixelFormat::Rgb24 | PixelFormat::Rgbx32 => Reading::Rgb([0, 1, 2]),
            PixelFormat::Bgr24 | PixelFormat::Bgrx32 => Reading::Rgb([2, 1, 0]),
            PixelFormat::Xrgb32 => Reading::Rgb([1, 2, 3]),
            PixelFormat::Xbgr32 => Reading::Rgb([3, 2, 1]),
            _ => Reading::Byte(0),
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Reading {
    /// One byte at this offset.
    Byte(usize),
    /// A little-endian word, shifted right by this many bits, saturated to 255.
    Word(u32),
    /// Offsets of red, green and blue.
    Rgb([usize; 3]),
}

/// How the stored picture must be turned, clockwise, to stand upright.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rotation {
    /// Stored upright.
    #[default]
    None,
    /// Turn by 90° clockwise.
    Cw90,
    /// Turn by 180°.
    Half,
    /// Turn by 270° clockwise.
    Cw270,
}

/// Where the pixels lie in the caller's bytes.
#[derive(Clone, Copy, Debug)]
pub struct FrameLayout {
    /// Pixel format.
    pub format: PixelFormat,
    /// Stored width \[px\], 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Stored height \[px\], 1 to [`MAX_SIDE`].
    pub height: u32,
    /// Bytes from row to row (V4L2 `bytesperline`).
    pub stride: u32,
    /// Turn that makes the picture upright.
    pub rotation: Rotation,
    /// Whether the stored picture is mirrored left to right (a "selfie" preview); undone before the
    /// turn, so that left stays the subject's left.
    pub mirrored: bool,
}

impl FrameLayout {
    /// An upright grey picture without padding between rows.
    pub fn grey(width: u32, height: u32) -> Self {
        FrameLayout {
            format: PixelFormat::Grey,
            width,
            height,
            stride: width,
            rotation: Rotation::None,
            mirrored: false,
        }
    }
}

/// Why bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// Width or height is 0 or above [`MAX_SIDE`].
    Size,
    /// The stride is shorter than a row of pixels.
    Stride,
    /// The bytes end before the last luma sample.
    Length,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            FrameError::Size => "the frame's width or height is 0 or above 16384",
            FrameError::Stride => "the frame's stride is shorter than a row of pixels",
            FrameError::Length => "the frame's bytes end before its last row",
        })
    }
}

impl core::error::Error for FrameError {}

/// A checked view over the luma of one frame, upright and unmirrored.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    data: &'a [u8],
    width: i32,
    height: i32,
    /// Byte offset of the upright pixel (0, 0).
    origin: isize,
    /// Byte steps to the upright neighbour at the right and below.
    step_x: isize,
    step_y: isize,
    reading: Reading,
    /// Whether each pixel is the mean of itself and its eight neighbours.
    box_filtered: bool,
}

impl<'a> Frame<'a> {
    /// Checks that format, size, stride and length agree.
    ///
    /// # Errors
    /// [`FrameError`] names what disagrees.
    pub fn new(layout: &FrameLayout, data: &'a [u8]) -> Result<Self, FrameError> {
        let FrameLayout {
            format,
            width,
            height,
            stride,
            rotation,
            mirrored,
        } = *layout;
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            return Err(FrameError::Size);
        }
        let pixel = format.pixel_bytes() as u64;
        let row = width as u64 * pixel;
        if (stride as u64) < row {
            return Err(FrameError::Stride);
        }
        // The last row need not be padded to the stride.
        let needed = stride as u64 * (height as u64 - 1) + row;
        if (data.len() as u64) < needed || needed > isize::MAX as u64 {
            return Err(FrameError::Length);
        }
        let (w, h) = (width as isize - 1, height as isize - 1);
        let (pixel, stride) = (pixel as isize, stride as isize);
        // Upright (x, y) → stored column and row: the origin and the steps along x and y.
        let ((c0, r0), (cx, rx), (cy, ry)) = match rotation {
            Rotation::None => ((0, 0), (1, 0), (0, 1)),
            Rotation::Cw90 => ((0, h), (0, -1), (1, 0)),
            Rotation::Half => ((w, h), (-1, 0), (0, -1)),
            Rotation::Cw270 => ((w, 0), (0, 1), (-1, 0)),
        };
        let (c0, cx, cy) = if mirrored {
            (w - c0, -cx, -cy)
        } else {
            (c0, cx, cy)
        };
        let turned = matches!(rotation, Rotation::Cw90 | Rotation::Cw270);
        let (width, height) = if turned {
            (height, width)
        } else {
            (width, height)
        };
        Ok(Frame {
            data,
            width: width as i32,
            height: height as i32,
            origin: c0 * pixel + r0 * stride,
            step_x: cx * pixel + rx * stride,
            step_y: cy * pixel + ry * stride,
            reading: format.reading(),
            box_filtered: false,
        })
    }

    /// The same frame, each of its pixels the mean of 3×3: a third of the noise, at nine times the
    /// reading.
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
        self.width
    }

    /// Upright height \[px\].
    pub fn height(&self) -> i32 {
        self.height
    }

    /// Luma at the upright pixel (x, y); outside the frame, that of the nearest pixel.
    #[inline]
    pub fn luma(&self, x: i32, y: i32) -> u8 {
        match self.box_filtered {
            true => self.mean(x, y),
            false => self.sharp(x, y),
        }
    }

    // By itself: it would be in many places, and make them large.
    #[inline(never)]
    fn mean(&self, x: i32, y: i32) -> u8 {
        mean_of_nine(self.around(x, y))
    }

    /// As [`Frame::luma`] of a box_filtered frame, for a pixel at a [`place`](Self::place) that is not on the
    /// border.
    #[inline]
    pub(crate) fn mean_at(&self, place: isize) -> u8 {
        mean_of_nine(self.nine(place))
    }

    /// As [`Frame::luma`] of the frame before it was box_filtered.
    #[inline]
    pub(crate) fn sharp(&self, x: i32, y: i32) -> u8 {
        // Not `clamp`, which panics where the compiler cannot see that the size is at least 1.
        let (x, y) = (x.min(self.width - 1).max(0), y.min(self.height - 1).max(0));
        self.luma_at(self.place(x, y))
    }

    /// Luma, before the frame was box_filtered, of a pixel and those right of it, below it and below that;
    /// beyond the border the nearest there is.
    #[inline]
    pub(crate) fn square(&self, x: i32, y: i32) -> [u8; 4] {
        if x >= 0 && y >= 0 && x < self.width - 1 && y < self.height - 1 {
            let at = self.place(x, y);
            let below = at + self.step_y;
            [at, at + self.step_x, below, below + self.step_x].map(|at| self.luma_at(at))
        } else {
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| self.sharp(x + dx, y + dy))
        }
    }

    /// Luma, before the frame was box_filtered, of a pixel and its eight neighbours, row by row; the rows may
    /// run from right to left.
    fn around(&self, x: i32, y: i32) -> [[u16; 3]; 3] {
        if x >= 1 && y >= 1 && x < self.width - 1 && y < self.height - 1 {
            return self.nine(self.place(x, y));
        }
        [-1, 0, 1].map(|dy| [-1, 0, 1].map(|dx| u16::from(self.sharp(x + dx, y + dy))))
    }

    /// As [`Frame::around`] for a pixel that is not on the border.
    #[inline]
    fn nine(&self, place: isize) -> [[u16; 3]; 3] {
        // Most frames: a row's bytes side by side.
        let packed = self.luma_bytes().filter(|_| self.step_x.abs() == 1);
        [-self.step_y, 0, self.step_y].map(|row| {
            let middle = place + row;
            match packed {
                Some(bytes) => {
                    let row = bytes.get((middle - 1) as usize..);
                    let row = row.and_then(|row| row.first_chunk()).copied();
                    row.unwrap_or([0; 3]).map(u16::from)
                }
                None => [-self.step_x, 0, self.step_x].map(|x| u16::from(self.luma_at(middle + x))),
            }
        })
    }

    /// How far a pixel is from what its neighbours promise: the absolute value of
    /// `[1 −2 1; −2 4 −2; 1 −2 1]`.
    pub(crate) fn roughness(&self, x: i32, y: i32) -> u16 {
        let rows = self.around(x, y);
        let [a, b, c] = rows.map(|[p, q, r]| (p + r) as i16 - 2 * q as i16);
        (a + c - 2 * b).unsigned_abs()
    }

    /// Where an upright pixel of the frame lies in its bytes.
    #[inline]
    pub(crate) fn place(&self, x: i32, y: i32) -> isize {
        self.origin + self.bytes_between(x, y)
    }

    /// Bytes from any pixel to the one this far right of and below it.
    #[inline]
    pub(crate) fn bytes_between(&self, right: i32, below: i32) -> isize {
        right as isize * self.step_x + below as isize * self.step_y
    }

    /// The bytes among which each pixel's luma is the one at its [`place`](Self::place), if one byte holds it.
    #[inline]
    pub(crate) fn luma_bytes(&self) -> Option<&'a [u8]> {
        match self.reading {
            Reading::Byte(offset) => self.data.get(offset..),
            _ => None,
        }
    }

    #[inline]
    fn luma_at(&self, place: isize) -> u8 {
        let at = place as usize;
        // `new` checked the bytes, so the fallback is never taken; it keeps panics out of the binary.
        let byte = |offset: usize| self.data.get(at + offset).copied().unwrap_or(0);
        match self.reading {
            Reading::Byte(offset) => byte(offset),
            Reading::Word(shift) => {
                let word = byte(0) as u32 | (byte(1) as u32) << 8;
                (word >> shift).min(255) as u8
            }
            // ITU-R BT.601 luma in 1/256.
            Reading::Rgb([r, g, b]) => {
                ((77 * byte(r) as u32 + 150 * byte(g) as u32 + 29 * byte(b) as u32 + 128) >> 8)
                    as u8
            }
        }
    }
}

/// Of rows of luma, rounded.
#[inline]
fn mean_of_nine(rows: [[u16; 3]; 3]) -> u8 {
    let sum: u16 = rows.map(|[a, b, c]| a + b + c).iter().sum();
    // Exact for all sums of nine bytes.
    (((u32::from(sum) + 4) * 7282) >> 16) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn rejects_what_does_not_fit() {
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
    fn turns_and_mirrors() {
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
    fn reads_luma_of_every_format() {
        for (format, _) in PixelFormat::FOURCC {
            let mut bytes = [0u8; 8];
            match format.reading() {
                Reading::Byte(at) => bytes[format.pixel_bytes() + at] = 200,
                Reading::Word(shift) => {
                    let word = (200u16 << shift).to_le_bytes();
                    bytes[2..4].copy_from_slice(&word);
                }
                Reading::Rgb(at) => at
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
