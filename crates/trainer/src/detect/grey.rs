//! Grey pictures in memory, viewed as the core's frames.

use std::path::Path;

use anyhow::{Context, Result};
use posewise::image::{Frame, FrameLayout};

/// A grey picture.
#[derive(Clone)]
pub struct Grey {
    pub width: u32,
    pub height: u32,
    pub luma: Vec<u8>,
}

impl Grey {
    /// Reads any picture file.
    ///
    /// # Errors
    /// When it cannot be read or decoded.
    pub fn open(path: &Path) -> Result<Grey> {
        let picture = image::open(path).with_context(|| path.display().to_string())?;
        let picture = picture.into_luma8();
        Ok(Grey {
            width: picture.width(),
            height: picture.height(),
            luma: picture.into_raw(),
        })
    }

    /// The core's view of it.
    pub fn frame(&self) -> Frame<'_> {
        Frame::new(&FrameLayout::grey(self.width, self.height), &self.luma)
            .expect("a grey picture is a frame")
    }

    /// Each pixel the mean of 2×2.
    pub fn halved(&self) -> Grey {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let frame = self.frame();
        let luma = (0..height as i32)
            .flat_map(|y| (0..width as i32).map(move |x| (2 * x, 2 * y)))
            .map(|(x, y)| {
                let at = |dx, dy| frame.luma(x + dx, y + dy) as u32;
                ((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8
            })
            .collect();
        Grey {
            width,
            height,
            luma,
        }
    }

    /// Each pixel the mean of (2 radius + 1)².
    pub fn blurred(&self, radius: i32) -> Grey {
        let frame = self.frame();
        let area = ((2 * radius + 1) * (2 * radius + 1)) as u32;
        let luma = (0..self.height as i32)
            .flat_map(|y| (0..self.width as i32).map(move |x| (x, y)))
            .map(|(x, y)| {
                let sum: u32 = (-radius..=radius)
                    .flat_map(|dy| (-radius..=radius).map(move |dx| (dx, dy)))
                    .map(|(dx, dy)| frame.luma(x + dx, y + dy) as u32)
                    .sum();
                (sum / area) as u8
            })
            .collect();
        Grey {
            luma,
            ..Grey {
                width: self.width,
                height: self.height,
                luma: Vec::new(),
            }
        }
    }
}
