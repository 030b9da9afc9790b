//! Pixel formats: how far apart the pixels lie in memory and how their bytes become luma.

/// Memory layout of a frame's luma; the names and codes are those of V4L2 (see
/// [`PixelFormat::FOURCC`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
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
        // V4L2 names these by the order in a 32-bit word, this enum by the order in memory.
        (PixelFormat::Rgbx32, fourcc(b"XB24")),
        (PixelFormat::Rgbx32, fourcc(b"AB24")),
        (PixelFormat::Bgrx32, fourcc(b"XR24")),
        (PixelFormat::Bgrx32, fourcc(b"AR24")),
        (PixelFormat::Xrgb32, fourcc(b"BX24")),
        (PixelFormat::Xrgb32, fourcc(b"BA24")),
        (PixelFormat::Xbgr32, fourcc(b"RX24")),
        (PixelFormat::Xbgr32, fourcc(b"RA24")),
    ];

    /// The format of a V4L2 fourcc code; `None` if posewise does not read it.
    pub fn from_fourcc(code: u32) -> Option<PixelFormat> {
        Self::FOURCC
            .iter()
            .find(|(_, known)| *known == code)
            .map(|(format, _)| *format)
    }

    /// Bytes from one pixel's luma to the next in its row.
    pub(super) const fn pixel_bytes(self) -> usize {
        match self {
            PixelFormat::Grey | PixelFormat::Nv12 | PixelFormat::Nv21 | PixelFormat::Yu12 => 1,
            PixelFormat::Y10 | PixelFormat::Y16 | PixelFormat::Yuyv | PixelFormat::Uyvy => 2,
            PixelFormat::Rgb24 | PixelFormat::Bgr24 => 3,
            _ => 4,
        }
    }

    /// How the bytes of a pixel become luma.
    pub(super) const fn encoding(self) -> LumaEncoding {
        match self {
            PixelFormat::Uyvy => LumaEncoding::Byte(1),
            PixelFormat::Y10 => LumaEncoding::Word(2),
            PixelFormat::Y16 => LumaEncoding::Word(8),
            PixelFormat::Rgb24 | PixelFormat::Rgbx32 => LumaEncoding::Rgb([0, 1, 2]),
            PixelFormat::Bgr24 | PixelFormat::Bgrx32 => LumaEncoding::Rgb([2, 1, 0]),
            PixelFormat::Xrgb32 => LumaEncoding::Rgb([1, 2, 3]),
            PixelFormat::Xbgr32 => LumaEncoding::Rgb([3, 2, 1]),
            _ => LumaEncoding::Byte(0),
        }
    }
}

/// Where the luma of a pixel is, in bytes from the pixel's first byte.
#[derive(Clone, Copy, Debug)]
pub(super) enum LumaEncoding {
    /// One byte at this offset.
    Byte(usize),
    /// A little-endian 16-bit word, shifted right by this many bits, saturated to 255.
    Word(u32),
    /// Offsets of red, green and blue.
    Rgb([usize; 3]),
}
