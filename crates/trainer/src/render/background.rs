//! Backgrounds in linear light: pieces of photographs, or procedural rooms, skies and textures.

use super::noise::{fractal, smoothstep};
use glam::{Vec2, Vec3};
use image::GrayImage;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::PI;

/// Linear light of an 8-bit grey value.
pub fn linear(grey: u8) -> f32 {
    (grey as f32 / 255.0).powf(2.2)
}

/// A random piece of a photograph, mirrored at random.
pub fn from_photo(
    rng: &mut ChaCha8Rng,
    photo: &GrayImage,
    width: usize,
    height: usize,
) -> Vec<f32> {
    let table: Vec<f32> = (0..=255).map(linear).collect();
    let (pw, ph) = (photo.width() as f32, photo.height() as f32);
    // From the whole picture down to its native resolution or a little enlarged.
    let fit = (pw / width as f32).min(ph / height as f32);
    let step = rng.random_range(0.5f32.min(fit)..=fit.max(0.51));
    let left = rng.random_range(0.0..=(pw - step * width as f32).max(0.0));
    let top = rng.random_range(0.0..=(ph - step * height as f32).max(0.0));
    let mirror = rng.random_bool(0.5);
    let mut out = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let x = if mirror { width - 1 - x } else { x };
            let (u, v) = (left + step * x as f32, top + step * y as f32);
            out.push(sampled(photo, &table, Vec2::new(u, v)));
        }
    }
    out
}

/// Most pieces of a collage.
const MOST_PIECES: i32 = 14;
/// How far pieces are turned from upside down \[rad\]: 70°. A detector is asked for faces that are
/// turned by up to 60° from upright.
const MOST_TURN: f32 = 1.22;

/// Pieces of photographs of people, mostly upside down, over each other and over a scene: as sharp
/// and as finely structured as what is behind people in photographs.
pub fn collage(
    rng: &mut ChaCha8Rng,
    photos: &[GrayImage],
    scene: Vec<f32>,
    width: usize,
) -> Vec<f32> {
    let table: Vec<f32> = (0..=255).map(linear).collect();
    let mut light = scene;
    let height = light.len() / width;
    let size = width.max(height) as f32;
    for k in 0..rng.random_range(1..=MOST_PIECES) {
        let photo = &photos[rng.random_range(0..photos.len())];
        let first = k == 0 && rng.random_bool(0.7);
        let mut within =
            |from: f32, to: f32| Vec2::from([0, 1].map(|_| rng.random_range(from..to)));
        // The first mostly covers all of the scene.
        let (half, middle) = match first {
            true => (Vec2::splat(2.0), Vec2::splat(0.5)),
            false => (within(0.04, 0.4), within(0.0, 1.0)),
        };
        let (half, middle) = (size * half, size * middle);
        let lean = Vec2::from_angle(rng.random_range(-PI..PI));
        let turned = Vec2::from_angle(PI + rng.random_range(-MOST_TURN..MOST_TURN));
        let step = rng.random_range(0.4f32..1.6);
        let from = Vec2::new(
            rng.random_range(0.0..photo.width() as f32),
            rng.random_range(0.0..photo.height() as f32),
        );
        let gain = rng.random_range(-0.8f32..0.8).exp();
        let soft = rng.random_range(0.5f32..2.0);
        let is_round = rng.random_bool(0.5);
        for (i, value) in light.iter_mut().enumerate() {
            let p = Vec2::new((i % width) as f32, (i / width) as f32) - middle;
            let local = lean.rotate(p);
            let inside = match is_round {
                true => (1.0 - (local / half).length()) * half.min_element(),
                false => (half - local.abs()).min_element(),
            };
            if inside > -soft {
                let mut seen = from + step * turned.rotate(p);
                // Not mirrored: what is upside down is so everywhere.
                seen.y = seen.y.rem_euclid(photo.height() as f32);
                let tone = gain * sampled(photo, &table, seen);
                *value += (tone - *value) * smoothstep(-soft, soft, inside);
            }
        }
    }
    light
}

/// Light of a photograph between its pixels; beyond its edges it is mirrored.
fn sampled(photo: &GrayImage, table: &[f32], at: Vec2) -> f32 {
    let (width, height) = photo.dimensions();
    let mirrored = |v: i32, len: u32| {
        let v = v.rem_euclid(2 * len as i32) as u32;
        v.min(2 * len - 1 - v)
    };
    let (low, part) = (at.floor(), at - at.floor());
    let pixel = |dx: i32, dy: i32| {
        let x = mirrored(low.x as i32 + dx, width);
        let y = mirrored(low.y as i32 + dy, height);
        table[usize::from(photo.get_pixel(x, y).0[0])]
    };
    let row = |dy: i32| pixel(0, dy) * (1.0 - part.x) + pixel(1, dy) * part.x;
    row(0) * (1.0 - part.y) + row(1) * part.y
}

/// A procedural background: a gradient, soft clouds and a few panels with straight edges.
pub fn procedural(rng: &mut ChaCha8Rng, width: usize, height: usize) -> Vec<f32> {
    let seed: u32 = rng.random();
    let size = width.max(height) as f32;
    let base = rng.random_range(0.02..0.7f32);
    let tilt = Vec2::new(rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5));
    let clouds = rng.random_range(0.0..0.8f32);
    let grain = rng.random_range(1.5..9.0) / size;
    let panels: Vec<(Vec2, Vec2, Vec2, f32)> = (0..rng.random_range(0..7))
        .map(|_| {
            let middle = Vec2::new(rng.random_range(0.0..1.0), rng.random_range(0.0..1.0)) * size;
            let half = Vec2::new(rng.random_range(0.03..0.4), rng.random_range(0.03..0.4)) * size;
            let lean = if rng.random_bool(0.7) {
                0.0
            } else {
                rng.random_range(-0.7..0.7f32)
            };
            (
                middle,
                half,
                Vec2::from_angle(lean),
                rng.random_range(0.02..0.8),
            )
        })
        .collect();
    (0..width * height)
        .map(|i| {
            let p = Vec2::new((i % width) as f32, (i / width) as f32);
            let q = p / size - 0.5;
            let mut value = base * (1.0 + tilt.dot(q) * 2.0);
            for (middle, half, lean, tone) in &panels {
                let local = lean.rotate(p - *middle).abs();
                let inside = (half.x - local.x).min(half.y - local.y);
                value += (tone - value) * smoothstep(-0.7, 0.7, inside);
            }
            let cloud = fractal(Vec3::new(p.x, p.y, 0.0) * grain, 4, seed);
            (value * (1.0 + clouds * cloud)).clamp(0.0, 1.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_collage_shows_the_photographs_finely() {
        let stripes = GrayImage::from_fn(40, 40, |x, _| image::Luma([255 * (x / 2 % 2) as u8]));
        let edges = |photo: &GrayImage| {
            let mut rng = ChaCha8Rng::seed_from_u64(3);
            let light = collage(
                &mut rng,
                std::slice::from_ref(photo),
                vec![0.2; 60 * 50],
                60,
            );
            assert_eq!(light.len(), 60 * 50);
            assert!(light.iter().all(|l| l.is_finite() && *l >= 0.0));
            light
                .windows(2)
                .filter(|pair| (pair[0] - pair[1]).abs() > 0.1)
                .count()
        };
        let plain = GrayImage::from_pixel(40, 40, image::Luma([128]));
        assert!(
            edges(&stripes) > 3 * edges(&plain),
            "{}, {}",
            edges(&stripes),
            edges(&plain)
        );
    }
}
