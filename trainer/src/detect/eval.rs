//! Measures a detector on pictures that it was not trained on.

use posewise::detect::{Detection, DetectorModel, Scan, Swept};
use rayon::prelude::*;

use super::faces::Face;
use super::grey::Grey;

/// Farthest centre over size, and size ratio, at which a detection is the labelled face.
const NEAR: f32 = 0.25;
const RATIO: std::ops::RangeInclusive<f32> = 0.7..=1.4;

/// One answer beside the truth.
pub struct Answer<'a> {
    pub face: &'a Face,
    pub found: Option<Detection>,
}

impl Answer<'_> {
    /// Whether the detection is the labelled face.
    pub fn right(&self) -> bool {
        let truth = &self.face.truth;
        self.found.is_some_and(|d| {
            let off = (d.x - truth.x).hypot(d.y - truth.y) / truth.size;
            off <= NEAR && RATIO.contains(&(d.size / truth.size))
        })
    }

    /// Right and down (in the face's own axes, over size), log size, roll \[deg\], turn: found less
    /// truth.
    pub fn errors(&self) -> Option<[f32; 5]> {
        let (t, d) = (&self.face.truth, self.found.filter(|_| self.right())?);
        let (sin, cos) = t.roll.sin_cos();
        let (dx, dy) = (d.x - t.x, d.y - t.y);
        Some([
            (cos * dx + sin * dy) / t.size,
            (cos * dy - sin * dx) / t.size,
            (d.size / t.size).ln(),
            (d.roll - t.roll).to_degrees(),
            d.turn - t.turn,
        ])
    }
}

/// A whole sweep over each face's picture.
pub fn answers<'a>(
    model: &DetectorModel<'_>,
    faces: &'a [Face],
    min_face_px: i32,
) -> Vec<Answer<'a>> {
    faces
        .par_iter()
        .map(|face| Answer {
            face,
            found: sweep(model, &face.picture, min_face_px),
        })
        .collect()
}

/// A whole sweep over a picture.
pub fn sweep(model: &DetectorModel<'_>, picture: &Grey, min_face_px: i32) -> Option<Detection> {
    match Scan::new().advance(model, &picture.frame(), min_face_px, u32::MAX) {
        Swept::Found(found) => Some(found),
        _ => None,
    }
}

/// Means and standard deviations of [`Answer::errors`].
pub fn statistics(answers: &[Answer<'_>]) -> [(f32, f32); 5] {
    let errors: Vec<[f32; 5]> = answers.iter().filter_map(Answer::errors).collect();
    let n = errors.len().max(1) as f32;
    std::array::from_fn(|k| {
        let mean = errors.iter().map(|e| e[k]).sum::<f32>() / n;
        let square = errors.iter().map(|e| (e[k] - mean).powi(2)).sum::<f32>() / n;
        (mean, square.sqrt())
    })
}

/// Pictures of 640×480 from backgrounds: each enlarged to cover the frame, its middle cut out.
pub fn frames_640(backgrounds: &[Grey]) -> Vec<Grey> {
    backgrounds
        .par_iter()
        .map(|b| {
            let scale = (640.0 / b.width as f32).max(480.0 / b.height as f32);
            let (w, h) = (b.width as f32 * scale, b.height as f32 * scale);
            let picture = image::GrayImage::from_raw(b.width, b.height, b.luma.clone())
                .expect("as many bytes as pixels");
            let large = image::imageops::resize(
                &picture,
                w.ceil() as u32,
                h.ceil() as u32,
                image::imageops::FilterType::CatmullRom,
            );
            let (x, y) = ((large.width() - 640) / 2, (large.height() - 480) / 2);
            let frame = image::imageops::crop_imm(&large, x, y, 640, 480).to_image();
            Grey {
                width: 640,
                height: 480,
                luma: frame.into_raw(),
            }
        })
        .collect()
}
