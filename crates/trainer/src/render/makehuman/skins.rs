//! MakeHuman's skins on the family's texture.

use super::body;
use super::kin::Kin;
use crate::head::MakeHuman;
use crate::picture::Picture;
use crate::render::background::linear;
use crate::render::mesh::{Material, Mesh};
use crate::render::noise::fractal;
use crate::render::skin::Looks;
use crate::render::texture::{TILE, TexelMap};
use anyhow::{Context, Result, ensure};
use glam::{Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

/// Albedo (linear luma) of light and of dark skins.
const LIGHT: (f32, f32) = (0.2, 0.55);
const DARK: (f32, f32) = (0.05, 0.22);

/// A skin.
pub struct Skin {
    male: bool,
    /// 0 young, 1 of middle age, 2 old.
    age: usize,
    dark: bool,
    /// Brightness of each texel of the map, of which the face's mean is 1.
    tones: Vec<f32>,
}

/// Reads all skins of a folder.
pub fn load(folder: &Path, data: &MakeHuman, mesh: &Mesh, map: &TexelMap) -> Result<Vec<Skin>> {
    let paths = Picture::list(folder)?;
    ensure!(!paths.is_empty(), "{} has no skins", folder.display());
    let atlas = body::skin_uv(data, mesh);
    paths
        .par_iter()
        .map(|path| {
            let picture = image::open(path).with_context(|| path.display().to_string())?;
            let picture = picture.to_luma8();
            let name = path.file_name().context("a name")?.to_string_lossy();
            let table: Vec<f32> = (0..=255).map(linear).collect();
            let at = |x: f32, y: f32| {
                let inside = |v: f32, n: u32| (v.max(0.0) as u32).min(n - 1);
                let (x, y) = (inside(x, picture.width()), inside(y, picture.height()));
                table[picture.get_pixel(x, y).0[0] as usize]
            };
            let size = Vec2::new(picture.width() as f32, picture.height() as f32);
            let start = mesh.run(Material::Skin).start as u32;
            let tone = |(i, texel): (usize, &Option<crate::render::texture::Texel>)| {
                let Some(texel) = texel else { return 0.0 };
                let [a, b, c] = atlas[(texel.triangle - start) as usize];
                let w = texel.weights;
                let p = (a * w.x + b * w.y + c * w.z) * size;
                // Texels are larger than the picture's pixels, outside the face four times.
                let step = if i % (2 * TILE) < TILE { 0.44 } else { 1.2 };
                let mut sum = 0.0;
                for dy in [-1.0, 0.0, 1.0] {
                    for dx in [-1.0, 0.0, 1.0] {
                        sum += at(p.x + step * dx, p.y + step * dy);
                    }
                }
                sum / 9.0
            };
            let mut tones: Vec<f32> = map.texels.iter().enumerate().map(tone).collect();
            let mean = mean_of_face(&tones, map);
            tones.iter_mut().for_each(|t| *t /= mean);
            Ok(Skin {
                male: !name.contains("female"),
                age: ["young", "middleage", "old"]
                    .iter()
                    .position(|age| name.starts_with(age))
                    .unwrap_or(0),
                dark: name.contains("dark"),
                tones,
            })
        })
        .collect()
}

/// Mean over cheeks, nose and chin.
fn mean_of_face(tones: &[f32], map: &TexelMap) -> f32 {
    let plain = |p: Vec3| p.z < 20.0 && (12.0..90.0).contains(&p.y) && p.x.abs() < 50.0;
    let (mut sum, mut count) = (0.0, 0.0f32);
    for (tone, texel) in tones.iter().zip(&map.texels) {
        if texel.as_ref().is_some_and(|t| plain(t.mean)) {
            sum += tone;
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}

/// The place of a skin that suits someone.
pub fn choose(rng: &mut ChaCha8Rng, skins: &[Skin], kin: &Kin) -> usize {
    let dark = rng.random::<f32>() < 0.08 + 0.9 * kin.peoples[0];
    let age = match kin.age + rng.random_range(-0.15..0.15) {
        ..2.25 => 0,
        2.25..2.6 => 1,
        _ => 2,
    };
    let unlike = |skin: &Skin| {
        4 * usize::from(skin.dark != dark)
            + 2 * skin.age.abs_diff(age)
            + usize::from(skin.male != kin.male)
    };
    let best = skins.iter().map(unlike).min();
    let fits: Vec<usize> = (0..skins.len())
        .filter(|at| Some(unlike(&skins[*at])) == best)
        .collect();
    fits[rng.random_range(0..fits.len())]
}

impl Skin {
    /// A random albedo.
    pub fn tone(&self, rng: &mut ChaCha8Rng) -> f32 {
        let (low, high) = if self.dark { DARK } else { LIGHT };
        low * (high / low).powf(rng.random_range(0.0..1.0))
    }

    /// The bare skin of someone of these looks.
    pub fn over(&self, looks: &Looks) -> impl Fn(usize, Vec3) -> f32 {
        let (skin, blotches, seed) = (looks.skin, looks.blotches, looks.seed);
        move |texel, p| {
            let blotch = fractal(p * 0.035, 3, seed ^ 1);
            let freckles = fractal(p * 0.3, 2, seed ^ 2);
            skin * self.tones[texel] * (1.0 + blotches * (0.12 * blotch + 0.06 * freckles))
        }
    }
}
