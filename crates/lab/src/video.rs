//! Luma of the frames of videos, as `posewise track` sees it.

use anyhow::{Context, Result, anyhow};
use image::GrayImage;
use posewise::image::{Frame, FrameLayout};
use posewise_cli::source;
use std::path::Path;

/// Frames per second of a folder of pictures; nothing here depends on it.
const FPS: f64 = 30.0;

/// The frames of any INPUT of `posewise track` that is a file.
pub fn frames(path: &Path) -> Result<impl Iterator<Item = Result<GrayImage>>> {
    let name = path.to_str().context("a path that is no text")?;
    let mut source = source::open(name, FPS)?;
    Ok(std::iter::from_fn(move || match source.next() {
        Ok(picture) => picture.map(|picture| picture.upright_grey()),
        Err(error) => Some(Err(error)),
    }))
}

/// Luma as the library takes it.
pub fn frame(luma: &GrayImage) -> Result<Frame<'_>> {
    let layout = FrameLayout::grey(luma.width(), luma.height());
    Frame::new(&layout, luma).map_err(|e| anyhow!("{e}"))
}
