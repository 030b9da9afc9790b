//! The three refiners: their landmarks, their crops, and the faces that they are trained on.

use crate::align::quantize::write_refiner;
use crate::align::samples::Sample;
use crate::align::train::Trained;
use crate::faces::{Face, ratio};
use anyhow::Result;
use posewise_format::SectionWriter;

/// How many times as often as a photograph of a face one of a single eye is drawn.
const SINGLE: f32 = 3.0;

/// One refiner of the face.
pub struct Refiner {
    /// As messages and checkpoints call it.
    pub name: &'static str,
    /// In the order of the network's points.
    pub landmarks: Vec<usize>,
    /// Whether a mirrored refiner places the mirrored landmarks.
    pub mirrored: bool,
    /// Side of its crop \[px\].
    pub side: usize,
    /// Crop px per canonical unit.
    pub zoom: f32,
    /// Share of renders among its samples.
    pub rendered: f32,
    /// Share of photographs whose eyes are shut by drawing.
    pub shut: f32,
    /// Share of crops with motion blur.
    pub motion_blurred: f32,
    /// Whether a second round adds pictures of single eyes, if there are some.
    pub single_eyes: bool,
}

/// In the order in which they run.
pub fn all() -> [Refiner; 3] {
    [
        Refiner {
            name: "eye",
            landmarks: (17..22).chain(36..42).collect(),
            mirrored: true,
            side: 56,
            zoom: 2.0,
            rendered: 0.5,
            shut: 0.35,
            motion_blurred: 0.0,
            single_eyes: false,
        },
        Refiner {
            name: "mouth",
            landmarks: (48..68).collect(),
            mirrored: false,
            side: 56,
            zoom: 1.5,
            rendered: 0.5,
            shut: 0.0,
            motion_blurred: 0.0,
            single_eyes: false,
        },
        Refiner {
            name: "lids",
            landmarks: (36..42).collect(),
            mirrored: true,
            side: 48,
            zoom: 3.5,
            rendered: 0.6,
            shut: 0.45,
            motion_blurred: 0.3,
            single_eyes: true,
        },
    ]
}

impl Refiner {
    /// Writes it to section `RFIN`.
    pub fn write(
        &self,
        trained: &Trained,
        samples: &[Sample],
        out: &mut SectionWriter,
    ) -> Result<()> {
        write_refiner(trained, &self.landmarks, self.mirrored, samples, out)
    }

    /// The weight with which a face is drawn: more where eyes are closed or the mouth is open,
    /// which is rare.
    pub fn draw_weight(&self, face: &Face) -> f32 {
        let ratio = |ends, aperture: &[_]| ratio(&face.landmarks, ends, aperture);
        if face.is_single_eye {
            SINGLE
        } else if self.mirrored && !face.is_render {
            1.0
        } else if self.mirrored {
            let right = ratio([36, 39], &[[37, 41], [38, 40]]);
            let left = ratio([42, 45], &[[43, 47], [44, 46]]);
            1.0 + 20.0 * (0.2 - right.min(left)).clamp(0.0, 0.2)
        } else {
            let open = ratio([60, 64], &[[61, 67], [62, 66], [63, 65]]);
            1.0 + 4.0 * (open - 0.1).clamp(0.0, 0.6)
        }
    }
}
