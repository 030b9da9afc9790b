//! Skins from photographs: the picture that a head was fitted to, projected onto its texture.
//!
//! Texels that face the camera keep the picture; the turned-away side is taken from the mirrored
//! texel. Texels that neither shows are painted as for procedural people, and so are the margins of
//! lids and lips, where a fit that is off by half a millimetre would paint an eyeball on a lid. The
//! picture's low-frequency light is divided out.

use super::background::linear;
use super::draw::{SUPER, View};
use super::mesh::Mesh;
use super::noise::smoothstep;
use super::person::Person;
use super::raster::{Cull, Projected, Target};
use super::skin::{Features, Looks, Painted, paint_albedo, push};
use super::texture::{TILE, TexelMap, Texture};
use crate::fit::PhotoFit;
use crate::head::Head;
use glam::{Vec2, Vec3};
use image::GrayImage;
use nalgebra::{Matrix4, Vector4};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Below this cosine between normal and view a texel is too stretched to use.
const GRAZING: f32 = 0.35;

/// A photograph's values for each texel.
struct Seen {
    /// Linear light.
    light: Vec<f32>,
    /// How squarely the camera saw it, 0..1.
    trust: Vec<f32>,
    /// Normal in head axes.
    normal: Vec<Vec3>,
}

/// Makes people from photographs.
pub struct Photographer<'a> {
    /// The head, for fits.
    pub head: &'a Head,
    /// The same for drawing.
    pub mesh: &'a Mesh,
    /// Texels.
    pub map: &'a TexelMap,
    /// Painted features.
    pub features: &'a Features,
    /// Whether lids are painted in detail.
    pub near: bool,
}

impl Photographer<'_> {
    /// The person of a fitted photograph; `None` when too little of the face is visible.
    pub fn person(&self, id: u32, fit: &PhotoFit, photo: &GrayImage, seed: u64) -> Option<Person> {
        let mut seen = self.look(fit, photo);
        let skin = self.remove_light(&mut seen)?;
        self.drop_strays(&mut seen, skin);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(u64::from(id));
        let mut looks = Looks::random(&mut rng);
        looks.skin = skin;
        looks.beard = 0.0;
        // The picture is used up to here; hair begins at the person's own hairline at the earliest.
        looks.hairline_mm = rng.random_range(58.0..78.0);
        looks.hair = self.hair_tone(&seen).unwrap_or(looks.hair).clamp(0.01, 0.6);
        if looks.hair > 0.7 * skin {
            // Not darker than the skin: bald, grey or covered; no volume.
            looks.hair_mm = looks.hair_mm.min(3.0);
        }
        if self.near {
            looks.come_near(&mut rng);
        }
        let mut albedo = paint_albedo(self.mesh, self.map, self.features, &looks);
        self.blend(&mut albedo, &seen, looks.lids.bare_mm);
        Some(Person {
            id,
            painted: Painted {
                texture: Texture::new(self.map, &albedo),
                push_mm: push(self.mesh, &looks),
            },
            identity: fit.identity.clone(),
            iris: looks.iris,
            skin,
            hair: (looks.hair_mm > 0.0).then_some(looks.hair),
            cloth: looks.cloth,
        })
    }

    /// Projects every texel into the photograph.
    fn look(&self, fit: &PhotoFit, photo: &GrayImage) -> Seen {
        let vertices: Vec<Vec3> = fit
            .vertices(self.head)
            .into_iter()
            .map(Vec3::from)
            .collect();
        let normals = self.mesh.normals(&vertices);
        let view = View {
            width: photo.width() as usize,
            height: photo.height() as usize,
            camera: fit.intrinsics(),
        };
        let mut target = Target::new(view.width * SUPER, view.height * SUPER);
        let seen: Vec<Projected> = vertices.iter().map(|v| view.to_samples(*v)).collect();
        target.draw(&seen, &self.mesh.triangles, 0, Cull::Back);
        let to_head = fit.pose().rotation.transpose();
        let n = self.map.texels.len();
        let mut out = Seen {
            light: vec![0.0; n],
            trust: vec![0.0; n],
            normal: vec![Vec3::ZERO; n],
        };
        for (i, texel) in self.map.texels.iter().enumerate() {
            let Some(texel) = texel else { continue };
            let corners = self.mesh.triangles[texel.triangle as usize];
            let mix = |of: &[Vec3]| {
                let [a, b, c] = corners.map(|v| of[v as usize]);
                a * texel.weights.x + b * texel.weights.y + c * texel.weights.z
            };
            let (p, normal) = (mix(&vertices), mix(&normals).normalize_or_zero());
            out.normal[i] = to_head * normal;
            let facing = -normal.dot(p.normalize());
            let q = view.project(p);
            let s = view.to_samples(p);
            let margin = 1.0;
            let inside = q.x > margin
                && q.y > margin
                && q.x < view.width as f32 - 1.0 - margin
                && q.y < view.height as f32 - 1.0 - margin;
            if facing < GRAZING || !inside {
                continue;
            }
            let at = s.y.round() as usize * target.width + s.x.round() as usize;
            if target.inv_z[at] > 0.0 && 1.0 / target.inv_z[at] < p.z - 4.0 {
                continue;
            }
            out.light[i] = bilinear(photo, q);
            out.trust[i] = smoothstep(GRAZING, 0.75, facing);
        }
        out
    }

    /// Divides out light that varies with the normal's direction; returns the skin's albedo.
    fn remove_light(&self, seen: &mut Seen) -> Option<f32> {
        // The plain skin of cheeks, nose and forehead.
        let plain = |p: Vec3| {
            p.z < 25.0 && (-55.0..90.0).contains(&p.y) && !(-26.0..8.0).contains(&p.y) && p.y < 50.0
        };
        let picks = || {
            (self.map.texels.iter().enumerate().step_by(3)).filter_map(|(i, t)| {
                let usable = t.as_ref().is_some_and(|t| plain(t.mean)) && seen.trust[i] > 0.3;
                usable.then_some(i)
            })
        };
        let mut values: Vec<f32> = picks().map(|i| seen.light[i]).collect();
        if values.len() < 2000 {
            return None;
        }
        values.sort_by(f32::total_cmp);
        let typical = values[values.len() / 2].max(0.01);
        // Least squares with outliers (hair, spectacles, highlights) left out.
        let (mut a, mut b) = (Matrix4::identity() * 1e-3, Vector4::zeros());
        for i in picks().filter(|&i| (0.35..2.5).contains(&(seen.light[i] / typical))) {
            let n = seen.normal[i];
            let row = Vector4::new(1.0, n.x, n.y, n.z);
            a += row * row.transpose();
            b += row * seen.light[i];
        }
        let c = a.cholesky()?.solve(&b);
        for (light, n) in seen.light.iter_mut().zip(&seen.normal) {
            let shade = (c[0] + c[1] * n.x + c[2] * n.y + c[3] * n.z) / typical;
            *light /= shade.clamp(0.45, 2.0).powf(0.8);
        }
        // The light's brightness is unknown: regress towards a mean skin.
        let skin = (0.25f32 * typical).sqrt().clamp(0.06, 0.55);
        seen.light.iter_mut().for_each(|l| *l *= skin / typical);
        Some(skin)
    }

    /// At the sides of the face, hair and background that a loose outline let in are dropped: they
    /// differ from the skin, or from the beard where the chin has one.
    fn drop_strays(&self, seen: &mut Seen, skin: f32) {
        let chin = |p: Vec3| p.x.abs() < 30.0 && (88.0..112.0).contains(&p.y) && p.z < 20.0;
        let chin = self.median(seen, chin).unwrap_or(skin);
        for (i, texel) in self.map.texels.iter().enumerate() {
            let Some(texel) = texel else { continue };
            let p = texel.mean;
            let side = smoothstep(40.0, 52.0, p.x.abs()).max(smoothstep(98.0, 110.0, p.y));
            let side = side * smoothstep(-62.0, -45.0, p.y);
            let expected = skin + (chin - skin) * smoothstep(45.0, 75.0, p.y);
            let ratio = seen.light[i] / expected.max(0.01);
            let stray = (1.0 - smoothstep(0.5, 0.75, ratio)).max(smoothstep(1.5, 2.2, ratio));
            seen.trust[i] *= 1.0 - side * stray;
        }
    }

    /// Median light of the seen texels in a region of the mean head.
    fn median(&self, seen: &Seen, within: impl Fn(Vec3) -> bool) -> Option<f32> {
        let mut tones: Vec<f32> = (self.map.texels.iter().enumerate())
            .filter(|(i, t)| seen.trust[*i] > 0.1 && t.as_ref().is_some_and(|t| within(t.mean)))
            .map(|(i, _)| seen.light[i])
            .collect();
        tones.sort_by(f32::total_cmp);
        tones
            .get(tones.len() / 2)
            .copied()
            .filter(|_| tones.len() > 300)
    }

    /// Median tone high on the forehead, where hair usually is.
    fn hair_tone(&self, seen: &Seen) -> Option<f32> {
        self.median(seen, |p| (-98.0..-78.0).contains(&p.y) && p.z < 20.0)
    }

    fn blend(&self, albedo: &mut [f32], seen: &Seen, bare_mm: f32) {
        for (i, texel) in self.map.texels.iter().enumerate() {
            let Some(texel) = texel else { continue };
            let ear = self.mesh.ear[texel.triangle as usize][0];
            let region = self.region(texel.mean, ear, bare_mm);
            if region <= 0.0 {
                continue;
            }
            let other = mirrored(i);
            let own = smoothstep(0.02, 0.4, seen.trust[i]);
            let far = smoothstep(0.02, 0.4, seen.trust[other]) * (1.0 - own);
            if own + far > 0.0 {
                let light = (own * seen.light[i] + far * seen.light[other]) / (own + far);
                albedo[i] += (light - albedo[i]) * (own + far) * region;
            }
        }
    }

    /// Where the picture is used at all: the face without ears, lid margins and inner lips.
    fn region(&self, p: Vec3, ear: bool, bare_mm: f32) -> f32 {
        if ear {
            return 0.0;
        }
        let (lid, lip) = self.features.margins(p);
        smoothstep(62.0, 40.0, p.z)
            * smoothstep(-92.0, -72.0, p.y)
            * smoothstep(132.0, 112.0, p.y)
            * smoothstep(0.8 + bare_mm, 2.6 + bare_mm, lid)
            * smoothstep(0.3, 1.6, lip)
    }
}

/// The texel on the other side of the face: both tiles are symmetric.
fn mirrored(i: usize) -> usize {
    let (x, row) = (i % (2 * TILE), i / (2 * TILE) * 2 * TILE);
    row + if x < TILE {
        TILE - 1 - x
    } else {
        3 * TILE - 1 - x
    }
}

/// Linear light between pixels; `q` lies inside.
fn bilinear(photo: &GrayImage, q: Vec2) -> f32 {
    let (x, y) = (q.x as u32, q.y as u32);
    let at = |dx, dy| linear(photo.get_pixel(x + dx, y + dy).0[0]);
    let (fx, fy) = (q.x.fract(), q.y.fract());
    let upper = at(0, 0) * (1.0 - fx) + at(1, 0) * fx;
    upper * (1.0 - fy) + (at(0, 1) * (1.0 - fx) + at(1, 1) * fx) * fy
}
