//! A clip in memory, grey and upright, to be shown in another order, moved or mirrored.

use anyhow::{Result, bail};
use image::GrayImage;
use posewise_cli::source::{self, Source};

/// Frames with their rate.
pub struct Clip {
    /// The frames' luma; never empty.
    pub frames: Vec<GrayImage>,
    /// Frames per second.
    pub fps: f64,
}

impl Clip {
    /// The first frames of any input of `track`, `most` at most; pictures come at this rate.
    pub fn open(input: &str, fps: f64, most: usize) -> Result<Self> {
        Clip::read(source::open(input, fps)?.as_mut(), most, input)
    }

    /// The first frames of a source, `most` at most; `name` is for messages.
    pub fn read(source: &mut dyn Source, most: usize, name: &str) -> Result<Self> {
        let mut frames = Vec::new();
        while frames.len() < most {
            let Some(picture) = source.next()? else { break };
            frames.push(picture.upright_grey()?);
        }
        if frames.is_empty() {
            bail!("{name} has no frames");
        }
        Ok(Clip {
            frames,
            fps: source.fps(),
        })
    }
}

/// Index of step `i` when `n` frames are shown forwards, backwards, forwards …
pub fn back_and_forth(i: usize, n: usize) -> usize {
    let period = (2 * n).saturating_sub(2).max(1);
    let at = i % period;
    if at < n { at } else { period - at }
}

/// The picture moved to the right and down \[px\]; its edges are repeated.
pub fn moved(image: &GrayImage, right: i32, down: i32) -> GrayImage {
    let (width, height) = image.dimensions();
    let from = |at: u32, by: i32, len: u32| {
        let at = i64::from(at) - i64::from(by);
        at.clamp(0, i64::from(len) - 1) as u32
    };
    GrayImage::from_fn(width, height, |x, y| {
        *image.get_pixel(from(x, right, width), from(y, down, height))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_go_back_and_forth() {
        let order: Vec<usize> = (0..8).map(|i| back_and_forth(i, 4)).collect();
        assert_eq!(order, [0, 1, 2, 3, 2, 1, 0, 1]);
        assert_eq!(back_and_forth(5, 1), 0);
    }

    #[test]
    fn moving_repeats_the_edges() {
        let image = GrayImage::from_raw(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap();
        assert_eq!(moved(&image, 1, 0).into_raw(), [1, 1, 2, 4, 4, 5]);
        assert_eq!(moved(&image, -2, 0).into_raw(), [3, 3, 3, 6, 6, 6]);
        assert_eq!(moved(&image, 0, -1).into_raw(), [4, 5, 6, 4, 5, 6]);
    }
}
