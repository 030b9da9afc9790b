//! Lenses before an eye, drawn over a crop: dark ones, and reflections that leave little of an eye.
//!
//! Renders have few of them, and a large dark lens fills the whole crop: what the network then sees
//! is noise, of which it must not say that it is a shut eye.

use crate::align::normal;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Shares of crops with a dark lens and with a reflection.
const DARK_SHARE: f32 = 0.05;
const VEIL_SHARE: f32 = 0.1;
/// Half the width and height of a lens, and how far its middle is below the eye \[mm\].
const HALF_MM: [std::ops::Range<f32>; 2] = [22.0..33.0, 13.0..27.0];
const BELOW_MM: std::ops::Range<f32> = 0.0..6.0;
/// Exponent of its outline, a superellipse.
const POWER: std::ops::Range<f32> = 2.0..4.5;
/// How much of the picture lenses cover.
const DARK_OPACITY: std::ops::Range<f32> = 0.85..1.0;
const VEIL_OPACITY: std::ops::Range<f32> = 0.3..0.92;
/// Luma of a dark lens in that of the crop, and of a reflection.
const DARK_LUMA: std::ops::Range<f32> = 0.03..0.5;
const VEIL_LUMA: std::ops::Range<f32> = 80.0..255.0;
/// Largest slope of a lens' luma across the crop.
const SLOPE: f32 = 40.0;
/// Share of lenses with a rim, and its width in half the lens.
const RIMS: f64 = 0.7;
const RIM: std::ops::Range<f32> = 0.02..0.1;
/// Share of reflections that end in a line across the lens.
const EDGES: f64 = 0.3;

/// What was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// How much of the picture it covers.
    pub opacity: f32,
    /// Whether it is dark.
    pub dark: bool,
}

impl Lens {
    /// Share of an eye behind it that is seen.
    pub fn leaves(&self) -> f32 {
        match self.dark {
            true => 0.0,
            false => 1.0 - self.opacity,
        }
    }
}

/// Draws a lens over some crops of this side and scale.
pub fn draw(crop: &mut [f32], side: usize, px_per_mm: f32, rng: &mut ChaCha8Rng) -> Option<Lens> {
    let chance = rng.random_range(0.0f32..1.0);
    let dark = chance < DARK_SHARE;
    if chance >= DARK_SHARE + VEIL_SHARE {
        return None;
    }
    let mean = crop.iter().sum::<f32>() / crop.len() as f32;
    let (opacity, luma) = match dark {
        true => (
            rng.random_range(DARK_OPACITY),
            mean * rng.random_range(DARK_LUMA),
        ),
        false => (rng.random_range(VEIL_OPACITY), rng.random_range(VEIL_LUMA)),
    };
    let half = HALF_MM.map(|range| px_per_mm * rng.random_range(range));
    let middle = [
        px_per_mm * 2.0 * normal(rng),
        px_per_mm * rng.random_range(BELOW_MM),
    ];
    let power = rng.random_range(POWER);
    let slope = [0, 1].map(|_| rng.random_range(-SLOPE..SLOPE) / side as f32);
    let rim = match rng.random_bool(RIMS) {
        true => rng.random_range(RIM),
        false => 0.0,
    };
    let rim_luma = mean * rng.random_range(0.0f32..1.2);
    let (sin, cos) = rng
        .random_range(-std::f32::consts::PI..std::f32::consts::PI)
        .sin_cos();
    let edge = match !dark && rng.random_bool(EDGES) {
        true => rng.random_range(0.0..0.5) * side as f32,
        false => f32::MAX,
    };
    let centre = (side as f32 - 1.0) / 2.0;
    for (at, v) in crop.iter_mut().enumerate() {
        let x = (at % side) as f32 - centre - middle[0];
        let y = (at / side) as f32 - centre - middle[1];
        let far = (x / half[0]).abs().powf(power) + (y / half[1]).abs().powf(power);
        let far = far.powf(1.0 / power);
        if far < 1.0 && cos * x + sin * y < edge {
            let lens = luma + slope[0] * x + slope[1] * y;
            *v += opacity * (lens - *v);
        } else if (1.0..1.0 + rim).contains(&far) {
            *v = rim_luma;
        }
        *v = v.clamp(0.0, 255.0);
    }
    Some(Lens { opacity, dark })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_dark_lens_hides_the_eye() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut dark, mut veils) = (0, 0);
        for _ in 0..1000 {
            let mut crop: Vec<f32> = (0..1600).map(|i| 100.0 + (i % 7) as f32 * 20.0).collect();
            match draw(&mut crop, 40, 0.9, &mut rng) {
                None => assert_eq!(crop[3], 160.0),
                Some(lens) => {
                    assert!(crop.iter().all(|v| (0.0..=255.0).contains(v)));
                    let inner: Vec<f32> = (12..28).map(|x| crop[20 * 40 + x]).collect();
                    let mean = inner.iter().sum::<f32>() / 16.0;
                    assert!(!lens.dark || mean < 120.0);
                    *(if lens.dark { &mut dark } else { &mut veils }) += 1;
                }
            }
        }
        assert!(dark > 25 && veils > 60, "{dark} {veils}");
    }
}
