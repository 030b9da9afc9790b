//! Crops of eyes, from renders and from photographs.

use crate::picture::Picture;
use posewise::image::{Crop, warp};
use posewise::math::Similarity;

/// Standard deviation of the roll that the tracker errs by \[rad\].
pub const ROLL: f32 = 0.05;

/// A square crop of `side` px around the origin of `to_frame`, row by row.
pub fn crop_of(picture: &Picture, to_frame: &Similarity, side: usize, mirror: bool) -> Vec<f32> {
    let centre = (side as f32 - 1.0) / 2.0;
    let [tx, ty] = to_frame.apply([-centre, -centre]);
    let mut crop = Crop::new();
    let from_corner = Similarity {
        tx,
        ty,
        ..*to_frame
    };
    warp(&picture.frame(), &from_corner, side, &mut crop);
    if mirror {
        crop.mirror();
    }
    crop.luma().iter().map(|v| f32::from(*v)).collect()
}

/// A similarity of this logarithm of scale and roll.
pub fn turned(log_scale: f32, roll: f32, [tx, ty]: [f32; 2]) -> Similarity {
    let scale = log_scale.exp();
    Similarity {
        a: scale * roll.cos(),
        b: scale * roll.sin(),
        tx,
        ty,
    }
}
