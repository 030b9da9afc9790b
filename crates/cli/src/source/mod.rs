//! Where frames come from: files, folders, pipes, cameras and addresses, all as one stream of
//! pictures.

mod address;
mod camera;
mod exif;
mod ffmpeg;
mod images;
mod patient;
mod stream;
mod y4m;

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use flate2::bufread::MultiGzDecoder;

use self::address::Address;
pub use self::images::{is_image, read_rgb};
pub use self::stream::Source;
pub use self::y4m::Y4mSource;

/// Opens INPUT of `posewise track`: `-`, `/dev/videoN`, a folder, a glob, y4m, any
/// video file, or an address.
/// `image_fps` times the pictures of a folder or glob.
pub fn open(input: &str, image_fps: f64) -> Result<Box<dyn Source>> {
    if input == "-" {
        let reader = sniff_gzip(std::io::stdin().lock())?;
        return Ok(Box::new(Y4mSource::new(reader, "standard input")?));
    }
    if input.starts_with("/dev/video") {
        return camera::open(input);
    }
    if let Some(address) = Address::parse(input)? {
        return Ok(Box::new(ffmpeg::FfmpegSource::open_address(address)?));
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
    let found = std::fs::metadata(path)?;
    if found.is_file() && found.len() == 0 {
        bail!("{input} is empty");
    }
    let lower = input.to_lowercase();
    if lower.ends_with(".y4m") || lower.ends_with(".y4m.gz") {
        let file = std::fs::File::open(path).with_context(|| format!("cannot open {input}"))?;
        let is_plain = found.is_file() && !lower.ends_with(".gz");
        let plain_len = is_plain.then_some(found.len());
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

/// The files that INPUT names, and the folders of those that a pattern or folder gives.
pub fn files(input: &str) -> Vec<PathBuf> {
    if input == "-" || Address::parse(input).is_ok_and(|address| address.is_some()) {
        return Vec::new();
    }
    let path = Path::new(input);
    if path.is_dir() {
        let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
        return std::iter::once(path.to_path_buf())
            .chain(entries.map(|entry| entry.path()))
            .collect();
    }
    match input.contains(['*', '?', '[']) && !path.exists() {
        true => (glob::glob(input).into_iter().flatten())
            .filter_map(Result::ok)
            .flat_map(|file| {
                let folder = file.parent().map(Path::to_path_buf);
                folder.into_iter().chain([file])
            })
            .collect(),
        false => vec![path.to_path_buf()],
    }
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
