//! Sheets of hair: pictures of strands with their opacity, on meshes that hang on a head.
//!
//! What is half opaque is drawn at half of the samples, chosen by a hash of their place, so that
//! sheets need no order.

use super::raster::Projected;
use glam::Vec2;
use std::sync::Arc;

/// Mip levels.
const LEVELS: usize = 5;

/// A picture of strands with halved copies.
pub struct Sheet {
    levels: Vec<Level>,
}

struct Level {
    size: [usize; 2],
    /// Brightness, of which the mean is 1, and opacity.
    values: Vec<[f32; 2]>,
}

impl Sheet {
    /// From linear brightness and opacity, row-major.
    pub fn new(size: [usize; 2], mut values: Vec<[f32; 2]>) -> Sheet {
        let (light, weight) = (values.iter()).fold((0.0, 0.0), |(l, w), [v, a]| (l + v * a, w + a));
        let mean = (light / f32::max(weight, 1e-6)).max(1e-6);
        values.iter_mut().for_each(|v| v[0] /= mean);
        let mut levels = vec![Level { size, values }];
        while levels.len() < LEVELS && levels[levels.len() - 1].size.iter().all(|s| *s > 4) {
            let next = levels[levels.len() - 1].half();
            levels.push(next);
        }
        Sheet { levels }
    }

    /// Brightness and opacity at texture coordinates, v down.
    fn sample(&self, uv: Vec2, level: usize) -> [f32; 2] {
        let Level { size, values } = &self.levels[level.min(self.levels.len() - 1)];
        let [w, h] = *size;
        let x = (uv.x * w as f32 - 0.5).clamp(0.0, w as f32 - 1.001);
        let y = (uv.y * h as f32 - 0.5).clamp(0.0, h as f32 - 1.001);
        let at = y as usize * w + x as usize;
        let (fx, fy) = (x.fract(), y.fract());
        let mix = |a: [f32; 2], b: [f32; 2], t: f32| [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
        let upper = mix(values[at], values[at + 1], fx);
        mix(upper, mix(values[at + w], values[at + w + 1], fx), fy)
    }
}

impl Level {
    fn half(&self) -> Level {
        let size = self.size.map(|s| s / 2);
        let values = (0..size[0] * size[1]).map(|i| {
            let at = i / size[0] * 2 * self.size[0] + i % size[0] * 2;
            let four = [at, at + 1, at + self.size[0], at + self.size[0] + 1];
            let four = four.map(|at| self.values[at]);
            let alpha = four.iter().map(|v| v[1]).sum::<f32>();
            // What is clear has no brightness of its own.
            let light = four.iter().map(|v| v[0] * v[1].max(1e-3)).sum::<f32>();
            [light / alpha.max(4e-3), alpha / 4.0]
        });
        Level {
            size,
            values: values.collect(),
        }
    }
}

/// How a sheet lies on a prop's triangles.
#[derive(Clone)]
pub struct Strands {
    /// The picture.
    pub sheet: Arc<Sheet>,
    /// Texture coordinates of the triangles' corners.
    pub uv: Arc<Vec<[Vec2; 3]>>,
    /// Factor on the opacity.
    pub dense: f32,
    /// Share of the light that reaches each vertex.
    pub open: Vec<f32>,
    /// So much nearer to the camera than it lies \[mm\]: what lies on the skin.
    pub nearer_mm: f32,
}

impl std::fmt::Debug for Strands {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Strands({} triangles)", self.uv.len())
    }
}

impl Strands {
    fn at(&self, triangle: usize, w: [f32; 3], level: usize) -> [f32; 2] {
        let [a, b, c] = self.uv[triangle];
        self.sheet.sample(a * w[0] + b * w[1] + c * w[2], level)
    }

    /// Whether a sample of a triangle shows a strand.
    pub fn is_there(&self, triangle: usize, at: [u32; 2], w: [f32; 3], level: usize) -> bool {
        let opacity = self.dense * self.at(triangle, w, level)[1];
        opacity > threshold(at, triangle as u32)
    }

    /// Brightness of a triangle at the weights of its corners, about 1.
    pub fn tone(&self, triangle: usize, w: [f32; 3], level: usize) -> f32 {
        self.at(triangle, w, level)[0]
    }

    /// The level whose texels are about as large as samples.
    pub fn level(&self, triangles: &[[u32; 3]], seen: &[Projected]) -> usize {
        let size = self.sheet.levels[0].size.map(|s| s as f32);
        let size = Vec2::from_array(size);
        let (mut texels, mut samples) = (0.0, 0.0);
        for (t, uv) in triangles.iter().zip(self.uv.iter()).step_by(7) {
            let area = |p: [Vec2; 3]| (p[1] - p[0]).perp_dot(p[2] - p[0]).abs();
            let corners = t.map(|v| seen[v as usize]);
            texels += area(uv.map(|uv| uv * size));
            samples += area(corners.map(|p| Vec2::new(p.x, p.y)));
        }
        // Sheets are seen from the side, too, where their samples are fewer.
        let halvings = 0.5 * (texels / samples.max(1.0)).max(1.0).log2() - 0.5;
        (halvings.max(0.0).round() as usize).min(LEVELS - 1)
    }
}

/// An evenly distributed number for a sample of a triangle.
fn threshold([x, y]: [u32; 2], triangle: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B);
    h = (h ^ triangle.wrapping_mul(0xC2B2_AE35)).wrapping_mul(0x27D4_EB2F);
    h = (h ^ h >> 15).wrapping_mul(0x2C1B_3C6D);
    ((h ^ h >> 13) >> 8) as f32 / (1 << 24) as f32 * 0.98 + 0.01
}
