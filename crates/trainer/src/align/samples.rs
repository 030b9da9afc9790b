//! Training samples: crops around labelled faces as the tracker would cut them, disturbed as
//! cameras and light disturb them.

use super::bend::{Bend, Cut};
use super::light::relight;
use super::network::Points;
use super::options::{Augment, Options, Start};
use super::starts::normal;
use crate::faces::Face;
use posewise::align::{Shape, mirror, place};
use posewise::math::Similarity;
use posewise::shape::{LANDMARKS, MIRROR};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Samples that show how large the maps' values grow and where predictions move points.
pub const EXAMPLES: usize = 2048;

/// A crop, where the network begins and where its points belong, in crop px from the crop's centre.
pub struct Sample {
    pub crop: Vec<f32>,
    pub start: Points,
    pub truth: Points,
    /// Of each point's error.
    pub weights: Vec<f32>,
}

/// What the network that is being trained makes of a sample: points in its crop \[px\].
pub type Predict<'p> = dyn FnMut(&Sample) -> Points + 'p;

/// How much farther off than other detections stray ones are.
const STRAY: f32 = 2.5;
/// Most predictions before a sample.
const MOST_AGAIN: usize = 3;
/// Most times that an unsharp crop is blurred by 3×3 means.
const MOST_BLURS: usize = 16;
/// Logarithm of what is left of the contrast of a crop that has little.
const FAINT: std::ops::Range<f32> = -2.0..-0.4;
/// Width of a mean face's box, in canonical units: what jitter's shifts are shares of.
const BOX: f32 = 64.0;

/// One sample of a face. For a share of them ([`Start::again`]) the crop then lies where the
/// network's own prediction on it puts the next one, for that share of these once more, and so on:
/// while a face is tracked each frame starts from the errors of the one before.
pub fn sample(
    face: &Face,
    mean: &Shape,
    options: &Options,
    bend: Option<Bend>,
    predict: Option<&mut Predict<'_>>,
    rng: &mut ChaCha8Rng,
) -> Sample {
    let (sizes, start) = (&options.sizes, &options.start);
    let detected = rng.random_range(0.0..1.0) < start.detected_share;
    let is_stray = detected && rng.random_range(0.0..1.0) < start.stray_share;
    let jitter = match detected {
        true if is_stray => start.detected.times(STRAY),
        true => start.detected,
        false => start.tracked,
    };
    let scale = (normal(rng) * jitter.log_size).exp() / sizes.zoom;
    let angle = normal(rng) * jitter.roll;
    let mut to_canonical = Similarity {
        a: scale * angle.cos(),
        b: scale * angle.sin(),
        tx: normal(rng) * jitter.shift * BOX,
        ty: normal(rng) * jitter.shift * BOX,
    };
    let mirrored = rng.random_bool(0.5);
    let drawn = |to_canonical, rng: &mut ChaCha8Rng| {
        let mut sample = cut(
            face,
            mean,
            sizes.side,
            to_canonical,
            bend.as_ref(),
            mirrored,
        );
        disturb(&mut sample.crop, sizes.side, &options.augment, rng);
        standardise(&mut sample.crop);
        sample
    };
    let mut sample = drawn(to_canonical, rng);
    let Some(predict) = predict else {
        return sample;
    };
    for _ in 0..MOST_AGAIN {
        if rng.random_range(0.0..1.0) >= start.again {
            break;
        }
        let Some(next) = next_place(mean, &predict(&sample), sizes.zoom, mirrored) else {
            break;
        };
        to_canonical = next.then(&to_canonical);
        if !is_near(&to_canonical, sizes.zoom) {
            break;
        }
        sample = drawn(to_canonical, rng);
    }
    sample
}

/// Where the next crop lies, by the points that were predicted in one: its px to those of the other
/// as it was before it was mirrored, both from the middle. What bends the crop is left out.
fn next_place(mean: &Shape, points: &Points, zoom: f32, mirrored: bool) -> Option<Similarity> {
    let shape: Shape = std::array::from_fn(|k| points[k]);
    let shape = if mirrored { mirror(&shape) } else { shape };
    let placed = place(mean, &shape, zoom, 1)?;
    Some(placed.centred_to_frame)
}

/// Whether a crop lies no farther off the face than stray detections do. Predictions of a network
/// that has learnt little do.
fn is_near(to_canonical: &Similarity, zoom: f32) -> bool {
    let far = Start::default().detected.times(STRAY);
    let shift = to_canonical.tx.hypot(to_canonical.ty);
    let size = (to_canonical.scale() * zoom).ln();
    shift <= far.shift * BOX && size.abs() <= far.log_size && to_canonical.angle().abs() <= far.roll
}

/// The crop of a face whose centred px lie at `to_canonical` of the true canonical frame.
pub fn cut(
    face: &Face,
    mean: &Shape,
    side: usize,
    to_canonical: Similarity,
    bend: Option<&Bend>,
    mirrored: bool,
) -> Sample {
    let canonical = Similarity::fit(mean, &face.landmarks).expect("a face has extent");
    let cut = Cut::new(to_canonical.then(&canonical), side, bend);
    let mut truth = face.landmarks.map(|p| cut.place(p));
    let mut known = face.known;
    if mirrored {
        truth = mirror(&truth);
        known = MIRROR.map(|from| face.known[from]);
    }
    let weight = |known| if known { face.weight } else { 0.0 };
    Sample {
        crop: cut.crop(&face.picture, mirrored),
        start: vec![[0.0; 2]; LANDMARKS],
        truth: truth.to_vec(),
        weights: known.map(weight).to_vec(),
    }
}

/// Light, motion, contrast, brightness, noise, blur and patches.
pub fn disturb(crop: &mut [f32], side: usize, augment: &Augment, rng: &mut ChaCha8Rng) {
    let chance = |share: f32, rng: &mut ChaCha8Rng| rng.random_range(0.0..1.0) < share;
    if augment.light > 0.0 && chance(augment.light, rng) {
        relight(crop, side, rng);
    }
    if augment.motion_blur > 0.0 && chance(augment.motion_blur, rng) {
        // Heads turn to the side faster than they nod.
        let angle = 0.4 * normal(rng);
        let length = augment.motion_blur_px * rng.random_range(0.0f32..1.0);
        // Lights that flicker leave separate pictures, steady ones a motion_blur.
        let exposures = rng.random_range(3..=3 + length as usize);
        motion_blur(
            crop,
            side,
            [length * angle.cos(), length * angle.sin()],
            exposures,
        );
    }
    if chance(augment.coarse, rng) {
        for y in (0..side - 1).step_by(2) {
            for x in (0..side - 1).step_by(2) {
                let four = [0, 1, side, side + 1].map(|d| y * side + x + d);
                let mean = four.iter().map(|k| crop[*k]).sum::<f32>() / 4.0;
                four.iter().for_each(|k| crop[*k] = mean);
            }
        }
        blur(crop, side);
    } else if chance(augment.blur, rng) {
        // Out of focus: nearly a Gaussian of 0.8 to 3.3 px.
        for _ in 0..rng.random_range(1..=MOST_BLURS) {
            blur(crop, side);
        }
    }
    // Never more than the slope of the curve at its ends.
    let tone = (normal(rng) * augment.tone).clamp(-0.8, 0.8);
    let mut gain = (normal(rng) * augment.contrast).exp();
    if augment.faint > 0.0 && chance(augment.faint, rng) {
        gain *= rng.random_range(FAINT).exp();
    }
    let offset = normal(rng) * augment.brightness;
    let slope = rng.random_range(-1.0f32..1.0) * augment.slope / side as f32;
    let [sx, sy] = [
        slope,
        rng.random_range(-1.0f32..1.0) * augment.slope / side as f32,
    ];
    let noise = rng.random_range(0.0f32..1.0).powi(3) * augment.noise;
    let centre = side as f32 / 2.0;
    for (at, v) in crop.iter_mut().enumerate() {
        let (x, y) = ((at % side) as f32 - centre, (at / side) as f32 - centre);
        // A sum of four uniform numbers is normal enough for noise.
        let n = (0..4).map(|_| rng.random_range(-0.5f32..0.5)).sum::<f32>() * 1.73 * noise;
        let toned = *v + tone * *v * (1.0 - *v / 255.0);
        *v = ((toned - 128.0) * gain + 128.0 + offset + sx * x + sy * y + n).clamp(0.0, 255.0);
    }
    if chance(augment.patch, rng) {
        let [w, h] = [0, 0].map(|_| rng.random_range(side / 12..side / 3));
        let (x0, y0) = (rng.random_range(0..side - w), rng.random_range(0..side - h));
        let value = rng.random_range(0.0..255.0);
        for y in y0..y0 + h {
            crop[y * side + x0..y * side + x0 + w].fill(value);
        }
    }
}

/// The mean of exposures along a way, as long before as behind where the crop is.
fn motion_blur(crop: &mut [f32], side: usize, [dx, dy]: [f32; 2], exposures: usize) {
    let from = crop.to_vec();
    let last = side as f32 - 1.0;
    for (at, out) in crop.iter_mut().enumerate() {
        let mut sum = 0.0;
        for k in 0..exposures {
            let way = k as f32 / (exposures - 1) as f32 - 0.5;
            let x = ((at % side) as f32 + way * dx).clamp(0.0, last);
            let y = ((at / side) as f32 + way * dy).clamp(0.0, last);
            let (x0, y0) = ((x as usize).min(side - 2), (y as usize).min(side - 2));
            let (u, v) = (x - x0 as f32, y - y0 as f32);
            let row = |y: usize| {
                from[y * side + x0] + u * (from[y * side + x0 + 1] - from[y * side + x0])
            };
            let (upper, lower) = (row(y0), row(y0 + 1));
            sum += upper + v * (lower - upper);
        }
        *out = sum / exposures as f32;
    }
}

/// 3×3 means.
fn blur(crop: &mut [f32], side: usize) {
    let from = crop.to_vec();
    for y in 0..side {
        for x in 0..side {
            let mut sum = 0.0;
            for v in [y.saturating_sub(1), y, (y + 1).min(side - 1)] {
                for u in [x.saturating_sub(1), x, (x + 1).min(side - 1)] {
                    sum += from[v * side + u];
                }
            }
            crop[y * side + x] = sum / 9.0;
        }
    }
}

/// Takes the mean off and divides by the deviation, as the core does.
pub fn standardise(crop: &mut [f32]) {
    let n = crop.len() as f32;
    let mean = crop.iter().sum::<f32>() / n;
    let variance = crop.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / n;
    let gain = 1.0 / (variance.sqrt() + 8.0);
    crop.iter_mut().for_each(|v| *v = (*v - mean) * gain);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faces::Picture;
    use rand::SeedableRng;

    /// A network that finds the landmarks exactly puts the next crop exactly over the face.
    #[test]
    fn the_next_crop_lies_where_the_network_puts_it() {
        let ray = |k: usize| (k as f32).sin_cos();
        let half: Shape = std::array::from_fn(|k| [30.0 * ray(k).0, 25.0 * ray(k).1]);
        let other = mirror(&half);
        let mean: Shape = std::array::from_fn(|k| [0, 1].map(|i| half[k][i] + other[k][i]));
        let picture = Picture {
            size: [100; 2],
            luma: vec![100; 100 * 100],
        };
        let face = Face::new(picture, mean.map(|[x, y]| [50.0 + x - 0.2 * y, 45.0 + y]));
        let always = Options {
            start: Start {
                again: 1.0,
                stray_share: 0.0,
                ..Start::default()
            },
            ..Options::default()
        };
        let offset = |seen: &mut Predict<'_>, seed: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let sample = sample(&face, &mean, &always, None, Some(seen), &mut rng);
            let placed = next_place(&mean, &sample.truth, 1.0, false).expect("it has extent");
            placed.tx.hypot(placed.ty)
        };
        let right = &mut |sample: &Sample| sample.truth.clone();
        let none = &mut |_: &Sample| vec![[0.0; 2]; LANDMARKS];
        let of = |seen: &mut Predict<'_>| (0..8).map(|seed| offset(seen, seed)).sum::<f32>();
        assert!(of(right) < 0.01, "{}", of(right));
        assert!(of(none) > 8.0, "without a prediction it stays off");
    }

    #[test]
    fn a_smear_stays_where_it_was() {
        let side = 9;
        let mut crop = vec![0.0; side * side];
        crop[4 * side + 4] = 3.0;
        motion_blur(&mut crop, side, [4.0, 0.0], 3);
        let row: Vec<f32> = crop[4 * side..5 * side].to_vec();
        assert_eq!(row, [0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
        assert_eq!(crop.iter().sum::<f32>(), 3.0);
    }
}
