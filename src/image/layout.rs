//! How the caller stores a frame: format, size, stride, rotation and mirroring.

use super::PixelFormat;

/// Longest side of a frame \[px\]; keeps every fixed-point coordinate inside 32 bits.
pub const MAX_SIDE: u32 = 16_384;

/// Clockwise rotation that makes the stored image upright.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Rotation {
    /// Stored upright.
    #[default]
    None,
    /// Rotate by 90° clockwise.
    Cw90,
    /// Rotate by 180°.
    Half,
    /// Rotate by 270° clockwise.
    Cw270,
}

/// Where the pixels lie in the caller's bytes.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FrameLayout {
    /// Pixel format.
    pub format: PixelFormat,
    /// Stored width \[px\], 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Stored height \[px\], 1 to [`MAX_SIDE`].
    pub height: u32,
    /// Bytes from row to row (V4L2 `bytesperline`).
    pub stride: u32,
    /// Rotation that makes the stored image upright.
    pub rotation: Rotation,
    /// Whether the stored image is mirrored left to right (a "selfie" preview). Mirroring is undone
    /// before the rotation, so that the person's left stays the left.
    pub mirrored: bool,
}

impl FrameLayout {
    /// An upright picture without padding between rows.
    pub fn new(format: PixelFormat, width: u32, height: u32) -> Self {
        FrameLayout {
            format,
            width,
            height,
            stride: width.saturating_mul(format.pixel_bytes() as u32),
            rotation: Rotation::None,
            mirrored: false,
        }
    }

    /// An upright grey image without padding between rows.
    pub fn grey(width: u32, height: u32) -> Self {
        FrameLayout::new(PixelFormat::Grey, width, height)
    }
}

/// Why bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
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

/// Byte offsets of the upright, unmirrored pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Addressing {
    /// Upright width and height \[px\].
    pub width: i32,
    pub height: i32,
    /// Byte offset of the upright pixel (0, 0).
    pub origin: isize,
    /// Bytes to the upright neighbour on the right.
    pub step_x: isize,
    /// Bytes to the upright neighbour below.
    pub step_y: isize,
}

impl Addressing {
    /// Checks that format, size, stride and the number of bytes agree.
    pub fn new(layout: &FrameLayout, data_len: usize) -> Result<Addressing, FrameError> {
        let FrameLayout {
            format,
            width,
            height,
            stride,
            ..
        } = *layout;
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            return Err(FrameError::Size);
        }
        let row = width as u64 * format.pixel_bytes() as u64;
        if (stride as u64) < row {
            return Err(FrameError::Stride);
        }
        // The last row need not be padded to the stride.
        let needed = stride as u64 * (height as u64 - 1) + row;
        if (data_len as u64) < needed || needed > isize::MAX as u64 {
            return Err(FrameError::Length);
        }
        Ok(Self::of_checked(layout))
    }

    fn of_checked(layout: &FrameLayout) -> Addressing {
        let (w, h) = (layout.width as isize - 1, layout.height as isize - 1);
        let pixel = layout.format.pixel_bytes() as isize;
        let stride = layout.stride as isize;
        // Upright (x, y) → stored column and row: the origin and the steps along x and y.
        let ((c0, r0), (cx, rx), (cy, ry)) = match layout.rotation {
            Rotation::None => ((0, 0), (1, 0), (0, 1)),
            Rotation::Cw90 => ((0, h), (0, -1), (1, 0)),
            Rotation::Half => ((w, h), (-1, 0), (0, -1)),
            Rotation::Cw270 => ((w, 0), (0, 1), (-1, 0)),
        };
        let (c0, cx, cy) = if layout.mirrored {
            (w - c0, -cx, -cy)
        } else {
            (c0, cx, cy)
        };
        let (width, height) = match layout.rotation {
            Rotation::Cw90 | Rotation::Cw270 => (layout.height, layout.width),
            Rotation::None | Rotation::Half => (layout.width, layout.height),
        };
        Addressing {
            width: width as i32,
            height: height as i32,
            origin: c0 * pixel + r0 * stride,
            step_x: cx * pixel + rx * stride,
            step_y: cy * pixel + ry * stride,
        }
    }
}
