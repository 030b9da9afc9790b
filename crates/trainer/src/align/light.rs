//! Light that changes across a crop: portraits are lit softly, other photographs by the sun, lamps
//! and windows, with shadows that end at a line.

use super::starts::normal;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Most soft spots, their radii \[sides of the crop\], and the deviation of the logarithm of their
/// light.
const MOST_SPOTS: usize = 3;
const RADII: std::ops::Range<f32> = 0.15..0.6;
const SPOT_LIGHT: f32 = 0.45;
/// Share of crops that a shadow falls on, the logarithm of what is left of the light there, and how
/// softly it ends \[sides of the crop\].
const SHADOWED: f64 = 0.5;
const SHADOW: std::ops::Range<f32> = -1.2..-0.2;
const SOFTNESS: std::ops::Range<f32> = 0.005..0.12;
/// Radius of the shadow's round edge \[sides of the crop\].
const EDGE: std::ops::Range<f32> = 0.25..2.5;

/// A spot that is brighter or darker towards its middle.
struct Spot {
    at: [f32; 2],
    radius: f32,
    light: f32,
}

/// A shadow inside or outside of a circle.
struct Shadow {
    at: [f32; 2],
    radius: f32,
    softness: f32,
    light: f32,
    /// −1 inside, 1 outside.
    sign: f32,
}

/// Lights a crop of `side` px, row by row, in another way.
pub fn relight(crop: &mut [f32], side: usize, rng: &mut ChaCha8Rng) {
    let place = |rng: &mut ChaCha8Rng| [0, 1].map(|_| rng.random_range(-0.1f32..1.1));
    let spots: Vec<Spot> = (0..rng.random_range(1..=MOST_SPOTS))
        .map(|_| Spot {
            at: place(rng),
            radius: rng.random_range(RADII),
            light: SPOT_LIGHT * normal(rng),
        })
        .collect();
    let shadow = rng.random_bool(SHADOWED).then(|| {
        // Its edge passes through a place in the crop.
        let (through, radius) = (place(rng), rng.random_range(EDGE));
        let (sin, cos) = rng.random_range(-3.2f32..3.2).sin_cos();
        Shadow {
            at: [through[0] + radius * cos, through[1] + radius * sin],
            radius,
            softness: rng.random_range(SOFTNESS),
            light: rng.random_range(SHADOW),
            sign: [-1.0, 1.0][rng.random_range(0..2)],
        }
    });
    let distance = |at: [f32; 2], x: f32, y: f32| (x - at[0]).hypot(y - at[1]);
    for (k, v) in crop.iter_mut().enumerate() {
        let [x, y] = [k % side, k / side].map(|p| p as f32 / side as f32);
        let mut light = 0.0;
        for spot in &spots {
            let far = distance(spot.at, x, y) / spot.radius;
            light += spot.light * (-far * far).exp();
        }
        if let Some(shadow) = &shadow {
            let beyond = shadow.sign * (distance(shadow.at, x, y) - shadow.radius);
            light += shadow.light / (1.0 + (-4.0 * beyond / shadow.softness).exp());
        }
        *v = (*v * light.exp()).clamp(0.0, 255.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn light_changes_across_a_crop_and_leaves_black_black() {
        let side = 40;
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..20 {
            let mut crop = vec![100.0; side * side];
            crop[7] = 0.0;
            relight(&mut crop, side, &mut rng);
            assert_eq!(crop[7], 0.0);
            let of = |pick: fn(f32, f32) -> f32, from| crop[8..].iter().copied().fold(from, pick);
            let (low, high) = (of(f32::min, 255.0), of(f32::max, 0.0));
            assert!(low > 5.0 && high <= 255.0 && high > low, "{low} {high}");
        }
    }
}
