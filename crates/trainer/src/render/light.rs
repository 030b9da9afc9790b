//! Light: a gradient from the surroundings, a key light with soft self-shadow, a fill light and a
//! weak sheen; and the camera's response to it.

use super::environment::Sky;
use super::mesh::directions;
use super::noise::smoothstep;
use glam::{Mat3, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::TAU;

/// The lights of a scene, in camera axes.
#[derive(Clone, Debug)]
pub struct Lights {
    /// Light from everywhere.
    pub ambient: f32,
    /// Direction the surroundings are brightest in, times how much.
    pub gradient: Vec3,
    /// Unit vector towards the key light.
    pub key: Vec3,
    /// Its strength.
    pub key_power: f32,
    /// Unit vector towards the fill light.
    pub fill: Vec3,
    /// Its strength.
    pub fill_power: f32,
    /// Sheen of skin.
    pub sheen: f32,
    /// Exponent of the sheen.
    pub sheen_exponent: f32,
    /// 0 visible light .. 1 near infrared: skin and lips brighten and flatten.
    pub infrared: f32,
    /// Surroundings of a panorama, beside or in place of the lamps.
    pub sky: Option<Sky>,
    /// What the key light comes through.
    pub bars: Option<Bars>,
}

/// Shadows with hard edges across the key light, as of trees beside a road.
#[derive(Clone, Copy, Debug)]
pub struct Bars {
    /// Unit vector across them, camera axes.
    pub across: Vec3,
    /// Width of a light and a dark one together \[mm\].
    pub period_mm: f32,
    /// How far they have moved \[mm\].
    pub moved_mm: f32,
}

impl Bars {
    /// Share of the key light that is left at a point \[mm, camera axes\]. Bars differ in width.
    fn leave(&self, point: Vec3) -> f32 {
        let phase = TAU * (point.dot(self.across) + self.moved_mm) / self.period_mm;
        let wave = phase.sin() + 0.6 * (0.37 * phase).sin();
        smoothstep(-0.15, 0.15, wave)
    }
}

fn unit(rng: &mut ChaCha8Rng) -> Vec3 {
    loop {
        let v = Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0f32)));
        if (0.05..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

impl Lights {
    /// Random lights; the key light comes from the camera's side and mostly from above.
    pub fn random(rng: &mut ChaCha8Rng, infrared: bool) -> Lights {
        let mut key = unit(rng);
        key.z = -key.z.abs() - 0.1;
        if rng.random_bool(0.75) {
            key.y = -key.y.abs();
        }
        // Near-infrared lamps sit beside the camera.
        if infrared {
            key = Vec3::new(0.35 * key.x, 0.3 * key.y, -1.0);
        }
        let fill = unit(rng);
        let contrast = rng.random_range(0.0..1.0f32);
        Lights {
            ambient: 0.75 - 0.5 * contrast,
            gradient: Vec3::new(
                rng.random_range(-0.5..0.5),
                rng.random_range(-0.8..0.1),
                rng.random_range(-0.4..0.2),
            ),
            key: key.normalize(),
            key_power: 0.15 + 0.9 * contrast,
            fill: Vec3::new(fill.x, fill.y, -fill.z.abs()),
            fill_power: rng.random_range(0.0..0.3),
            sheen: rng.random_range(0.0..0.12),
            sheen_exponent: rng.random_range(6.0..30.0),
            infrared: if infrared {
                rng.random_range(0.4..0.9)
            } else {
                0.0
            },
            sky: None,
            bars: None,
        }
    }

    /// How much a surface returns (diffuse factor, sheen), given its normal and the unit vector
    /// towards the camera, the share of the sky it sees and of the key light that reaches it.
    pub fn reflect(&self, normal: Vec3, to_camera: Vec3, open: f32, lit: f32) -> (f32, f32) {
        // Skin scatters light a little past the terminator.
        const WRAP: f32 = 0.15;
        let key = ((normal.dot(self.key) + WRAP) / (1.0 + WRAP)).max(0.0);
        let fill = normal.dot(self.fill).max(0.0);
        let sky = self.ambient * (1.0 + self.gradient.dot(normal)).max(0.1);
        let diffuse = open * (sky + self.fill_power * fill) + self.key_power * lit * key;
        let half = (self.key + to_camera).normalize_or_zero();
        let gloss = normal.dot(half).max(0.0).powf(self.sheen_exponent);
        (diffuse, self.sheen * self.key_power * lit * gloss)
    }

    /// Share of the key light that bars leave at a point \[mm, camera axes\].
    pub fn through_bars(&self, point: Vec3) -> f32 {
        self.bars.map_or(1.0, |bars| bars.leave(point))
    }

    /// Albedo as the scene's wavelength sees it.
    pub fn albedo(&self, albedo: f32) -> f32 {
        albedo + (0.25 + 0.55 * albedo - albedo) * self.infrared
    }
}

/// The stored directions that contribute to light from one direction.
pub struct Reach {
    near: Vec<(usize, f32)>,
}

impl Reach {
    /// For a key light in camera axes and the head's rotation.
    pub fn new(key: Vec3, head_to_camera: Mat3) -> Reach {
        // Directions over which the key light's shadow edges are softened.
        const NEAR: usize = 7;
        let local = head_to_camera.transpose() * key;
        let weight = |d: Vec3| d.dot(local).max(0.0).powi(16) + 1e-9;
        let mut near: Vec<(usize, f32)> = directions()
            .iter()
            .map(|d| weight(*d))
            .enumerate()
            .collect();
        near.sort_by(|a, b| b.1.total_cmp(&a.1));
        near.truncate(NEAR);
        let sum: f32 = near.iter().map(|n| n.1).sum();
        near.iter_mut().for_each(|n| n.1 /= sum);
        Reach { near }
    }

    /// Share of the key light that a vertex receives.
    pub fn lit(&self, reached: u64) -> f32 {
        (self.near.iter()).fold(0.0, |sum, (bit, w)| sum + w * (reached >> bit & 1) as f32)
    }
}
