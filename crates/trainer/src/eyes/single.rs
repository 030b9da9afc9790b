//! Photographs of single eyes: they say only whether an eye is open.

use super::crop::{ROLL, turned};
use crate::align::{Sizes, normal};
use crate::picture::Picture;
use anyhow::Result;
use posewise::math::Similarity;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;

/// One photograph in this number is held out of training, as for the lid refiner.
const HELD_OUT: usize = 5;
/// Width of the eye and height of its middle in a photograph, in its width and height, and width of
/// an eye \[mm\].
///
/// Source: the research model's refiners, `posewise-train eyes --all`: medians of open eyes are
/// 0.70 of the photographs, and 0.64 of those in near-infrared light.
pub const WIDTH: f32 = 0.67;
const MIDDLE: f32 = 0.54;
const EYE_MM: f32 = 29.0;
/// How much the logarithm of its size varies, and its place, in widths.
const LOG_SCALE: f32 = 0.18;
const SHIFT: f32 = 0.04;

/// A photograph of a single eye.
#[derive(Clone)]
pub struct SingleEye {
    /// It.
    pub picture: Picture,
    /// Whether it is open.
    pub open: bool,
}

impl SingleEye {
    /// Millimetres from the middle of the eye → pixels.
    pub fn place(&self) -> Similarity {
        self.place_of_width(WIDTH)
    }

    /// The same where the eye has another width, in that of the picture.
    pub fn place_of_width(&self, width: f32) -> Similarity {
        let [w, h] = self.picture.size.map(|s| s as f32);
        Similarity {
            a: width * w / EYE_MM,
            b: 0.0,
            tx: 0.5 * w,
            ty: MIDDLE * h,
        }
    }

    /// A crop of it, jittered.
    pub fn crop(&self, sizes: &Sizes, rng: &mut ChaCha8Rng) -> Vec<f32> {
        let place = self.place();
        let shift = SHIFT * self.picture.size[0] as f32 / place.a;
        let shift = [shift * normal(rng), shift * normal(rng)];
        let (scale, roll) = (LOG_SCALE * normal(rng), 2.0 * ROLL * normal(rng));
        let to_mm = turned(-sizes.zoom.ln(), 0.0, [0.0; 2]).then(&turned(scale, roll, shift));
        let mirror = rng.random_bool(0.5);
        self.picture.crop(&to_mm.then(&place), sizes.side, mirror)
    }
}

/// Whether the photograph of this number, by name, is held out of training.
pub fn is_held_out(index: usize) -> bool {
    index % HELD_OUT == HELD_OUT - 1
}

/// The photographs to train on, or those held out.
pub fn read(folder: &Path, held_out: bool) -> Result<Vec<SingleEye>> {
    let mut all = vec![];
    for (name, open) in [("open", true), ("closed", false)] {
        let paths = Picture::list(&folder.join(name))?;
        for (index, path) in paths.into_iter().enumerate() {
            if is_held_out(index) == held_out {
                let picture = Picture::read(&path)?;
                all.push(SingleEye { picture, open });
            }
        }
    }
    Ok(all)
}
