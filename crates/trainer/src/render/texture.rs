//! Grey albedo textures on the head's two UV tiles, with a mip pyramid, and the map from texels
//! to the mesh.

use super::mesh::{Material, Mesh};
use super::raster::{Cull, Projected, Target, weights};
use glam::{Vec2, Vec3};

/// Texels per side of a tile; the texture is two tiles wide.
pub const TILE: usize = 384;

/// Mip levels.
const LEVELS: usize = 4;

/// Where a texel lies on the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Texel {
    /// Number into `Mesh::triangles`.
    pub triangle: u32,
    /// Weights of its corners.
    pub weights: Vec3,
    /// Position on the mean head \[mm\].
    pub mean: Vec3,
}

/// Which texel lies where.
pub struct TexelMap {
    /// Row-major, 2·[`TILE`] wide; `None` in the gaps.
    pub texels: Vec<Option<Texel>>,
    /// Texel coordinates of each landmark.
    pub landmarks: Vec<Vec2>,
}

/// Texel coordinates of texture coordinates.
pub fn to_texel(uv: Vec2) -> Vec2 {
    Vec2::new(uv.x * TILE as f32 - 0.5, (1.0 - uv.y) * TILE as f32 - 0.5)
}

impl TexelMap {
    /// Draws the skin in texture space.
    pub fn new(mesh: &Mesh) -> TexelMap {
        let run = mesh.run(Material::Skin);
        let flat: Vec<Projected> = (mesh.corner_uv[run.clone()].iter().flatten())
            .map(|uv| {
                let t = to_texel(*uv);
                Projected {
                    x: t.x,
                    y: t.y,
                    inv_z: 1.0,
                }
            })
            .collect();
        let corners: Vec<[u32; 3]> = (0..run.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        let mut target = Target::new(2 * TILE, TILE);
        target.draw(&flat, &corners, 0, Cull::None);
        let texels = (0..target.id.len())
            .map(|at| {
                let t = *corners.get(target.id[at] as usize)?;
                let c = t.map(|i| flat[i as usize]);
                let w = weights(c, (at % (2 * TILE)) as f32, (at / (2 * TILE)) as f32);
                let triangle = run.start as u32 + target.id[at];
                let [p, q, r] = mesh.triangles[triangle as usize].map(|v| mesh.mean[v as usize]);
                Some(Texel {
                    triangle,
                    weights: w,
                    mean: p * w.x + q * w.y + r * w.z,
                })
            })
            .collect();
        let landmark = |v: u32| {
            let skin = mesh.triangles[run.clone()]
                .iter()
                .zip(&mesh.corner_uv[run.clone()]);
            let mut corners = skin.flat_map(|(t, uv)| t.iter().zip(uv));
            let found = corners.find(|(c, uv)| **c == v && uv.x < 1.0);
            to_texel(found.map(|(_, uv)| *uv).unwrap_or_default())
        };
        let landmark = |v: &u32| match mesh.means.iter().find(|(mean, _)| mean == v) {
            Some((_, of)) => of.iter().map(|(v, w)| landmark(*v) * *w).sum(),
            None => landmark(*v),
        };
        TexelMap {
            texels,
            landmarks: mesh.landmarks.iter().map(landmark).collect(),
        }
    }
}

/// A texture with its halved copies.
pub struct Texture {
    levels: Vec<Level>,
}

struct Level {
    tile: usize,
    values: Vec<u8>,
}

impl Texture {
    /// From linear albedo 0..1 at the texels; gaps are filled from their neighbours.
    pub fn new(map: &TexelMap, albedo: &[f32]) -> Texture {
        let mut values = albedo.to_vec();
        let mut known: Vec<bool> = map.texels.iter().map(Option::is_some).collect();
        spread(&mut values, &mut known, 2 * TILE, 1 << LEVELS);
        Texture::from_bytes(values.iter().map(|v| encode(*v)).collect())
    }

    /// From the bytes of [`Texture::bytes`].
    pub fn from_bytes(values: Vec<u8>) -> Texture {
        let mut levels = vec![Level { tile: TILE, values }];
        while levels.len() < LEVELS {
            let next = levels[levels.len() - 1].half();
            levels.push(next);
        }
        Texture { levels }
    }

    /// The finest level, 2·[`TILE`] wide: square roots of albedo, 0..255.
    pub fn bytes(&self) -> &[u8] {
        &self.levels[0].values
    }

    /// The level for a number of samples per texel.
    pub fn level(&self, samples_per_texel: f32) -> usize {
        let halvings = -(samples_per_texel.max(1e-3).log2() + 0.3).floor();
        (halvings.max(0.0) as usize).min(LEVELS - 1)
    }

    /// Linear albedo at texture coordinates, bilinear.
    pub fn sample(&self, uv: Vec2, level: usize) -> f32 {
        let Level { tile, values } = &self.levels[level];
        let n = *tile as f32;
        let (x, y) = (uv.x * n - 0.5, (1.0 - uv.y) * n - 0.5);
        let x0 = (x.max(0.0) as usize).min(2 * tile - 2);
        let y0 = (y.max(0.0) as usize).min(tile - 2);
        let (fx, fy) = (
            (x - x0 as f32).clamp(0.0, 1.0),
            (y - y0 as f32).clamp(0.0, 1.0),
        );
        let at = y0 * 2 * tile + x0;
        let row = |at: usize| values[at] as f32 * (1.0 - fx) + values[at + 1] as f32 * fx;
        let v = (row(at) * (1.0 - fy) + row(at + 2 * tile) * fy) / 255.0;
        v * v
    }
}

impl Level {
    fn half(&self) -> Level {
        let tile = self.tile / 2;
        let wide = 2 * self.tile;
        let values = (0..tile * 2 * tile)
            .map(|i| {
                let at = i / (2 * tile) * 2 * wide + i % (2 * tile) * 2;
                let four = [at, at + 1, at + wide, at + wide + 1];
                let sum: u32 = four.iter().map(|&a| self.values[a] as u32).sum();
                ((sum + 2) / 4) as u8
            })
            .collect();
        Level { tile, values }
    }
}

/// Square-root coding gives dark tones more levels.
fn encode(albedo: f32) -> u8 {
    (albedo.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u8
}

/// Grows known values into unknown neighbours, one texel a round.
pub fn spread(values: &mut [f32], known: &mut [bool], width: usize, rounds: usize) {
    let height = values.len() / width;
    let mut border: Vec<usize> = (0..values.len()).filter(|&i| !known[i]).collect();
    for _ in 0..rounds {
        let filled: Vec<(usize, f32)> = border
            .iter()
            .filter_map(|&i| {
                let (x, y) = (i % width, i / width);
                let around = [
                    (x > 0).then(|| i - 1),
                    (x + 1 < width).then_some(i + 1),
                    (y > 0).then(|| i - width),
                    (y + 1 < height).then_some(i + width),
                ];
                let near = around.iter().flatten().filter(|&&j| known[j]);
                let (sum, n) = near.fold((0.0, 0), |(s, n), &j| (s + values[j], n + 1));
                (n > 0).then(|| (i, sum / n as f32))
            })
            .collect();
        if filled.is_empty() {
            return;
        }
        for (i, v) in filled {
            values[i] = v;
            known[i] = true;
        }
        border.retain(|&i| !known[i]);
    }
}
