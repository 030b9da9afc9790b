//! Where frames come from: files, folders, pipes and cameras, all as one stream of pictures.

mod camera;
mod ffmpeg;
mod images;
mod y4m;

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use anyhow::{Context, Result, bail};
use flate2::bufread::MultiGzDecoder;

pub use self::images::{is_image, read_rgb};
pub use self::y4m::Y4mSource;
use crate::picture::Picture;

/// A stream of pictures with increasing timestamps.
pub trait Source {
    /// The next picture, `None` at the end.
    fn next(&mut self) -> Result<Option<Picture>>;

    /// Frames per second; of a camera, the nominal value.
    fn fps(&self) -> f64;

    /// Frames to come in all, where that is known beforehand.
    fn total(&self) -> Option<u64> {
        None
    }

    /// Whether frames come as they happen, so that output must not be held back.
    fn is_live(&self) -> bool {
        false
    }

    /// Something that went wrong without ending the stream, once it has ended.
    fn warning(&self) -> Option<String> {
        None
    }
}

/// Time of frame `index` at `num / den` frames per second \[µs\].
pub fn timestamp_us(index: u64, num: u64, den: u64) -> i64 {
    (u128::from(index) * 1_000_000 * u128::from(den) / u128::from(num.max(1))) as i64
}

/// Opens INPUT of `posewise track`: `-`, `/dev/videoN`, a folder, a glob, y4m or any video file.
/// `image_fps` times the pictures of a folder or glob.
pub fn open(input: &str, image_fps: f64) -> Result<Box<dyn Source>> {
    if input == "-" {
        let reader = sniff_gzip(std::io::stdin().lock())?;
        return Ok(Box::new(Y4mSource::new(reader, "standard input")?));
    }
    if input.starts_with("/dev/video") {
        return camera::open(input);
    }
    let path = Path::new(input);
    if path.is_dir() {
        return Ok(Box::new(images::ImageSource::folder(path, image_fps)?));
    }
    if !path.exists() {
        if input.contains(['*', '?', '[']) {
            return Ok(Box::new(images::ImageSource::glob(input, image_fps)?));
        }
        bail!("no such file or folder: {input}");
    }
    if std::fs::metadata(path)?.len() == 0 {
        bail!("{input} is empty");
    }
    let lower = input.to_lowercase();
    if lower.ends_with(".y4m") || lower.ends_with(".y4m.gz") {
        let file = std::fs::File::open(path).with_context(|| format!("cannot open {input}"))?;
        let plain_len = (!lower.ends_with(".gz")).then(|| file.metadata().map_or(0, |m| m.len()));
        let reader = sniff_gzip(BufReader::new(file))?;
        return Ok(Box::new(
            Y4mSource::new(reader, input)?.with_file_len(plain_len),
        ));
    }
    if images::is_image(path) {
        return Ok(Box::new(images::ImageSource::single(path, image_fps)?));
    }
    Ok(Box::new(ffmpeg::FfmpegSource::open(path)?))
}

/// Unpacks what starts with gzip's magic, passes the rest through.
pub fn sniff_gzip(mut reader: impl BufRead + 'static) -> Result<Box<dyn Read>> {
    let start = reader.fill_buf().context("cannot read the input")?;
    Ok(if start.starts_with(&[0x1f, 0x8b]) {
        Box::new(BufReader::with_capacity(
            1 << 16,
            MultiGzDecoder::new(reader),
        ))
    } else {
        Box::new(reader)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timestamps_follow_the_rate() {
        assert_eq!(timestamp_us(0, 30, 1), 0);
        assert_eq!(timestamp_us(1, 30, 1), 33_333);
        assert_eq!(timestamp_us(30, 30, 1), 1_000_000);
        assert_eq!(timestamp_us(30_000, 30_000, 1001), 1_001_000_000);
    }
}
