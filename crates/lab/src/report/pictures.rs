//! Pictures of the page: worst frames, and frames of the clip of the scrubber.

use super::figures::{Figures, Worst};
use crate::compare::{Clip, Comparison};
use crate::video;
use anyhow::Result;
use image::GrayImage;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, crop_imm, resize};
use posewise_metrics::landmarks::bounds;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Side of the picture of a worst frame \[px\].
const WORST_PX: u32 = 220;
/// Side of what it shows, over the size of the true landmarks' box.
const MARGIN: f64 = 1.9;
/// Most pictures of the scrubber.
const MOST: usize = 100;
/// Width of the scrubber's pictures \[px\].
const SCRUB_PX: u32 = 320;
/// Of JPEG, 1 to 100.
const QUALITY: u8 = 60;

/// Bytes of a JPEG file.
pub type Jpeg = Vec<u8>;

/// All pictures.
pub struct Pictures {
    /// By system, in the order of its worst frames; `None` where the clip is not shown.
    pub worst: Vec<Vec<Option<Crop>>>,
    /// Of the scrubber's clip; empty if it is not shown.
    pub scrub: Vec<Jpeg>,
    /// Of the scrubber.
    pub geometry: Geometry,
}

/// How the scrubber's pictures lie in its clip.
#[derive(Serialize)]
pub struct Geometry {
    /// Frames from one picture to the next.
    pub every: usize,
    /// Size of a picture \[px\].
    pub width: u32,
    /// \[px\].
    pub height: u32,
    /// Pixels of a picture over those of the clip.
    pub scale: f64,
}

/// Part of a frame.
pub struct Crop {
    /// A square of [`WORST_PX`].
    pub jpeg: Jpeg,
    /// True and found landmarks, in pixels of it.
    pub points: [[[f64; 2]; 68]; 2],
}

/// Whether the description of a renderer lies beside a clip: it names a seed.
fn is_rendered(clip: &Clip) -> bool {
    let Ok(text) = std::fs::read_to_string(clip.beside("json")) else {
        return false;
    };
    let description: Option<Value> = serde_json::from_str(&text).ok();
    description.is_some_and(|d| d.get("seed").is_some())
}

impl Pictures {
    /// Decodes the clips that are shown.
    pub fn of(comparison: &Comparison, figures: &Figures, show_people: bool) -> Result<Pictures> {
        let mut pictures = Pictures {
            worst: (figures.systems.iter())
                .map(|s| s.worst.iter().map(|_| None).collect())
                .collect(),
            scrub: Vec::new(),
            geometry: Geometry {
                every: 1,
                width: SCRUB_PX,
                height: SCRUB_PX,
                scale: 1.0,
            },
        };
        for (number, clip) in comparison.clips.iter().enumerate() {
            if show_people || is_rendered(clip) {
                pictures.read(figures, number, clip)?;
            }
        }
        Ok(pictures)
    }

    fn read(&mut self, figures: &Figures, number: usize, clip: &Clip) -> Result<()> {
        let is_scrubbed = number == figures.scrub;
        self.geometry.every = match is_scrubbed {
            true => clip.truth.len().div_ceil(MOST).max(1),
            false => self.geometry.every,
        };
        let mut wanted: BTreeMap<usize, Vec<(usize, usize, &Worst)>> = BTreeMap::new();
        for (s, system) in figures.systems.iter().enumerate() {
            let own = system.worst.iter().enumerate();
            for (w, worst) in own.filter(|(_, worst)| worst.clip == number) {
                wanted.entry(worst.frame).or_default().push((s, w, worst));
            }
        }
        let last = match is_scrubbed {
            true => clip.truth.len(),
            false => wanted.keys().last().map_or(0, |frame| frame + 1),
        };
        for (frame, luma) in video::frames(&clip.path)?.take(last).enumerate() {
            let luma = luma?;
            for (s, w, worst) in wanted.remove(&frame).unwrap_or_default() {
                self.worst[s][w] = Some(crop(&luma, worst)?);
            }
            if is_scrubbed && frame % self.geometry.every == 0 {
                self.add_scrubbed(&luma)?;
            }
        }
        Ok(())
    }

    fn add_scrubbed(&mut self, luma: &GrayImage) -> Result<()> {
        let scale = f64::from(SCRUB_PX) / f64::from(luma.width());
        let height = ((f64::from(luma.height()) * scale).round() as u32).max(1);
        self.geometry.scale = scale;
        self.geometry.height = height;
        let small = resize(luma, SCRUB_PX, height, FilterType::Triangle);
        self.scrub.push(jpeg(&small)?);
        Ok(())
    }
}

fn jpeg(picture: &GrayImage) -> Result<Jpeg> {
    let mut bytes = Vec::new();
    picture.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, QUALITY))?;
    Ok(bytes)
}

/// The surroundings of the true face, or else of the found one, as far as they are in the frame.
fn crop(luma: &GrayImage, worst: &Worst) -> Result<Crop> {
    let face = match worst.truth[0][0].is_finite() {
        true => &worst.truth,
        false => &worst.found,
    };
    let [left, top, right, bottom] = bounds(face);
    let shorter = f64::from(luma.width().min(luma.height()));
    let side = (MARGIN * (right - left).max(bottom - top))
        .clamp(16.0, shorter)
        .floor();
    let corner = |low: f64, high: f64, length: u32| {
        let start = 0.5 * (low + high) - 0.5 * side;
        start.clamp(0.0, f64::from(length) - side).floor()
    };
    let (x, y) = (
        corner(left, right, luma.width()),
        corner(top, bottom, luma.height()),
    );
    let part = crop_imm(luma, x as u32, y as u32, side as u32, side as u32).to_image();
    let scale = f64::from(WORST_PX) / side;
    // Pixel centres of the frame are whole numbers, and so are those of the crop.
    let place = |[px, py]: [f64; 2]| [(px - x + 0.5) * scale, (py - y + 0.5) * scale];
    Ok(Crop {
        jpeg: jpeg(&resize(&part, WORST_PX, WORST_PX, FilterType::Triangle))?,
        points: [worst.truth.map(place), worst.found.map(place)],
    })
}
