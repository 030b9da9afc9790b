//! What comes before an eye, drawn over a crop: the side of a hand, the rim of a steering wheel.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Share of crops with something before the eye.
const SHARE: f32 = 0.1;
/// Share of it that ends on both sides, as a rim does, and its width \[mm\].
const BARS: f64 = 0.5;
const BAR_MM: std::ops::Range<f32> = 8.0..30.0;
/// Where it begins, from the middle of the eye \[mm\].
const EDGE_MM: std::ops::Range<f32> = -22.0..16.0;
/// Its luma in that of the crop, the largest slope of it across the crop, and its noise.
const LUMA: std::ops::Range<f32> = 0.05..1.6;
const SLOPE: f32 = 60.0;
const NOISE: f32 = 6.0;
/// Width of its soft edge \[px\].
const SOFT: f32 = 1.5;
/// Half the width and height of an eye \[mm\].
const EYE_MM: [f32; 2] = [15.0, 6.0];

/// Covers some crops of this side and scale; which share of the eye is covered.
pub fn draw(crop: &mut [f32], side: usize, px_per_mm: f32, rng: &mut ChaCha8Rng) -> f32 {
    if rng.random_range(0.0f32..1.0) >= SHARE {
        return 0.0;
    }
    let mean = crop.iter().sum::<f32>() / crop.len() as f32;
    let luma = mean * rng.random_range(LUMA);
    let slope = [0, 1].map(|_| rng.random_range(-SLOPE..SLOPE) / side as f32);
    let noise = rng.random_range(0.0..NOISE);
    let (sin, cos) = rng
        .random_range(-std::f32::consts::PI..std::f32::consts::PI)
        .sin_cos();
    let from = px_per_mm * rng.random_range(EDGE_MM);
    let wide = match rng.random_bool(BARS) {
        true => px_per_mm * rng.random_range(BAR_MM),
        false => f32::MAX,
    };
    let centre = (side as f32 - 1.0) / 2.0;
    let (mut covered, mut all) = (0.0f32, 0.0f32);
    for (at, v) in crop.iter_mut().enumerate() {
        let (x, y) = ((at % side) as f32 - centre, (at / side) as f32 - centre);
        let along = cos * x + sin * y - from;
        let opacity = (along.min(wide - along) / SOFT + 0.5).clamp(0.0, 1.0);
        let own = luma + slope[0] * x + slope[1] * y + rng.random_range(-1.0f32..1.0) * noise;
        *v += opacity * (own.clamp(0.0, 255.0) - *v);
        let [a, b] = EYE_MM.map(|mm| px_per_mm * mm);
        if (x / a).powi(2) + (y / b).powi(2) < 1.0 {
            all += 1.0;
            covered += opacity;
        }
    }
    covered / all.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn some_eyes_are_covered() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let crops: Vec<(Vec<f32>, f32)> = (0..1000)
            .map(|_| {
                let mut crop = vec![100.0; 1600];
                let covered = draw(&mut crop, 40, 0.9, &mut rng);
                (crop, covered)
            })
            .collect();
        let count = |least: f32| crops.iter().filter(|(_, c)| *c > least).count();
        assert!(
            count(0.0) > 50 && count(0.9) > 15,
            "{} {}",
            count(0.0),
            count(0.9)
        );
        assert!(
            crops
                .iter()
                .all(|(crop, c)| *c == 0.0 || crop.iter().any(|v| *v != 100.0))
        );
        assert!(crops.iter().all(|(_, c)| (0.0..=1.0).contains(c)));
    }
}
