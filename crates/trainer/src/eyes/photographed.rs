//! Eyes of photographed faces: as open as they are, or by drawing shut to any degree or looking
//! down.

use super::crop::{ROLL, turned};
use super::lashes::{self, Edge};
use crate::align::{normal, shut, shut::Fold};
use crate::faces::Face;
use posewise::math::Similarity;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::borrow::Cow;

/// Share of eyes that are left as they are, of those that look down, and of those that are shut
/// wholly; the others are shut to any degree. About as many are shut as open: where real skin is
/// mostly that of open eyes, the network takes real shut ones for open.
const AS_THEY_ARE: f64 = 0.3;
const DOWN: f64 = 0.2;
const WHOLLY: f64 = 0.4;
/// How far the lids of eyes that look down fall.
const LOWERED: std::ops::Range<f32> = 0.25..0.7;
/// Where lids that shut by drawing meet, from the upper (0) to the lower one (1), how far their
/// line hangs, in widths of the eye, how much skin stays below the brow, and the share of skin from
/// below the eye, none if negative: the line of real ones is about where the lower lid was and
/// hangs down, and their crease stays above a large smooth lid.
const MEET: std::ops::Range<f32> = 0.7..1.15;
const SAG: std::ops::Range<f32> = -0.02..0.14;
const UNROLL: std::ops::Range<f32> = 1.0..2.5;
const CHEEK: std::ops::Range<f32> = -0.7..1.0;
/// Standard deviations of what the tracker errs by, to the right and down \[mm\], and of the
/// logarithm of scale: that of a head whose size nobody told. Landmarks of shut lids err most, up
/// to where those of open ones would be.
const SHIFT_MM: [f32; 2] = [2.0, 3.5];
const LOG_SCALE: f32 = 0.15;

/// Points of a lid's edge.
const EDGE_POINTS: usize = 13;

/// First landmark of the image left's and of the image right's eye, and their outer corners.
const FIRST: [usize; 2] = [36, 42];
const OUTER: [usize; 2] = [36, 45];

/// An eye of a photograph that is open and can be shut.
pub struct PhotographedEye {
    face: Face,
    side: usize,
    eye: shut::Eye,
}

/// A crop of one.
pub struct Seen {
    /// The crop.
    pub crop: Vec<f32>,
    /// How far it is shut, 0..1.
    pub shut: f32,
}

impl PhotographedEye {
    /// Those of faces.
    pub fn all(faces: &[Face]) -> Vec<PhotographedEye> {
        let both = faces
            .iter()
            .flat_map(|face| [0, 1].map(|side| (face, side)));
        let open = both.filter_map(|(face, side)| {
            let eye = shut::shutter(face, side)?;
            let face = face.clone();
            Some(PhotographedEye { face, side, eye })
        });
        open.collect()
    }

    /// A crop as the tracker cuts it, mirrored where it is the person's left eye.
    pub fn draw(&self, side: usize, zoom: f32, rng: &mut ChaCha8Rng) -> Seen {
        let kind = rng.random_range(0.0..1.0);
        let looks_down = (AS_THEY_ARE..AS_THEY_ARE + DOWN).contains(&kind);
        let by = match kind {
            ..AS_THEY_ARE => 0.0,
            _ if looks_down => rng.random_range(LOWERED),
            _ if kind < AS_THEY_ARE + DOWN + WHOLLY => 1.0,
            _ => rng.random_range(0.0..1.0f32),
        };
        let mut landmarks = self.face.landmarks;
        let mut picture = Cow::Borrowed(&*self.face.picture);
        let eye = &self.eye.folded(match looks_down {
            true => Fold::default(),
            false => Fold {
                meet: rng.random_range(MEET),
                sag: rng.random_range(SAG),
                unroll: rng.random_range(UNROLL),
                cheek: rng.random_range(CHEEK).max(0.0),
            },
        });
        if by > 0.0 {
            picture = Cow::Owned(match looks_down {
                true => eye.lower(&picture, by),
                false => eye.shut(&picture, by),
            });
            eye.move_lids(&mut landmarks, by);
        }
        let lids = &landmarks[FIRST[self.side]..][..6];
        let [x, y] = [0, 1].map(|k| lids.iter().map(|p| p[k]).sum::<f32>() / 6.0);
        let [a, b] = OUTER.map(|k| landmarks[k]);
        let (scale, roll) = (
            self.face.usual_px_per_mm(),
            (b[1] - a[1]).atan2(b[0] - a[0]),
        );
        let place = turned(scale.ln(), roll, [x, y]);
        let shift = SHIFT_MM.map(|sigma| sigma * normal(rng));
        let jitter = turned(LOG_SCALE * normal(rng), ROLL * normal(rng), shift);
        let to_mm = turned(-zoom.ln(), 0.0, [0.0; 2]).then(&jitter);
        let to_frame: Similarity = to_mm.then(&place);
        let is_mirrored = self.side == 1;
        let mut crop = picture.crop(&to_frame, side, is_mirrored);
        let edge = in_crop(eye.edge(by, EDGE_POINTS), &to_frame, side, is_mirrored);
        lashes::draw(&mut crop, side, &edge, by, rng);
        let shut = if looks_down { 0.0 } else { by };
        Seen { crop, shut }
    }
}

/// A lid's edge in a crop of this side.
fn in_crop(
    (points, down): (Vec<[f32; 2]>, [f32; 2]),
    to_frame: &Similarity,
    side: usize,
    is_mirrored: bool,
) -> Edge {
    let to_crop = to_frame.inverse().expect("a crop has extent");
    let sign = if is_mirrored { -1.0 } else { 1.0 };
    let centre = (side as f32 - 1.0) / 2.0;
    let place = |p: [f32; 2]| {
        let [x, y] = to_crop.apply(p);
        [centre + sign * x, centre + y]
    };
    let [x, y] = points[0];
    let (from, to) = (place([x, y]), place([x + down[0], y + down[1]]));
    Edge {
        points: points.into_iter().map(place).collect(),
        down: [to[0] - from[0], to[1] - from[1]],
    }
}
