//! One decoded frame on its way from a source to the tracker and the overlay.
//!
//! The tracker reads the luma through [`Picture::frame`] without a copy; the overlay asks for an
//! upright RGB copy.

use anyhow::{Result, anyhow};
use image::{GrayImage, RgbImage};
use posewise::{Frame, FrameLayout, PixelFormat, Rotation};

/// How the bytes after a picture's luma say its colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chroma {
    /// Not kept, or the pixel format is itself RGB.
    None,
    /// Planar U and V after the luma plane, subsampled by these factors across and down.
    Planar { across: u32, down: u32 },
}

/// Pixels with their layout.
#[derive(Clone, Debug)]
pub struct Picture {
    /// How `data` is laid out, and the turn and mirroring that make it upright.
    pub layout: FrameLayout,
    /// The bytes.
    pub data: Vec<u8>,
    /// What follows the luma plane.
    pub chroma: Chroma,
    /// Whether luma spans 0..255 rather than 16..235; only the overlay's colours depend on it.
    pub full_range: bool,
    /// Capture time \[µs\].
    pub timestamp_us: i64,
    /// Focal length of the camera \[px\], where the file says it.
    pub focal_px: Option<f32>,
}

impl Picture {
    /// Bytes without planes of chroma, at time 0.
    fn packed(layout: FrameLayout, data: Vec<u8>) -> Self {
        Picture {
            layout,
            data,
            chroma: Chroma::None,
            full_range: true,
            timestamp_us: 0,
            focal_px: None,
        }
    }

    /// An upright RGB picture at time 0.
    pub fn from_rgb(image: RgbImage) -> Self {
        let layout = FrameLayout::new(PixelFormat::Rgb24, image.width(), image.height());
        Picture::packed(layout, image.into_raw())
    }

    /// An upright grey picture at time 0.
    pub fn from_grey(image: GrayImage) -> Self {
        let layout = FrameLayout::grey(image.width(), image.height());
        Picture::packed(layout, image.into_raw())
    }

    /// The tracker's view of the bytes.
    pub fn frame(&self) -> Result<Frame<'_>> {
        Frame::new(&self.layout, &self.data).map_err(|e| anyhow!("{e}"))
    }

    /// An upright copy of the luma that the tracker sees.
    pub fn upright_grey(&self) -> Result<GrayImage> {
        let frame = self.frame()?;
        let size = (frame.width() as u32, frame.height() as u32);
        Ok(GrayImage::from_fn(size.0, size.1, |x, y| {
            image::Luma([frame.luma(x as i32, y as i32)])
        }))
    }

    /// An upright copy in colour, or in grey where the source has no colour.
    pub fn upright_rgb(&self) -> Result<RgbImage> {
        let (width, height) = (self.layout.width, self.layout.height);
        let stored = if let Chroma::Planar { across, down } = self.chroma {
            self.planar_rgb(across.max(1), down.max(1))
        } else if self.layout.format == PixelFormat::Rgb24 && self.layout.stride == 3 * width {
            RgbImage::from_raw(width, height, self.data.clone())
                .ok_or_else(|| anyhow!("the picture's bytes end before its last row"))?
        } else {
            let mut plain = self.layout;
            plain.rotation = Rotation::None;
            plain.mirrored = false;
            let frame = Frame::new(&plain, &self.data).map_err(|e| anyhow!("{e}"))?;
            RgbImage::from_fn(width, height, |x, y| {
                let luma = frame.luma(x as i32, y as i32);
                image::Rgb([luma; 3])
            })
        };
        let stored = if self.layout.mirrored {
            image::imageops::flip_horizontal(&stored)
        } else {
            stored
        };
        Ok(match self.layout.rotation {
            Rotation::None => stored,
            Rotation::Cw90 => image::imageops::rotate90(&stored),
            Rotation::Half => image::imageops::rotate180(&stored),
            Rotation::Cw270 => image::imageops::rotate270(&stored),
        })
    }

    /// ITU-R BT.601 from planar YUV.
    fn planar_rgb(&self, across: u32, down: u32) -> RgbImage {
        let (width, height) = (self.layout.width, self.layout.height);
        let stride = self.layout.stride as usize;
        let (cw, ch) = (
            width.div_ceil(across) as usize,
            height.div_ceil(down) as usize,
        );
        let luma_len = stride * height as usize;
        let at = |i: usize, default: u8| f32::from(self.data.get(i).copied().unwrap_or(default));
        let (offset, luma_gain, chroma_gain) = if self.full_range {
            (0.0, 1.0, 1.0)
        } else {
            (16.0, 255.0 / 219.0, 255.0 / 224.0)
        };
        RgbImage::from_fn(width, height, |x, y| {
            let c = (y / down) as usize * cw + (x / across) as usize;
            let luma = (at(y as usize * stride + x as usize, 0) - offset) * luma_gain;
            let u = (at(luma_len + c, 128) - 128.0) * chroma_gain;
            let v = (at(luma_len + cw * ch + c, 128) - 128.0) * chroma_gain;
            let byte = |value: f32| value.round().clamp(0.0, 255.0) as u8;
            image::Rgb([
                byte(luma + 1.402 * v),
                byte(luma - 0.344_136 * u - 0.714_136 * v),
                byte(luma + 1.772 * u),
            ])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planar_colours_come_back() {
        // One 2×2 block of pure red in limited range: Y 81, U 90, V 240.
        let picture = Picture {
            chroma: Chroma::Planar { across: 2, down: 2 },
            full_range: false,
            ..Picture::packed(FrameLayout::grey(2, 2), vec![81, 81, 81, 81, 90, 240])
        };
        let rgb = picture.upright_rgb().unwrap();
        let [r, g, b] = rgb.get_pixel(1, 1).0;
        assert!(r > 250 && g < 5 && b < 5, "{r} {g} {b}");
    }

    #[test]
    fn upright_copy_agrees_with_the_trackers_view() {
        for rotation in [
            Rotation::None,
            Rotation::Cw90,
            Rotation::Half,
            Rotation::Cw270,
        ] {
            for mirrored in [false, true] {
                let mut layout = FrameLayout::grey(3, 2);
                layout.rotation = rotation;
                layout.mirrored = mirrored;
                let picture = Picture::packed(layout, vec![0, 10, 20, 30, 40, 50]);
                let (frame, rgb) = (picture.frame().unwrap(), picture.upright_rgb().unwrap());
                let grey = picture.upright_grey().unwrap();
                assert_eq!(
                    (frame.width() as u32, frame.height() as u32),
                    rgb.dimensions()
                );
                for (x, y, pixel) in rgb.enumerate_pixels() {
                    assert_eq!(pixel.0[0], frame.luma(x as i32, y as i32));
                    assert_eq!(pixel.0[0], grey.get_pixel(x, y).0[0]);
                }
            }
        }
    }
}
