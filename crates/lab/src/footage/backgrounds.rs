//! Pictures without people, by default those that training never used.
//!
//! Training takes the usable pictures of such a folder in the order of their names and leaves out
//! each fifth (index 4, 9, 14 …). The default here is that fifth, because a picture that was a
//! negative in training says little.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use image::GrayImage;
use image::imageops::{FilterType, crop_imm, resize};
use posewise_cli::source::is_image;

pub use crate::product::read_luma as open;

/// Pictures without people.
#[derive(clap::Args)]
pub struct BackgroundsArgs {
    /// Folder of pictures; those that its file with-people.txt names are left out
    #[arg(long, value_name = "DIR")]
    pub backgrounds: PathBuf,
    /// Take one picture in N, in the order of their names; 1 for all. Training leaves out one
    /// of five
    #[arg(long, value_name = "N", default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// Which one of them, from 0 [default: the last, which training leaves out]
    #[arg(long, value_name = "K")]
    pub offset: Option<u32>,
}

/// Names, one a line, of pictures with people in them.
const LISTED: &str = "with-people.txt";

/// The pictures to use, in the order of their names; at least one.
pub fn list(args: &BackgroundsArgs) -> Result<Vec<PathBuf>> {
    let folder = args.backgrounds.display();
    let every = args.every as usize;
    let offset = args.offset.map_or(every - 1, |k| k as usize);
    if offset >= every {
        bail!("--offset must be less than --every");
    }
    let people = with_people(&args.backgrounds.join(LISTED))?;
    let entries = std::fs::read_dir(&args.backgrounds)
        .with_context(|| format!("cannot list folder {folder}"))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if is_image(&path) && !people.contains(name.as_ref()) {
            paths.push(path);
        }
    }
    paths.sort();
    let usable = paths.len();
    let chosen: Vec<PathBuf> = paths.into_iter().skip(offset).step_by(every).collect();
    if chosen.is_empty() {
        bail!(
            "folder {folder} has {usable} pictures without people, too few for --every {every} \
             --offset {offset} (--every 1 takes all)"
        );
    }
    Ok(chosen)
}

/// Those of a folder that training leaves out.
pub fn held_out(folder: &Path) -> Result<Vec<PathBuf>> {
    list(&BackgroundsArgs {
        backgrounds: folder.to_path_buf(),
        every: 5,
        offset: None,
    })
}

fn with_people(path: &Path) -> Result<HashSet<String>> {
    if !path.exists() {
        return Ok(HashSet::new());
    }
    let text =
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(text.lines().map(|line| line.trim().to_string()).collect())
}

/// Scaled, with its proportions, to the least size that covers a frame.
pub fn covering(image: &GrayImage, (width, height): (u32, u32)) -> GrayImage {
    let scale = |frame: u32, own: u32| f64::from(frame) / f64::from(own.max(1));
    let scale = scale(width, image.width()).max(scale(height, image.height()));
    let side = |own: u32, least: u32| ((f64::from(own) * scale).round() as u32).max(least);
    let (w, h) = (side(image.width(), width), side(image.height(), height));
    resize(image, w, h, FilterType::Triangle)
}

/// A window of that size, `across` of the way from the upper left corner to the lower right (0..1).
pub fn window(image: &GrayImage, (width, height): (u32, u32), across: f64) -> GrayImage {
    let at =
        |own: u32, window: u32| (f64::from(own.saturating_sub(window)) * across).round() as u32;
    let (x, y) = (at(image.width(), width), at(image.height(), height));
    crop_imm(image, x, y, width, height).to_image()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_cover_the_frame() {
        let size = |w, h| covering(&GrayImage::new(w, h), (40, 30)).dimensions();
        assert_eq!(size(40, 30), (40, 30));
        assert_eq!(size(20, 10), (60, 30));
        assert_eq!(size(100, 200), (40, 80));
        assert_eq!(size(33, 25), (40, 30));
    }

    #[test]
    fn windows_go_from_corner_to_corner() {
        let image = GrayImage::from_fn(6, 4, |x, y| image::Luma([(10 * y + x) as u8]));
        let corner = |across| window(&image, (4, 2), across).into_raw()[0];
        assert_eq!([corner(0.0), corner(0.5), corner(1.0)], [0, 11, 22]);
    }

    #[test]
    fn one_of_five_without_people() {
        let dir = tempfile::tempdir().unwrap();
        for i in 0..12 {
            std::fs::write(dir.path().join(format!("{i:02}.jpg")), "").unwrap();
        }
        std::fs::write(dir.path().join(LISTED), "02.jpg\n 11.jpg\n").unwrap();
        let names = |every, offset| -> Result<Vec<String>> {
            let backgrounds = dir.path().to_path_buf();
            let args = BackgroundsArgs {
                backgrounds,
                every,
                offset,
            };
            let name = |p: &PathBuf| p.file_stem().unwrap().to_string_lossy().into_owned();
            Ok(list(&args)?.iter().map(name).collect())
        };
        assert_eq!(names(5, None).unwrap(), ["05", "10"]);
        assert_eq!(names(5, Some(0)).unwrap(), ["00", "06"]);
        assert_eq!(names(1, None).unwrap().len(), 10);
        assert!(names(5, Some(5)).is_err());
        assert!(names(20, None).is_err());
    }
}
