//! Patches around landmarks on three descriptors: intensity, squared gradient magnitude and local
//! binary patterns (those of FaceTracker's patch experts, Saragih et al., IJCV 2011).

use posewise::align::{AlignModel, Shape, mirror};
use posewise::image::{Crop, warp};
use posewise::math::Similarity;
use posewise::shape::{LANDMARKS, MIRROR};
use posewise_train::faces::Picture;

/// Descriptors.
pub const KINDS: usize = 3;
/// Side of a template \[px\].
pub const TEMPLATE: usize = 11;
/// Values of a template.
pub const VALUES: usize = TEMPLATE * TEMPLATE;

/// Crop px per canonical unit: the outer eye corners are about 54 px apart.
const ZOOM: f32 = 1.5;
/// Side of the crop \[px\].
const SIDE: usize = 128;

/// Where a shape's crop lies, and which templates it needs.
pub struct Placement {
    /// Index of the view; the same for both sides.
    pub view: usize,
    mirrored: bool,
    /// Crop px from the centre (not mirrored) → frame px.
    to_frame: Similarity,
    to_crop: Similarity,
}

impl Placement {
    /// `None` for a shape without extent.
    pub fn of(model: &AlignModel<'_>, shape: &Shape) -> Option<Placement> {
        let view = model.views().of(shape)?;
        let canonical = Similarity::fit(model.mean(), shape)?;
        let to_frame = Similarity {
            a: canonical.a / ZOOM,
            b: canonical.b / ZOOM,
            ..canonical
        };
        Some(Placement {
            view: view.index,
            mirrored: view.mirrored,
            to_crop: to_frame.inverse()?,
            to_frame,
        })
    }

    /// The same place seen in a mirror.
    pub fn flipped(self) -> Placement {
        Placement {
            mirrored: !self.mirrored,
            ..self
        }
    }

    /// A shape's points in the crop, from its centre \[px\]; in a mirror in the mirrored order.
    pub fn points(&self, shape: &Shape) -> Shape {
        let points = shape.map(|p| self.to_crop.apply(p));
        if self.mirrored {
            mirror(&points)
        } else {
            points
        }
    }

    /// Back from [`Placement::points`].
    pub fn shape(&self, points: &Shape) -> Shape {
        let points = if self.mirrored {
            mirror(points)
        } else {
            *points
        };
        points.map(|p| self.to_frame.apply(p))
    }

    /// Which landmark the k-th point is.
    pub fn landmark(&self, k: usize) -> usize {
        if self.mirrored { MIRROR[k] } else { k }
    }

    /// Marks of landmarks in the order of the points.
    pub fn marks(&self, of: &[bool; LANDMARKS]) -> [bool; LANDMARKS] {
        std::array::from_fn(|k| of[self.landmark(k)])
    }
}

/// A crop that patches are cut from.
pub struct Patches(Vec<u8>);

impl Patches {
    /// The crop at a placement.
    pub fn cut(picture: &Picture, placement: &Placement) -> Patches {
        let centre = (SIDE as f32 - 1.0) / 2.0;
        let [tx, ty] = placement.to_frame.apply([-centre, -centre]);
        let from_corner = Similarity {
            tx,
            ty,
            ..placement.to_frame
        };
        let mut crop = Crop::new();
        warp(&picture.frame(), &from_corner, SIDE, &mut crop);
        let mut luma = crop.luma().to_vec();
        if placement.mirrored {
            luma.chunks_exact_mut(SIDE).for_each(<[u8]>::reverse);
        }
        Patches(luma)
    }

    /// The patch around a point (from the crop's centre, rounded to whole px), without its mean and
    /// of unit length; `None` where it leaves the crop.
    pub fn at(&self, kind: usize, [x, y]: [f32; 2]) -> Option<[f32; VALUES]> {
        let centre = (SIDE as f32 - 1.0) / 2.0;
        let half = (TEMPLATE / 2 + 1) as i32;
        let (x, y) = ((x + centre).round() as i32, (y + centre).round() as i32);
        let inside = half..SIDE as i32 - half;
        if !inside.contains(&x) || !inside.contains(&y) {
            return None;
        }
        let pixel = |u: i32, v: i32| self.0[v as usize * SIDE + u as usize] as f32;
        let mut out = [0.0; VALUES];
        for (i, out) in out.iter_mut().enumerate() {
            let u = x + (i % TEMPLATE) as i32 - TEMPLATE as i32 / 2;
            let v = y + (i / TEMPLATE) as i32 - TEMPLATE as i32 / 2;
            *out = match kind {
                0 => pixel(u, v),
                1 => {
                    let gx = pixel(u + 1, v) - pixel(u - 1, v);
                    let gy = pixel(u, v + 1) - pixel(u, v - 1);
                    gx * gx + gy * gy
                }
                _ => {
                    const AROUND: [(i32, i32); 8] = [
                        (-1, -1),
                        (0, -1),
                        (1, -1),
                        (1, 0),
                        (1, 1),
                        (0, 1),
                        (-1, 1),
                        (-1, 0),
                    ];
                    let own = pixel(u, v);
                    let bit = |(k, (du, dv)): (usize, &(i32, i32))| {
                        u8::from(pixel(u + du, v + dv) >= own) << k
                    };
                    AROUND.iter().enumerate().map(bit).sum::<u8>() as f32
                }
            };
        }
        let mean = out.iter().sum::<f32>() / VALUES as f32;
        out.iter_mut().for_each(|v| *v -= mean);
        let length = out.iter().map(|v| v * v).sum::<f32>().sqrt();
        out.iter_mut().for_each(|v| *v /= length.max(1e-3));
        Some(out)
    }
}
