//! Smooth random fields: value noise on a hashed lattice.

use glam::Vec3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// A hash of a lattice point, 0..1.
fn lattice(x: i32, y: i32, z: i32, seed: u32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x8da6_b343)
        ^ (y as u32).wrapping_mul(0xd816_3841)
        ^ (z as u32).wrapping_mul(0xcb1a_b31f)
        ^ seed.wrapping_mul(0x9e37_79b9);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2c1b_3c6d);
    h ^= h >> 12;
    h = h.wrapping_mul(0x297a_2d39);
    h ^= h >> 15;
    (h >> 8) as f32 / (1 << 24) as f32
}

/// Value noise at a point, −1..1; features are about one unit wide.
pub fn noise(p: Vec3, seed: u32) -> f32 {
    let floor = p.floor();
    let f = p - floor;
    let s = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let (x, y, z) = (floor.x as i32, floor.y as i32, floor.z as i32);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |dy: i32, dz: i32| {
        mix(
            lattice(x, y + dy, z + dz, seed),
            lattice(x + 1, y + dy, z + dz, seed),
            s.x,
        )
    };
    let low = mix(row(0, 0), row(1, 0), s.y);
    let high = mix(row(0, 1), row(1, 1), s.y);
    2.0 * mix(low, high, s.z) - 1.0
}

/// Noise summed over octaves, each half as wide and half as strong, about −1..1.
pub fn fractal(p: Vec3, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut amplitude = 0.5;
    let mut q = p;
    for octave in 0..octaves {
        sum += amplitude * noise(q, seed.wrapping_add(octave * 101));
        amplitude *= 0.5;
        q *= 2.03;
    }
    sum
}

/// 0 below `low`, 1 above `high`, smooth between.
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A standard normal deviate (Box–Muller).
pub fn normal(rng: &mut ChaCha8Rng) -> f32 {
    let radius = (-2.0 * rng.random_range(1e-7..1.0f32).ln()).sqrt();
    radius * rng.random_range(0.0..std::f32::consts::TAU).cos()
}
