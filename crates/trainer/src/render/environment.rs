//! Panoramas: light from all around, what eyes mirror, and backgrounds.
//!
//! What is far brighter than the rest, the sun or a lamp, becomes the key light, which throws
//! shadows with soft edges; the rest is light from as many directions as vertices know to reach
//! them.

use super::mesh::{DIRECTIONS, directions};
use crate::head::npz::Npz;
use anyhow::{Context, Result, ensure};
use glam::{Mat3, Vec2, Vec3};
use posewise::shape::Intrinsics;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

/// The panoramas of the file.
const NAMES: [&str; 18] = [
    "apartment",
    "bridge",
    "city",
    "dawn",
    "esplanade",
    "forest",
    "hall",
    "lab",
    "lobby",
    "night",
    "park",
    "sky",
    "studio",
    "sunrise",
    "sunset",
    "venice",
    "warehouse",
    "workshop",
];

/// Light above this multiple of the mean belongs to the key light.
const BRIGHT: f32 = 12.0;
/// Share of the light that an eye's surface mirrors.
const CORNEA: f32 = 0.03;
/// Rows and columns of the blurred copy.
const BLURRED: [usize; 2] = [16, 32];

/// Surroundings in linear light, of which the mean over all directions is 1.
pub struct Panorama {
    size: [usize; 2],
    light: Vec<f32>,
    blurred: Vec<f32>,
    /// Where the brightest light comes from, times the light that it casts.
    key: Vec3,
}

/// All panoramas of a file.
pub fn load(path: &Path) -> Result<Vec<Arc<Panorama>>> {
    let npz = &mut Npz::open(path)?;
    let one = |name: &&str| {
        let array = npz.array(name)?;
        let [rows, columns] = <[usize; 2]>::try_from(array.shape.clone())
            .ok()
            .context("a panorama has two axes")?;
        ensure!(rows > 0 && columns == 2 * rows, "{name}'s shape");
        Ok(Arc::new(Panorama::new([columns, rows], array.floats()?)))
    };
    NAMES.iter().map(one).collect()
}

/// Direction of the middle of a texel: x right of the panorama's middle, y down, z into it.
fn direction(size: [usize; 2], x: usize, y: usize) -> Vec3 {
    let turn = ((x as f32 + 0.5) / size[0] as f32 - 0.5) * TAU;
    let down = ((y as f32 + 0.5) / size[1] as f32 - 0.5) * PI;
    Vec3::new(turn.sin() * down.cos(), down.sin(), turn.cos() * down.cos())
}

impl Panorama {
    fn new(size: [usize; 2], mut light: Vec<f32>) -> Panorama {
        let weight = |i: usize| direction(size, 0, i / size[0]).row_weight();
        let total: f32 = (0..light.len()).map(weight).sum();
        let mean = |light: &[f32]| {
            let sum: f32 = light.iter().enumerate().map(|(i, l)| l * weight(i)).sum();
            (sum / total).max(1e-6)
        };
        // The brightest is taken off until the mean of the rest settles.
        let mut limit = f32::MAX;
        for _ in 0..4 {
            let capped: Vec<f32> = light.iter().map(|l| l.min(limit)).collect();
            limit = BRIGHT * mean(&capped);
        }
        let mut key = Vec3::ZERO;
        for (i, l) in light.iter().enumerate() {
            let excess = (l - limit).max(0.0) * weight(i) / total;
            // A whole sphere of light 1 lights a surface four times as much as its mean says.
            key += 4.0 * excess * direction(size, i % size[0], i / size[0]);
        }
        light.iter_mut().for_each(|l| *l = l.min(limit));
        let scale = 1.0 / mean(&light);
        light.iter_mut().for_each(|l| *l *= scale);
        let [rows, columns] = BLURRED;
        let step = [size[0] / columns, size[1] / rows];
        let cell = |i: usize| {
            let (x, y) = (i % columns * step[0], i / columns * step[1]);
            let rows = light.chunks_exact(size[0]).skip(y).take(step[1]);
            let sum: f32 = rows.flat_map(|row| &row[x..x + step[0]]).sum();
            sum / (step[0] * step[1]) as f32
        };
        Panorama {
            blurred: (0..rows * columns).map(cell).collect(),
            light,
            size,
            key: key * scale,
        }
    }

    fn at(&self, direction: Vec3) -> f32 {
        smooth(&self.light, self.size, direction)
    }
}

/// The weight of a row of an equirectangular picture.
trait Row {
    fn row_weight(self) -> f32;
}

impl Row for Vec3 {
    fn row_weight(self) -> f32 {
        (1.0 - self.y * self.y).max(0.0).sqrt()
    }
}

/// Light between texels, which round in the horizontal direction.
fn smooth(light: &[f32], size: [usize; 2], d: Vec3) -> f32 {
    let x = (d.x.atan2(d.z) / TAU + 0.5) * size[0] as f32 - 0.5;
    let y = (d.y.clamp(-1.0, 1.0).asin() / PI + 0.5) * size[1] as f32 - 0.5;
    let (x0, y0) = (x.floor(), y.floor());
    let soft = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy) = (soft(x - x0), soft(y - y0));
    let column = |k: f32| (x0 + k).rem_euclid(size[0] as f32) as usize % size[0];
    let row = |k: f32| (y0 + k).clamp(0.0, size[1] as f32 - 1.0) as usize * size[0];
    let mix = |row: usize| light[row + column(0.0)] * (1.0 - fx) + light[row + column(1.0)] * fx;
    mix(row(0.0)) * (1.0 - fy) + mix(row(1.0)) * fy
}

/// A panorama round a head.
#[derive(Clone)]
pub struct Sky {
    panorama: Arc<Panorama>,
    /// Camera axes to the panorama's.
    pub to_world: Mat3,
    /// Camera axes to the head's.
    to_head: Mat3,
    /// Light from each of the head's directions.
    light: [f32; DIRECTIONS],
    directions: [Vec3; DIRECTIONS],
    /// Factor on the panorama's light.
    pub level: f32,
}

impl std::fmt::Debug for Sky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Sky({})", self.level)
    }
}

impl Sky {
    /// A panorama turned at random about the vertical, before a camera that leans a little. Returns
    /// also the light of its key, times the direction to it in camera axes. A white surface that
    /// faces the camera returns `level` of light.
    pub fn random(
        rng: &mut ChaCha8Rng,
        panoramas: &[Arc<Panorama>],
        head_to_camera: Mat3,
        level: f32,
    ) -> (Sky, Vec3) {
        let panorama = panoramas[rng.random_range(0..panoramas.len())].clone();
        let turn = rng.random_range(0.0..TAU);
        let lean = rng.random_range(-0.25..0.25f32);
        let roll = rng.random_range(-0.1..0.1f32);
        let to_world =
            Mat3::from_rotation_y(turn) * Mat3::from_rotation_x(lean) * Mat3::from_rotation_z(roll);
        let directions = directions();
        let size = [BLURRED[1], BLURRED[0]];
        let light =
            directions.map(|d| smooth(&panorama.blurred, size, to_world * (head_to_camera * d)));
        let mut sky = Sky {
            to_world,
            to_head: head_to_camera.transpose(),
            light,
            directions,
            level: 1.0,
            panorama,
        };
        let key = to_world.transpose() * sky.panorama.key;
        let forward = -Vec3::Z;
        let facing = sky.diffuse(forward, u64::MAX) + 0.7 * key.dot(forward).max(0.0);
        sky.level = level / facing.max(0.05);
        (sky.clone(), key * sky.level)
    }

    /// Light that a white surface of a normal (camera axes) returns, which directions of the head
    /// reach.
    pub fn diffuse(&self, normal: Vec3, reached: u64) -> f32 {
        let normal = self.to_head * normal;
        let mut sum = 0.0;
        for (bit, (d, light)) in self.directions.iter().zip(&self.light).enumerate() {
            let lit = (reached >> bit & 1) as f32;
            sum += lit * light * normal.dot(*d).max(0.0);
        }
        self.level * sum * 4.0 / DIRECTIONS as f32
    }

    /// Light that a wet eye mirrors at a point with a normal (camera axes).
    pub fn mirrored(&self, point: Vec3, normal: Vec3) -> f32 {
        let view = point.normalize_or_zero();
        let direction = view - 2.0 * view.dot(normal) * normal;
        CORNEA * self.level * self.panorama.at(self.to_world * direction)
    }

    /// What a camera sees behind the head, as if its view were `wide` times as wide.
    pub fn background(&self, size: [usize; 2], camera: &Intrinsics, wide: f32) -> Vec<f32> {
        let pixel = |i: usize| {
            let (x, y) = ((i % size[0]) as f32, (i / size[0]) as f32);
            let ray = Vec2::new((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy);
            let ray = (wide * ray).extend(1.0).normalize();
            self.level * self.panorama.at(self.to_world * ray)
        };
        (0..size[0] * size[1]).map(pixel).collect()
    }
}
