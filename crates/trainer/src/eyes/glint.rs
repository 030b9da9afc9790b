//! Lamps that mirror in eyes and glasses: small bright discs, drawn over a crop. An infrared lamp
//! beside the camera makes one on every lens, before open and before shut eyes.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Share of crops with lamps, and most of them.
const SHARE: f32 = 0.25;
const MOST: usize = 3;
/// Radius, and distance from the middle of the eye along each axis \[mm\].
const RADIUS_MM: std::ops::Range<f32> = 0.4..3.0;
const PLACE_MM: std::ops::Range<f32> = -14.0..14.0;
const LUMA: std::ops::Range<f32> = 150.0..255.0;
/// Width of the soft edge \[px\].
const SOFT: f32 = 1.2;

/// Draws lamps over some crops of this side and scale.
pub fn draw(crop: &mut [f32], side: usize, px_per_mm: f32, rng: &mut ChaCha8Rng) {
    if rng.random_range(0.0f32..1.0) >= SHARE {
        return;
    }
    let centre = (side as f32 - 1.0) / 2.0;
    for _ in 0..rng.random_range(1..=MOST) {
        let [x, y] = [0, 1].map(|_| centre + px_per_mm * rng.random_range(PLACE_MM));
        let radius = px_per_mm * rng.random_range(RADIUS_MM);
        let luma = rng.random_range(LUMA);
        for (at, v) in crop.iter_mut().enumerate() {
            let far = ((at % side) as f32 - x).hypot((at / side) as f32 - y);
            let opacity = ((radius - far) / SOFT + 0.5).clamp(0.0, 1.0);
            *v += opacity * (luma.max(*v) - *v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn some_eyes_have_a_bright_spot() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let brightest = |rng: &mut ChaCha8Rng| {
            let mut crop = vec![60.0; 1600];
            draw(&mut crop, 40, 0.9, rng);
            assert!(crop.iter().all(|v| (60.0..=255.0).contains(v)));
            crop.iter().fold(0.0f32, |m, v| m.max(*v))
        };
        let bright = (0..1000).filter(|_| brightest(&mut rng) > 100.0).count();
        assert!((150..330).contains(&bright), "{bright}");
    }
}
