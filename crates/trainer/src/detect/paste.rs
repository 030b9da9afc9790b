//! Puts pieces of pictures into tiles.

use crate::picture::Picture;
use posewise::detect::TILE;
use posewise::image::{Crop, warp};
use posewise::math::Similarity;

/// A mask in the tile: a superellipse that is feathered.
#[derive(Clone, Copy, Debug)]
pub struct Mask {
    pub centre: [f32; 2],
    pub half: [f32; 2],
    /// \[rad\].
    pub angle: f32,
    /// The superellipse's power is two to this.
    pub doublings: i32,
    /// \[tile px\].
    pub feather: f32,
}

/// Where a picture lies in a tile.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Picture px per tile px.
    pub scale: f32,
    /// Clockwise \[rad\].
    pub roll: f32,
    /// A point of the picture \[picture px\] …
    pub from: [f32; 2],
    /// … and where it comes to \[tile px\].
    pub to: [f32; 2],
}

impl Pose {
    /// The level whose pixels are nearest to the tile's, and the similarity from the tile to it.
    fn level<'a>(&self, levels: &'a [Picture]) -> (&'a Picture, Similarity) {
        let most = levels.len() as f32 - 1.0;
        let level = (self.scale * 1.35).log2().floor().clamp(0.0, most) as usize;
        let by = (1u32 << level) as f32;
        let at = |v: f32| (v + 0.5) / by - 0.5;
        let (sin, cos) = (-self.roll).sin_cos();
        let (a, b) = (self.scale / by * cos, self.scale / by * sin);
        let [x, y] = self.to;
        let similarity = Similarity {
            a,
            b,
            tx: at(self.from[0]) - a * x + b * y,
            ty: at(self.from[1]) - b * x - a * y,
        };
        (&levels[level], similarity)
    }
}

impl Mask {
    /// How far inside of it a place of the tile is \[tile px\], given sine and cosine of its angle.
    fn inside(&self, (sin, cos): (f32, f32), x: f32, y: f32) -> f32 {
        let (dx, dy) = (x - self.centre[0], y - self.centre[1]);
        let p = (cos * dx + sin * dy) / self.half[0];
        let q = (cos * dy - sin * dx) / self.half[1];
        let (mut p, mut q) = (p * p, q * q);
        (1..self.doublings).for_each(|_| (p, q) = (p * p, q * q));
        let mut norm = p + q;
        (0..self.doublings).for_each(|_| norm = norm.sqrt());
        (1.0 - norm) * self.half[0].min(self.half[1])
    }
}

/// Fills a tile with a picture.
pub fn fill(luma: &mut [u8], levels: &[Picture], pose: &Pose, crop: &mut Crop) {
    let (level, similarity) = pose.level(levels);
    warp(&level.frame(), &similarity, TILE, crop);
    luma.copy_from_slice(crop.luma());
}

/// Blends a picture into a tile, with this contrast and change of brightness.
pub fn paste(
    luma: &mut [u8],
    levels: &[Picture],
    pose: &Pose,
    mask: &Mask,
    [contrast, brightness]: [f32; 2],
    crop: &mut Crop,
) {
    let (level, similarity) = pose.level(levels);
    let reach = mask.half[0].hypot(mask.half[1]) + mask.feather + 1.0;
    let clamp = |v: f32| v.clamp(0.0, TILE as f32) as usize;
    let low = mask.centre.map(|c| clamp(c - reach));
    let high = mask.centre.map(|c| clamp(c + reach));
    let side = (high[0] - low[0]).max(high[1] - low[1]).min(TILE);
    if side == 0 {
        return;
    }
    let [tx, ty] = similarity.apply(low.map(|v| v as f32));
    let shifted = Similarity {
        tx,
        ty,
        ..similarity
    };
    warp(&level.frame(), &shifted, side, crop);
    let [w, h] = level.size.map(|s| s as f32 - 1.0);
    let inverse = 1.0 / similarity.scale();
    let angle = mask.angle.sin_cos();
    for y in low[1]..high[1] {
        for x in low[0]..high[0] {
            let [u, v] = similarity.apply([x as f32, y as f32]);
            let edge = u.min(v).min(w - u).min(h - v) * inverse;
            let inside = mask.inside(angle, x as f32, y as f32);
            let alpha = ((edge.min(inside) + 0.5) / mask.feather).clamp(0.0, 1.0);
            if alpha > 0.0 {
                let own = crop.luma()[(y - low[1]) * side + x - low[0]] as f32;
                let own = (own - 128.0) * contrast + 128.0 + brightness;
                let at = &mut luma[y * TILE + x];
                *at = (*at as f32 + alpha * (own - *at as f32)).clamp(0.0, 255.0) as u8;
            }
        }
    }
}
