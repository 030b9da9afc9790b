//! Tracking and searching steps at the frame sizes of cameras.
//!
//! Searching happens in clutter: pictures without a face that have much texture, in which the
//! detector finds candidates that are none.

use std::path::Path;

use anyhow::Result;
use image::GrayImage;
use image::imageops::crop_imm;
use posewise::Model;
use serde_json::{Value, json};

use super::steps::{Kind, Steps};
use crate::footage::backgrounds::{covering, held_out, open, window};
use crate::random::Random;

/// QVGA to 4K.
const SIZES: [(u32, u32); 5] = [
    (320, 240),
    (640, 480),
    (1280, 720),
    (1920, 1080),
    (3840, 2160),
];
/// Pictures of clutter at each size.
const PICTURES: usize = 6;
/// Steps on each picture.
const STEPS: usize = 12;
/// Frames of the clip that are tracked at each size.
const FRAMES: usize = 12;
/// Steps on the clip's first frame, in which a large face is found at any size.
const FIND: usize = 40;
/// Side of the blocks of clutter that is made of a clip \[px\].
const BLOCK: u32 = 16;
const SEED: u64 = 2;

/// Times of tracking and searching steps at each size, as JSON.
pub fn time(model: &Model<'_>, clip: &[GrayImage], clutter: Option<&Path>) -> Result<Vec<Value>> {
    let pictures = match clutter {
        Some(folder) => read(folder)?,
        None => Vec::new(),
    };
    SIZES
        .iter()
        .map(|size| {
            let cluttered: Vec<GrayImage> = match pictures.is_empty() {
                true => (0..PICTURES).map(|k| scattered(clip, *size, k)).collect(),
                false => pictures.iter().map(|p| covered(p, *size)).collect(),
            };
            let searching = Steps::time(model, || repeated(&cluttered, STEPS))?;
            let shown: Vec<GrayImage> = clip
                .iter()
                .take(FRAMES)
                .map(|f| covered(f, *size))
                .collect();
            let tracking = Steps::time(model, || {
                let first = shown.first().into_iter().cloned();
                first.cycle().take(FIND).chain(shown.iter().cloned())
            })?;
            Ok(row(*size, &tracking, &searching))
        })
        .collect()
}

fn row(size: (u32, u32), tracking: &Steps, searching: &Steps) -> Value {
    let tracking = tracking.of(Some(Kind::Tracking));
    let searching = searching.of(Some(Kind::Searching));
    let both = searching.quantile(0.99).zip(tracking.quantile(0.5));
    json!({
        "frame": size,
        "tracking": tracking.json(),
        "searching": searching.json(),
        "searching_p99_over_tracking": both.map(|(s, t)| s as f64 / t.max(1) as f64),
    })
}

/// The first pictures of a folder that no training used, as `eval faceless` shows them.
fn read(folder: &Path) -> Result<Vec<GrayImage>> {
    let paths = held_out(folder)?;
    paths.iter().take(PICTURES).map(|path| open(path)).collect()
}

fn covered(image: &GrayImage, size: (u32, u32)) -> GrayImage {
    window(&covering(image, size), size, 0.5)
}

/// How often each picture is shown.
fn repeated(pictures: &[GrayImage], times: usize) -> impl Iterator<Item = GrayImage> {
    let repeat = move |picture: &GrayImage| std::iter::repeat_n(picture.clone(), times);
    pictures.iter().flat_map(repeat)
}

/// A frame made of blocks of one of the clip's, in a random order.
fn scattered(clip: &[GrayImage], (width, height): (u32, u32), picture: usize) -> GrayImage {
    let from = &clip[picture * clip.len() / PICTURES];
    let mut random = Random::of(SEED + picture as u64);
    let mut out = GrayImage::new(width, height);
    for y in (0..height).step_by(BLOCK as usize) {
        for x in (0..width).step_by(BLOCK as usize) {
            let mut along = |length: u32| {
                let blocks = (length / BLOCK).max(1) as usize;
                random.below(blocks) as u32 * BLOCK
            };
            let (across, down) = (along(from.width()), along(from.height()));
            let block = crop_imm(from, across, down, BLOCK, BLOCK).to_image();
            image::imageops::replace(&mut out, &block, i64::from(x), i64::from(y));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clutter_is_made_of_the_clips_pixels() {
        let clip: Vec<GrayImage> = (0..PICTURES as u32)
            .map(|k| {
                GrayImage::from_fn(32, 48, |x, y| {
                    image::Luma([(k * 10 + x / 16 + y / 16) as u8])
                })
            })
            .collect();
        for k in 0..PICTURES {
            let picture = scattered(&clip, (50, 40), k);
            assert_eq!(picture.dimensions(), (50, 40));
            assert_eq!(picture, scattered(&clip, (50, 40), k));
            let allowed = k as u8 * 10..k as u8 * 10 + 4;
            assert!(picture.pixels().all(|p| allowed.contains(&p.0[0])));
        }
    }

    #[test]
    fn pictures_are_repeated_in_order() {
        let pictures = [GrayImage::new(1, 1), GrayImage::new(2, 1)];
        let widths: Vec<u32> = repeated(&pictures, 2).map(|p| p.width()).collect();
        assert_eq!(widths, [1, 1, 2, 2]);
    }
}
