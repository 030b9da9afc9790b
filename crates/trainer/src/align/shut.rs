//! Shuts the eyes of photographs: skin between brow and lid is drawn over the eye. Photographs
//! hardly ever show shut eyes, and people and networks label those half open.

use crate::faces::{Face, Picture, ratio};
use posewise::align::Shape;
use posewise::shape::MIRROR;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Ratio of height to width from which an eye is open enough to be shut.
const OPEN: f32 = 0.2;
/// Share of eyes that end shut; the others end anywhere between as they were and shut.
const WHOLLY: f64 = 0.5;
/// Share of faces of which one eye is shut alone.
const WINKS: f64 = 0.15;
/// Where shut lids meet, from the upper (0) to the lower lid (1).
const MEET: f32 = 0.85;
/// Share of the way from the upper lid to the brow whose skin is drawn down.
const SKIN: f32 = 0.8;
/// How far below the lower lid skin is drawn up, in widths of the eye.
const BELOW: f32 = 0.35;
/// Skin below the eye replaces that of a lid from this share of the lid's height on, wholly within
/// this share more, taken from so far below the lower lid, in widths of the eye, at this scale.
const CHEEK_FROM: f32 = 0.25;
const CHEEK_WITHIN: f32 = 0.5;
const CHEEK: f32 = 0.08;
const CHEEK_SCALE: f32 = 0.5;
/// Distance in the picture up to which skin that stretches counts, in widths of the eye.
const TALLEST: f32 = 1.5;

/// How far an eyeball that looks down turns, in the upper lid's way.
const FOLLOWS: f32 = 0.9;

/// The person's right eye and brow; the left one's are their mirror images.
const EYE: [usize; 6] = [36, 37, 38, 39, 40, 41];
const BROW: [usize; 5] = [17, 18, 19, 20, 21];

/// For this share of the photographs of faces, what [`shut`] makes of them. Renders have shut eyes
/// of their own.
pub fn sometimes(face: &Face, share: f32, rng: &mut ChaCha8Rng) -> Option<Face> {
    let can_be = !face.is_render && !face.is_single_eye;
    (can_be && rng.random_range(0.0..1.0) < share).then(|| shut(face, rng))
}

/// A face with one or both eyes shut or nearly so, where they are open and their lids are known.
fn shut(face: &Face, rng: &mut ChaCha8Rng) -> Face {
    let both = !rng.random_bool(WINKS);
    let only = rng.random_range(0..2);
    let by = match rng.random_bool(WHOLLY) {
        true => 1.0,
        false => rng.random_range(0.0..1.0f32),
    };
    let mut out = face.clone();
    for side in (0..2).filter(|side| both || *side == only) {
        if let Some(eye) = shutter(face, side) {
            let picture = eye.shut(&out.picture, by);
            out.picture = Arc::new(picture);
            eye.move_lids(&mut out.landmarks, by);
            out.has_exact_lids = true;
        }
    }
    out
}

/// How to shut the image left's (0) or the image right's eye (1) of a face, where it is open and
/// its lids are known.
pub fn shutter(face: &Face, side: usize) -> Option<Eye> {
    let which = |k: usize| if side == 0 { k } else { MIRROR[k] };
    let (eye, brow) = (EYE.map(which), BROW.map(which));
    let is_seen = |k: &usize| face.known[*k] && face.visible[*k];
    let [a, b, c, d, e, f] = eye;
    let is_open = ratio(&face.landmarks, [a, d], &[[b, f], [c, e]]) >= OPEN;
    (is_open && eye.iter().chain(&brow).all(is_seen))
        .then(|| Eye::new(&face.landmarks, eye, brow))
        .flatten()
}

/// An eye in a frame of its own: x from corner to corner, 0 to 1, y across, in the same unit, down
/// from the brow to the cheek.
#[derive(Clone, Copy)]
pub struct Eye {
    landmarks: [usize; 6],
    corner: [f32; 2],
    /// The x axis \[px\].
    along: [f32; 2],
    /// 1 or −1: whether y is clockwise or counterclockwise from x.
    turn: f32,
    /// Heights of the lids' two landmarks each, and of the skin's end above.
    upper: Lid,
    lower: Lid,
    top: f32,
    fold: Fold,
}

/// How the lids of an eye shut.
#[derive(Clone, Copy)]
pub struct Fold {
    /// Where shut lids meet, from the upper (0) to the lower lid (1).
    pub meet: f32,
    /// How far below that the middle of their line hangs, in widths of the eye.
    pub sag: f32,
    /// How much more of the skin that appears comes from near the lid's edge than from the brow: 1
    /// stretches all alike; from larger ones on skin below the brow, and the crease, stay.
    pub unroll: f32,
    /// Share of the lid's edge that is drawn as skin below the eye: where brows are low, there is
    /// little else than brow above it.
    pub cheek: f32,
}

impl Default for Fold {
    fn default() -> Fold {
        Fold {
            meet: MEET,
            sag: 0.0,
            unroll: 1.0,
            cheek: 0.0,
        }
    }
}

/// y = x (1 − x) (a + b x).
#[derive(Clone, Copy)]
struct Lid {
    a: f32,
    b: f32,
}

impl Lid {
    /// Through two points between the corners.
    fn through([[x, y], [u, v]]: [[f32; 2]; 2]) -> Option<Lid> {
        let [p, q] = [y / (x * (1.0 - x)), v / (u * (1.0 - u))];
        let b = (q - p) / (u - x);
        let lid = Lid { a: p - b * x, b };
        (lid.a.is_finite() && b.is_finite()).then_some(lid)
    }

    fn at(&self, x: f32) -> f32 {
        match (0.0..1.0).contains(&x) {
            true => x * (1.0 - x) * (self.a + self.b * x),
            false => 0.0,
        }
    }
}

impl Eye {
    fn new(shape: &Shape, landmarks: [usize; 6], brow: [usize; 5]) -> Option<Eye> {
        let [a, b, c, d, e, f] = landmarks;
        let [corner, end] = [shape[a], shape[d]];
        let along = [end[0] - corner[0], end[1] - corner[1]];
        let mut eye = Eye {
            landmarks,
            corner,
            along,
            turn: 1.0,
            upper: Lid { a: 0.0, b: 0.0 },
            lower: Lid { a: 0.0, b: 0.0 },
            top: 0.0,
            fold: Fold::default(),
        };
        let brow_y = |eye: &Eye| brow.iter().map(|k| eye.local(shape[*k])[1]).sum::<f32>() / 5.0;
        if brow_y(&eye) > 0.0 {
            eye.turn = -1.0;
        }
        let inside = |k: usize| {
            let [x, y] = eye.local(shape[k]);
            ((0.1..0.9).contains(&x) && y.abs() < 0.5).then_some([x, y])
        };
        let upper = Lid::through([inside(b)?, inside(c)?])?;
        let lower = Lid::through([inside(f)?, inside(e)?])?;
        let top = (SKIN * brow_y(&eye)).clamp(-TALLEST, 0.0);
        let opens = (1..10).all(|k| {
            let x = k as f32 / 10.0;
            upper.at(x) < lower.at(x) && top < upper.at(x) - 0.05
        });
        opens.then_some(Eye {
            upper,
            lower,
            top,
            ..eye
        })
    }

    /// The same eye, whose lids shut in this way.
    pub fn folded(&self, fold: Fold) -> Eye {
        Eye { fold, ..*self }
    }

    fn local(&self, p: [f32; 2]) -> [f32; 2] {
        let [ax, ay] = self.along;
        let [dx, dy] = [p[0] - self.corner[0], p[1] - self.corner[1]];
        let square = ax * ax + ay * ay;
        [
            (ax * dx + ay * dy) / square,
            self.turn * (ax * dy - ay * dx) / square,
        ]
    }

    fn picture(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let ([ax, ay], y) = (self.along, self.turn * y);
        [
            self.corner[0] + x * ax - y * ay,
            self.corner[1] + x * ay + y * ax,
        ]
    }

    /// Heights of the upper and the lower lid, before and after.
    fn lids(&self, x: f32, by: f32) -> [[f32; 2]; 2] {
        let before = [self.upper.at(x), self.lower.at(x)];
        let Fold { meet, sag, .. } = self.fold;
        let sag = 4.0 * sag * (x * (1.0 - x)).max(0.0);
        let meet = before[0] + meet * (before[1] - before[0]) + sag;
        [before, before.map(|y| y + by * (meet - y))]
    }

    /// Which height is drawn at a place; `follows` is how far the eyeball turns down with the upper
    /// lid, in the lid's way.
    fn source(&self, [x, y]: [f32; 2], by: f32, follows: f32) -> f32 {
        let [[upper, lower], [to_upper, to_lower]] = self.lids(x, by);
        let bottom = lower + BELOW;
        if y <= self.top || y >= bottom {
            y
        } else if y < to_upper {
            let down = (y - self.top) / (to_upper - self.top);
            self.top + (1.0 - (1.0 - down).powf(self.fold.unroll)) * (upper - self.top)
        } else if y <= to_lower {
            y - follows * (to_upper - upper)
        } else {
            bottom - (bottom - y) * (bottom - lower) / (bottom - to_lower)
        }
    }

    /// Which share of a place is skin below the eye, and its height.
    fn cheek(&self, [x, y]: [f32; 2], by: f32) -> (f32, f32) {
        let [[_, lower], [to_upper, _]] = self.lids(x, by);
        if self.fold.cheek == 0.0 || !(self.top..to_upper).contains(&y) {
            return (0.0, y);
        }
        let down = (y - self.top) / (to_upper - self.top);
        let share = by * self.fold.cheek * ((down - CHEEK_FROM) / CHEEK_WITHIN).clamp(0.0, 1.0);
        (share, lower + CHEEK + CHEEK_SCALE * (to_upper - y))
    }

    /// Moves its landmarks where they are when it is shut by this share.
    pub fn move_lids(&self, shape: &mut Shape, by: f32) {
        let [_, b, c, _, e, f] = self.landmarks;
        for (landmarks, k) in [([b, c], 0), ([f, e], 1)] {
            for landmark in landmarks {
                let [x, _] = self.local(shape[landmark]);
                shape[landmark] = self.picture([x, self.lids(x, by)[1][k]]);
            }
        }
    }

    /// The edge of the upper lid when it is shut by this share, from corner to corner, in as many
    /// points \[px\], and the way down the cheek, as long as the eye is wide.
    pub fn edge(&self, by: f32, points: usize) -> (Vec<[f32; 2]>, [f32; 2]) {
        let at = |k: usize| {
            let x = k as f32 / (points.max(2) - 1) as f32;
            self.picture([x, self.lids(x, by)[1][0]])
        };
        let [ax, ay] = self.along;
        (
            (0..points).map(at).collect(),
            [-self.turn * ay, self.turn * ax],
        )
    }

    /// The picture with the eye shut by this share.
    pub fn shut(&self, picture: &Picture, by: f32) -> Picture {
        self.drawn(picture, by, 0.0)
    }

    /// The picture with an eye that looks down: its upper lid falls by this share of the way to a
    /// shut one, and the eyeball turns with it.
    pub fn lower(&self, picture: &Picture, by: f32) -> Picture {
        self.drawn(picture, by, FOLLOWS)
    }

    fn drawn(&self, picture: &Picture, by: f32, follows: f32) -> Picture {
        let [w, h] = picture.size.map(|side| side as f32);
        let ends = [0.0, 1.0]
            .iter()
            .flat_map(|x| [self.top, 0.5 + BELOW].map(|y| self.picture([*x, y])));
        let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
        for p in ends {
            low = [low[0].min(p[0]), low[1].min(p[1])];
            high = [high[0].max(p[0]), high[1].max(p[1])];
        }
        let range = |k: usize, side: f32| {
            low[k].floor().clamp(0.0, side) as usize..high[k].ceil().clamp(0.0, side) as usize
        };
        let mut luma = picture.luma.clone();
        for row in range(1, h) {
            for column in range(0, w) {
                let at = self.local([column as f32, row as f32]);
                let y = self.source(at, by, follows);
                if y != at[1] {
                    let skin = picture.at(self.picture([at[0], y]));
                    let (share, from) = self.cheek(at, by);
                    let cheek = picture.at(self.picture([at[0], from]));
                    let drawn = skin + share * (cheek - skin);
                    luma[row * w as usize + column] = drawn.round() as u8;
                }
            }
        }
        Picture {
            size: picture.size,
            luma,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::shape::LANDMARKS;
    use rand::SeedableRng;

    /// Skin of 150, two eyes of 20 between their lids.
    fn face() -> Face {
        let mut landmarks = [[0.0; 2]; LANDMARKS];
        for (corner, brow, eye) in [(40.0, 17, 36), (100.0, 22, 42)] {
            for k in 0..5 {
                landmarks[brow + k] = [corner + 8.0 * k as f32, 40.0];
            }
            let y = [0.0, -6.0, -6.0, 0.0, 6.0, 6.0];
            for (k, x) in [0.0, 10.0, 20.0, 30.0, 20.0, 10.0].into_iter().enumerate() {
                landmarks[eye + k] = [corner + x, 60.0 + y[k]];
            }
        }
        let mut luma = vec![150; 170 * 120];
        for (at, value) in luma.iter_mut().enumerate() {
            let (x, y) = ((at % 170) as f32, (at / 170) as f32);
            for corner in [40.0, 100.0] {
                let s = (x - corner) / 30.0;
                if (0.0..1.0).contains(&s) && (y - 60.0).abs() < 27.0 * s * (1.0 - s) {
                    *value = 20;
                }
            }
        }
        let size = [170, 120];
        Face::new(Picture { size, luma }, landmarks)
    }

    #[test]
    fn an_eye_is_as_open_as_its_landmarks_say() {
        let face = face();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let dark = |face: &Face| face.picture.luma.iter().filter(|v| **v < 85).count() as f32;
        let open = |face: &Face| {
            let of =
                |[a, b, c, d, e, f]: [usize; 6]| ratio(&face.landmarks, [a, d], &[[b, f], [c, e]]);
            of(EYE) + of(EYE.map(|k| MIRROR[k]))
        };
        let mut wholly = 0;
        for _ in 0..40 {
            let shut = shut(&face, &mut rng);
            let [pixels, landmarks] = [dark(&shut) / dark(&face), open(&shut) / open(&face)];
            assert!((pixels - landmarks).abs() < 0.08, "{pixels} {landmarks}");
            wholly += usize::from(landmarks < 0.01);
            assert!(shut.has_exact_lids && shut.landmarks[..36] == face.landmarks[..36]);
        }
        assert!((10..30).contains(&wholly), "{wholly}");
    }

    #[test]
    fn a_line_of_lids_hangs_and_a_lid_shows_skin_from_below() {
        let mut face = face();
        let eye = shutter(&face, 0).unwrap();
        let middle = |eye: &Eye| eye.edge(1.0, 13).0[6][1];
        let hanging = eye.folded(Fold {
            sag: 0.1,
            ..Fold::default()
        });
        assert!((middle(&hanging) - middle(&eye) - 3.0).abs() < 1e-3);
        // Below the eye skin is bright.
        let w = face.picture.size[0] as usize;
        let mut picture = Picture::clone(&face.picture);
        picture.luma[70 * w..].fill(220);
        face.picture = Arc::new(picture);
        let lid = |share: f32| {
            let cheek = eye.folded(Fold {
                cheek: share,
                ..Fold::default()
            });
            cheek.shut(&face.picture, 1.0).luma[61 * w + 55]
        };
        let [none, half, all] = [0.0, 0.5, 1.0].map(lid);
        assert!(none < half && half < all, "{none} {half} {all}");
    }

    #[test]
    fn eyes_that_are_shut_or_hidden_stay_as_they_are() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut hidden = face();
        hidden.visible[..48].fill(false);
        let mut narrow = face();
        for k in 36..48 {
            narrow.landmarks[k][1] = 60.0 + 0.3 * (narrow.landmarks[k][1] - 60.0);
        }
        for face in [hidden, narrow] {
            let same = shut(&face, &mut rng);
            assert!(same.landmarks == face.landmarks && !same.has_exact_lids);
        }
    }
}
