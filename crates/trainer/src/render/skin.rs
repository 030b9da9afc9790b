//! Procedural people: skin of any tone, lips, brows, lashes, beards and hair, painted on the
//! head's texture as functions of the place on the mean head. No photograph is involved.

use super::mesh::Mesh;
use super::noise::{fractal, noise, smoothstep};
use super::texture::{TILE, Texel, TexelMap, Texture};
use glam::{Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Appearance of a procedural person.
#[derive(Clone, Debug)]
pub struct Looks {
    /// Seed of all noise.
    pub seed: u32,
    /// Skin albedo (linear luma).
    pub skin: f32,
    /// Hair albedo.
    pub hair: f32,
    /// Brow albedo over skin albedo, and half thickness \[mm\].
    pub brow: (f32, f32),
    /// Lip albedo over skin albedo.
    pub lips: f32,
    /// Strength of the beard: 0 none, 0.4 stubble, 1 full.
    pub beard: f32,
    /// Strength of blotches and freckles.
    pub blotches: f32,
    /// How far hair stands off the scalp \[mm\]; 0 is bald.
    pub hair_mm: f32,
    /// Height of the hairline above the eyes \[mm\].
    pub hairline_mm: f32,
    /// Lashes and eyeliner, 0..1.
    pub lashes: f32,
    /// Iris albedo.
    pub iris: f32,
    /// Albedo of the clothes.
    pub cloth: f32,
    /// Details of the lids; the default has none, for people seen from far away.
    pub lids: Lids,
}

/// Creases and make-up of the lids, fixed to the skin when an eye shuts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lids {
    /// Darkness of the upper lid's crease, 0..1, and its height above the margin \[mm\].
    pub crease: (f32, f32),
    /// Darkness of the skin between crease and margin; below 0 it is brighter.
    pub shadow: f32,
    /// Darkness of the line under the eye, 0..1, and its distance from the margin \[mm\].
    pub bag: (f32, f32),
    /// Additional length of the upper lashes over those of people seen from far away \[mm\].
    pub lashes_mm: f32,
    /// Additional distance from the lids' margins within which a photograph is not used \[mm\].
    pub bare_mm: f32,
}

impl Lids {
    /// Random ones.
    pub fn random(rng: &mut ChaCha8Rng) -> Lids {
        Lids {
            crease: (
                rng.random_range(0.0..0.85f32),
                rng.random_range(2.5..6.5f32),
            ),
            shadow: rng.random_range(-0.25..0.5f32),
            bag: (
                rng.random_range(0.0..0.5f32).powi(2) * 1.6,
                rng.random_range(3.0..8.0f32),
            ),
            lashes_mm: rng.random_range(0.0..1.5f32),
            bare_mm: rng.random_range(0.0..2.5f32),
        }
    }
}

impl Looks {
    /// A random person.
    pub fn random(rng: &mut ChaCha8Rng) -> Looks {
        // Log-uniform: as many dark as light skins.
        let skin = 0.07 * (0.55f32 / 0.07).powf(rng.random_range(0.0..1.0f32).powf(0.7));
        let dark_hair = rng.random_bool(0.7);
        let hair = if dark_hair {
            rng.random_range(0.01..0.08)
        } else {
            rng.random_range(0.08..0.45)
        };
        let beard = match rng.random_range(0..10) {
            0..6 => 0.0,
            6..8 => rng.random_range(0.15..0.5),
            _ => rng.random_range(0.5..1.0),
        };
        Looks {
            seed: rng.random(),
            skin,
            hair,
            brow: (rng.random_range(0.15..0.7), rng.random_range(2.0..4.5)),
            lips: rng.random_range(0.45..0.95),
            beard,
            blotches: rng.random_range(0.3..1.2),
            hair_mm: if rng.random_bool(0.12) {
                0.0
            } else {
                rng.random_range(2.0..22.0)
            },
            hairline_mm: rng.random_range(48.0..80.0),
            lashes: rng.random_range(0.2..1.0),
            iris: rng.random_range(0.02..0.2),
            cloth: rng.random_range(0.03..0.7),
            lids: Lids::default(),
        }
    }

    /// The same person with detailed lids, for close views.
    pub fn come_near(&mut self, rng: &mut ChaCha8Rng) {
        self.lids = Lids::random(rng);
        self.lashes = rng.random_range(0.4..1.0);
    }

    /// How much a point of the mean head belongs to the hair (signed distance inside \[mm\]).
    pub fn hair_depth(&self, p: Vec3, ear: bool) -> f32 {
        if self.hair_mm <= 0.0 || ear {
            return -50.0;
        }
        let ragged = 7.0 * fractal(p * 0.09, 3, self.seed ^ 7);
        // Over the forehead the hairline arches; it comes down before the ears and ends at the
        // nape.
        let front = -p.y - self.hairline_mm + 0.004 * p.x * p.x;
        let temple = (p.z - 42.0).min(12.0 - p.y);
        let back = (p.z - 92.0).min(62.0 - p.y);
        front.max(temple).max(back) + ragged
    }

    /// Albedo of hair at a point: strands that run back on the crown and down at the sides.
    pub fn hair_albedo(&self, p: Vec3) -> f32 {
        let strands = noise(Vec3::new(p.x * 0.8, p.y * 0.08, p.z * 0.5), self.seed ^ 11)
            + 0.6 * noise(Vec3::new(p.x * 0.25, p.y * 0.05, p.z * 0.2), self.seed ^ 12);
        self.hair * (1.0 + 0.35 * strands).max(0.2)
    }
}

/// The painted texture and the hair's volume.
pub struct Painted {
    /// Albedo.
    pub texture: Texture,
    /// Push outwards along the normal per vertex \[mm\].
    pub push_mm: Vec<f32>,
}

/// Labels run a little above the middle of the brows.
const BROW_SHIFT_MM: Vec2 = Vec2::new(0.0, 1.5);

/// Features that are drawn along the landmarks of the mean head.
pub struct Features {
    /// Frontal view (x, y) \[mm\] of each landmark.
    front: Vec<Vec2>,
    /// Texel coordinates of each landmark.
    texel: Vec<Vec2>,
    /// From the brow landmarks to the middle of the painted brows \[mm\].
    brow_shift: Vec2,
}

/// Shares of what covers a texel.
pub struct Cover {
    brow: f32,
    lips: f32,
    lash: f32,
    beard: f32,
    /// Share of light that the lids' creases and make-up take.
    crease: f32,
}

impl Features {
    /// The features of a mesh.
    pub fn new(mesh: &Mesh, map: &TexelMap) -> Features {
        let front = mesh
            .landmarks
            .iter()
            .map(|v| mesh.mean[*v as usize].truncate());
        Features {
            front: front.collect(),
            brow_shift: BROW_SHIFT_MM,
            texel: map.landmarks.clone(),
        }
    }

    /// Distance \[mm\] in the frontal view to the line through landmarks, and how far along it
    /// (0..1) the nearest point is.
    fn along(&self, p: Vec2, landmarks: &[usize], shift: Vec2) -> (f32, f32) {
        let n = landmarks.len() - 1;
        let mut best = (f32::INFINITY, 0.0);
        for (k, pair) in landmarks.windows(2).enumerate() {
            let (a, b) = (self.front[pair[0]] + shift, self.front[pair[1]] + shift);
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let d = (p - a.lerp(b, t)).length();
            if d < best.0 {
                best = (d, (k as f32 + t) / n as f32);
            }
        }
        best
    }

    /// Signed distance \[texels\] inside the polygon of landmarks in texture space.
    fn inside(&self, at: Vec2, landmarks: std::ops::Range<usize>) -> f32 {
        let corners = &self.texel[landmarks];
        let mut odd = false;
        let mut nearest = f32::INFINITY;
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x)
            {
                odd = !odd;
            }
            let t = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
            nearest = nearest.min((at - a.lerp(b, t)).length());
        }
        if odd { nearest } else { -nearest }
    }

    /// Distances \[mm\] in the frontal view to the nearest lid margin and inner lip line.
    pub fn margins(&self, p: Vec3) -> (f32, f32) {
        let front = p.truncate();
        let least = |lines: &[&[usize]]| {
            let distances = lines.iter().map(|l| self.along(front, l, Vec2::ZERO).0);
            distances.fold(f32::INFINITY, f32::min)
        };
        let lid = least(&[&[36, 37, 38, 39, 40, 41, 36], &[42, 43, 44, 45, 46, 47, 42]]);
        (lid, least(&[&[60, 61, 62, 63, 64, 65, 66, 67, 60]]))
    }

    fn cover(&self, looks: &Looks, at: Vec2, p: Vec3) -> Cover {
        let mut cover = Cover {
            brow: 0.0,
            lips: 0.0,
            lash: 0.0,
            beard: 0.0,
            crease: 0.0,
        };
        // Nothing is painted behind the face.
        if at.x >= TILE as f32 || p.z > 60.0 {
            return cover;
        }
        let front = p.truncate();
        for brow in [[17usize, 18, 19, 20, 21], [26, 25, 24, 23, 22]] {
            let (d, t) = self.along(front, &brow, self.brow_shift);
            // Thin at the temple, full towards the nose.
            let half = looks.brow.1 * (0.35 + 0.75 * smoothstep(0.0, 0.6, t));
            let hairs = noise(Vec3::new(p.x * 0.9, p.y * 0.6, 0.0), looks.seed ^ 21);
            let edge = half * (1.0 + 0.3 * hairs);
            cover.brow = cover.brow.max(1.0 - smoothstep(0.6 * edge, 1.2 * edge, d));
        }
        for lid in [[36usize, 37, 38, 39], [45, 44, 43, 42]] {
            let (d, _) = self.along(front, &lid, Vec2::ZERO);
            let reach = looks.lids.lashes_mm;
            cover.lash = cover
                .lash
                .max(1.0 - smoothstep(0.5 + 0.6 * reach, 1.9 + reach, d));
        }
        for lid in [[36usize, 41, 40, 39], [45, 46, 47, 42]] {
            let (d, _) = self.along(front, &lid, Vec2::ZERO);
            cover.lash = cover.lash.max(0.45 * (1.0 - smoothstep(0.3, 1.5, d)));
        }
        cover.crease = self.crease(&looks.lids, front);
        if front.y > 40.0 {
            // Past the inner landmarks everything is lip until the mouth's own parts begin.
            cover.lips = smoothstep(-1.0, 1.5, self.inside(at, 48..60));
            cover.beard = looks.beard * self.beard(looks, p) * (1.0 - cover.lips);
        }
        cover
    }

    /// Share of light that creases and make-up of the lids take.
    fn crease(&self, lids: &Lids, p: Vec2) -> f32 {
        let (mut dark, mut shade) = (0.0f32, 0.0f32);
        for (upper, lower) in [
            ([36, 37, 38, 39], [36, 41, 40, 39]),
            ([45, 44, 43, 42], [45, 46, 47, 42]),
        ] {
            let (depth, height) = lids.crease;
            let (d, t) = self.along(p, &upper, Vec2::new(0.0, -height));
            // It runs out towards the corners.
            let line = 1.0 - smoothstep(0.5, 2.2, d);
            dark = dark.max(depth * line * (4.0 * t * (1.0 - t)).clamp(0.25, 1.0));
            let (above, _) = self.along(p, &upper, Vec2::new(0.0, -0.5 * height));
            shade = shade.max(1.0 - smoothstep(0.35 * height, 0.8 * height, above));
            let (depth, depth_mm) = lids.bag;
            let (d, _) = self.along(p, &lower, Vec2::new(0.0, depth_mm));
            dark = dark.max(depth * (1.0 - smoothstep(0.3, 2.0, d)));
        }
        1.0 - (1.0 - dark) * (1.0 - lids.shadow * shade)
    }

    /// Where beards grow: round the mouth, on the chin, and up the jaw to the sideburns.
    fn beard(&self, looks: &Looks, p: Vec3) -> f32 {
        let ragged = 5.0 * fractal(p * 0.12, 3, looks.seed ^ 31);
        let cheek = 42.0 + 0.35 * (60.0 - p.x.abs()).max(0.0);
        let jaw = smoothstep(0.0, 12.0, p.y - cheek + ragged);
        let moustache = smoothstep(0.0, 5.0, p.y - 51.0 + ragged * 0.4);
        let near_mouth = smoothstep(40.0, 26.0, p.x.abs());
        let under_lip = p.y < 118.0;
        let grow = jaw.max(moustache * near_mouth);
        if under_lip {
            grow
        } else {
            grow * smoothstep(140.0, 118.0, p.y)
        }
    }
}

/// Paints a person.
pub fn paint(mesh: &Mesh, map: &TexelMap, features: &Features, looks: &Looks) -> Painted {
    Painted {
        texture: Texture::new(map, &paint_albedo(mesh, map, features, looks)),
        push_mm: push(mesh, looks),
    }
}

/// Linear albedo of a person's texels, 0 in the gaps.
pub fn paint_albedo(mesh: &Mesh, map: &TexelMap, features: &Features, looks: &Looks) -> Vec<f32> {
    paint_over(mesh, map, features, looks, |_, p| bare_skin(looks, p))
}

/// The same over a skin given by the number of a texel and its place on the mean head.
pub fn paint_over(
    mesh: &Mesh,
    map: &TexelMap,
    features: &Features,
    looks: &Looks,
    bare: impl Fn(usize, Vec3) -> f32,
) -> Vec<f32> {
    let texel_albedo = |(i, texel): (usize, &Option<Texel>)| match texel {
        None => 0.0,
        Some(texel) => texel_albedo(mesh, features, looks, i, texel, bare(i, texel.mean)),
    };
    map.texels.iter().enumerate().map(texel_albedo).collect()
}

fn texel_albedo(
    mesh: &Mesh,
    features: &Features,
    looks: &Looks,
    i: usize,
    texel: &Texel,
    bare: f32,
) -> f32 {
    let at = Vec2::new((i % (2 * TILE)) as f32, (i / (2 * TILE)) as f32);
    let p = texel.mean;
    let ear = mesh.ear[texel.triangle as usize][0];
    let cover = features.cover(looks, at, p);
    let mut value = bare;
    value *= 1.0 - (1.0 - looks.lips) * cover.lips;
    let stubble = 1.0 + 0.3 * noise(p * 0.9, looks.seed ^ 41);
    value += (looks.hair.max(0.015) * stubble - value) * (cover.beard * stubble).clamp(0.0, 0.92);
    value *= 1.0 - (1.0 - looks.brow.0) * cover.brow;
    value *= 1.0 - cover.crease;
    value *= 1.0 - 0.85 * looks.lashes * cover.lash;
    let hair = smoothstep(-3.0, 3.0, looks.hair_depth(p, ear));
    value += (looks.hair_albedo(p) - value) * hair;
    // Clothes begin below the neck.
    let cloth = smoothstep(158.0, 162.0, p.y + 0.15 * p.z);
    let weave = 1.0 + 0.15 * fractal(p * 0.2, 3, looks.seed ^ 51);
    value + (looks.cloth * weave - value) * cloth
}

/// Skin without features: blotches, pores, red cheeks and nose, darker sockets.
fn bare_skin(looks: &Looks, p: Vec3) -> f32 {
    let blotch = fractal(p * 0.035, 3, looks.seed ^ 1);
    let pores = fractal(p * 0.35, 2, looks.seed ^ 2);
    let ball = |c: Vec3, r: f32| (-(p - c).length_squared() / (r * r)).exp();
    let mirrored = Vec3::new(p.x.abs(), p.y, p.z);
    let cheek = (-(mirrored - Vec3::new(40.0, 38.0, 5.0)).length_squared() / 500.0).exp();
    let socket = (-(mirrored - Vec3::new(30.0, 3.0, -5.0)).length_squared() / 350.0).exp();
    let nose = ball(Vec3::new(0.0, 32.0, -45.0), 14.0);
    let shade = 1.0 + looks.blotches * (0.16 * blotch + 0.08 * pores);
    looks.skin * shade * (1.0 - 0.10 * cheek - 0.08 * nose - 0.22 * socket)
}

/// How far each vertex's hair stands off \[mm\].
pub fn push(mesh: &Mesh, looks: &Looks) -> Vec<f32> {
    let mut ear = vec![false; mesh.mean.len()];
    let mut skin = vec![false; mesh.mean.len()];
    for (t, is_ear) in mesh.triangles[mesh.run(super::mesh::Material::Skin)]
        .iter()
        .zip(&mesh.ear)
    {
        for (v, is_ear) in t.iter().zip(is_ear) {
            ear[*v as usize] |= is_ear;
            skin[*v as usize] = true;
        }
    }
    (mesh.mean.iter().enumerate())
        .map(|(v, p)| {
            if !skin[v] {
                return 0.0;
            }
            let depth = looks.hair_depth(*p, ear[v]);
            let tuft = 1.0 + 0.5 * fractal(*p * 0.05, 3, looks.seed ^ 61);
            // Less volume at the nape than at the crown.
            let nape = smoothstep(70.0, -10.0, p.y);
            looks.hair_mm * tuft * (0.3 + 0.7 * nape) * smoothstep(0.0, 14.0, depth)
        })
        .collect()
}
