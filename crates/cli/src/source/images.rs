//! Still pictures as a stream: a folder, a glob or one file, in the order of their names.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use image::RgbImage;

use super::exif::focal_px;
use super::stream::Source;
use crate::picture::Picture;

/// File name extensions that are read as pictures.
pub const EXTENSIONS: [&str; 8] = ["bmp", "jpeg", "jpg", "pbm", "pgm", "png", "ppm", "webp"];

/// Most pixels of a picture. Chosen: more than cameras have.
const MAX_PIXELS: u64 = 128_000_000;
/// Most memory for a pixel while a picture is decoded \[bytes\].
const PIXEL_BYTES: u64 = 12;
/// Most memory beside its pixels, as for a colour profile \[bytes\]. Chosen.
const MAX_EXTRA: u64 = 32 << 20;

/// Whether the file's name is that of a picture.
pub fn is_image(path: &Path) -> bool {
    path.extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| EXTENSIONS.contains(&e.to_lowercase().as_str()))
}

/// Decodes one picture; the file's content decides the format, not its name.
pub fn read_rgb(path: &Path) -> Result<RgbImage> {
    let reader = |pixels: u64| -> Result<_> {
        let mut reader = image::ImageReader::open(path)
            .with_context(|| format!("cannot open picture {}", path.display()))?
            .with_guessed_format()
            .with_context(|| format!("cannot read picture {}", path.display()))?;
        let mut limits = image::Limits::no_limits();
        limits.max_alloc = Some(MAX_EXTRA + pixels * PIXEL_BYTES);
        reader.limits(limits);
        Ok(reader)
    };
    let cannot_decode = || format!("cannot decode picture {}", path.display());
    // Before anything is decoded: a small file may describe a picture of any size.
    let (width, height) = reader(0)?.into_dimensions().with_context(cannot_decode)?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MAX_PIXELS {
        bail!(
            "picture {}: {width}×{height} px are more than {MAX_PIXELS} pixels",
            path.display()
        );
    }
    let image = reader(pixels)?.decode().with_context(cannot_decode)?;
    Ok(image.into_rgb8())
}

/// Pictures of a list of files.
pub struct ImageSource {
    files: Vec<PathBuf>,
    fps: f64,
    index: usize,
}

impl ImageSource {
    /// All pictures directly in a folder.
    pub fn folder(path: &Path, fps: f64) -> Result<Self> {
        let entries = std::fs::read_dir(path)
            .with_context(|| format!("cannot list folder {}", path.display()))?;
        let mut files = Vec::new();
        for entry in entries {
            let file = entry?.path();
            if file.is_file() && is_image(&file) {
                files.push(file);
            }
        }
        Self::of(files, fps, || format!("folder {}", path.display()))
    }

    /// All pictures that a pattern with `*`, `?` or `[…]` matches.
    pub fn glob(pattern: &str, fps: f64) -> Result<Self> {
        let paths = glob::glob(pattern).with_context(|| format!("bad pattern {pattern}"))?;
        let files = paths
            .filter_map(Result::ok)
            .filter(|p| p.is_file() && is_image(p))
            .collect();
        Self::of(files, fps, || format!("pattern {pattern}"))
    }

    /// One picture.
    pub fn single(path: &Path, fps: f64) -> Result<Self> {
        Self::of(vec![path.to_path_buf()], fps, String::new)
    }

    fn of(mut files: Vec<PathBuf>, fps: f64, name: impl Fn() -> String) -> Result<Self> {
        if files.is_empty() {
            bail!("{} has no pictures ({})", name(), EXTENSIONS.join(", "));
        }
        files.sort();
        Ok(ImageSource {
            files,
            fps,
            index: 0,
        })
    }
}

impl Source for ImageSource {
    fn next(&mut self) -> Result<Option<Picture>> {
        let Some(file) = self.files.get(self.index) else {
            return Ok(None);
        };
        let mut picture = Picture::from_rgb(read_rgb(file)?);
        picture.focal_px = focal_px(file, picture.layout.width, picture.layout.height);
        picture.timestamp_us = (self.index as f64 * 1e6 / self.fps) as i64;
        self.index += 1;
        Ok(Some(picture))
    }

    fn fps(&self) -> f64 {
        self.fps
    }

    fn total(&self) -> Option<u64> {
        Some(self.files.len() as u64)
    }
}
