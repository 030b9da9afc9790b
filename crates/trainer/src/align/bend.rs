//! Crops for training, some of them bent smoothly, so that a photograph shows more faces than its
//! own.

use super::starts::normal;
use crate::faces::Picture;
use posewise::math::Similarity;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Deviation of the stretch along a diagonal or an axis, the other one shrinking as much.
const STRETCH: f32 = 0.06;
/// Deviation of the displacement by the squares of the place, in half sides of the crop.
const CURVE: f32 = 0.05;
/// Largest value of a random number, in deviations.
const LARGEST: f32 = 2.0;
/// Most places along a side of a pixel.
const MOST_TAPS: usize = 4;
/// Rounds in which the way back is found; each leaves about a quarter of the error.
const ROUNDS: usize = 8;

/// A square crop around the origin of a frame, and where it shows the picture's places.
pub struct Cut<'b> {
    side: usize,
    to_frame: Similarity,
    back: Similarity,
    bend: Option<&'b Bend>,
}

impl<'b> Cut<'b> {
    /// Of `side` px; `to_frame` leads from px from the crop's middle into the picture.
    pub fn new(to_frame: Similarity, side: usize, bend: Option<&'b Bend>) -> Cut<'b> {
        Cut {
            side,
            to_frame,
            back: to_frame.inverse().expect("a crop has extent"),
            bend,
        }
    }

    /// Its pixels, row by row.
    pub fn crop(&self, picture: &Picture, mirrored: bool) -> Vec<f32> {
        let Some(bend) = self.bend else {
            return picture.crop(&self.to_frame, self.side, mirrored);
        };
        let mut crop = bend.crop(picture, &self.to_frame, self.side);
        if mirrored {
            crop.chunks_exact_mut(self.side).for_each(<[f32]>::reverse);
        }
        crop
    }

    /// Where it shows a place of the picture, in px from its middle, not mirrored.
    pub fn place(&self, at: [f32; 2]) -> [f32; 2] {
        let at = self.back.apply(at);
        (self.bend).map_or(at, |bend| bend.apply(at, self.side))
    }
}

/// A smooth displacement of the places of a square crop, in half sides from its middle.
pub struct Bend {
    /// Strain along x and along the diagonal.
    strain: [f32; 2],
    /// Of x and of y by x², xy and y².
    curve: [[f32; 3]; 2],
}

impl Bend {
    /// A random one for this share of the crops.
    pub fn sometimes(share: f32, rng: &mut ChaCha8Rng) -> Option<Bend> {
        (rng.random_range(0.0..1.0) < share).then(|| Bend::random(rng))
    }

    /// A random one.
    fn random(rng: &mut ChaCha8Rng) -> Bend {
        let mut number = |sigma: f32| sigma * normal(rng).clamp(-LARGEST, LARGEST);
        Bend {
            strain: [0; 2].map(|_| number(STRETCH)),
            curve: [0; 2].map(|_| [0; 3].map(|_| number(CURVE))),
        }
    }

    /// Where in the unbent crop the place `at` of the bent one is from.
    fn source(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [along, across] = self.strain;
        let curved = |[a, b, c]: [f32; 3]| a * x * x + b * x * y + c * y * y;
        [
            x + along * x + across * y + curved(self.curve[0]),
            y + across * x - along * y + curved(self.curve[1]),
        ]
    }

    /// Where the bent crop shows a place of the unbent one; both in px from the middle.
    fn apply(&self, at: [f32; 2], side: usize) -> [f32; 2] {
        let half = side as f32 / 2.0;
        // Outside of the crop the squares grow without end.
        let to = at.map(|v| (v / half).clamp(-1.5, 1.5));
        let mut from = to;
        for _ in 0..ROUNDS {
            let reached = self.source(from);
            from = [0, 1].map(|k| from[k] + to[k] - reached[k]);
        }
        from.map(|v| v * half)
    }

    /// The bent crop of `side` px around the origin of `to_frame`, row by row.
    fn crop(&self, picture: &Picture, to_frame: &Similarity, side: usize) -> Vec<f32> {
        let half = side as f32 / 2.0;
        // A pixel is the mean of as many places as it has px of the picture, about.
        let taps = (to_frame.scale().round() as usize).clamp(1, MOST_TAPS);
        let steps = (0..taps).map(|k| (k as f32 + 0.5) / taps as f32 - 0.5);
        let within: Vec<[f32; 2]> = steps
            .clone()
            .flat_map(|y| steps.clone().map(move |x| [x, y]))
            .collect();
        let middle = (side as f32 - 1.0) / 2.0;
        (0..side * side)
            .map(|k| {
                let at = [k % side, k / side].map(|v| v as f32 - middle);
                let sum: f32 = within
                    .iter()
                    .map(|by| {
                        let from = self.source([0, 1].map(|k| (at[k] + by[k]) / half));
                        picture.at(to_frame.apply(from.map(|v| v * half)))
                    })
                    .sum();
                sum / within.len() as f32
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_point_goes_where_the_bent_crop_shows_it() {
        let size = [200u32, 200];
        // A bright spot at (112, 91).
        let spot =
            |x: f32, y: f32| 200.0 * (-((x - 112.0).powi(2) + (y - 91.0).powi(2)) / 8.0).exp();
        let luma = (0..200 * 200).map(|k| spot((k % 200) as f32, (k / 200) as f32) as u8);
        let picture = Picture {
            size,
            luma: luma.collect(),
        };
        let to_frame = Similarity {
            a: 1.0,
            b: 0.0,
            tx: 100.0,
            ty: 100.0,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..20 {
            let bend = Bend::random(&mut rng);
            let side = 64;
            let crop = bend.crop(&picture, &to_frame, side);
            let sum: f32 = crop.iter().sum();
            let mean = |along: fn(usize, usize) -> usize| {
                let weighted = crop
                    .iter()
                    .enumerate()
                    .map(|(k, v)| along(k, side) as f32 * v);
                weighted.sum::<f32>() / sum - (side as f32 - 1.0) / 2.0
            };
            let found = [mean(|k, side| k % side), mean(|k, side| k / side)];
            let expected = bend.apply([12.0, -9.0], side);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
            assert!(off < 0.15, "{found:?} {expected:?}");
        }
    }
}
