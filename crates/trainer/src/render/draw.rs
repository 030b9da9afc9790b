//! Draws a posed head and props into linear light over a background.

use super::light::{Lights, Reach};
use super::mesh::{Material, Mesh};
use super::mirror::Mirror;
use super::raster::{Cull, EMPTY, Projected, Target, weights};
use super::skin::Painted;
use super::strands::Strands;
use glam::{Mat3, Vec2, Vec3};
use posewise::shape::Intrinsics;

/// Samples per pixel and axis.
pub const SUPER: usize = 2;

/// Nothing nearer than this is drawn \[mm\].
const NEAR_MM: f32 = 40.0;

/// Props more opaque than this hide what is behind them.
pub const HIDES: f32 = 0.7;

/// Share of the light on the lips that gets in between them, and the depth over which it falls
/// to 1/e \[mm\].
const INNER_LIGHT: f32 = 0.7;
const INNER_MM: f32 = 14.0;

/// Half the angle that an iris covers, seen from the eyeball's centre \[rad\].
pub const IRIS_RAD: f32 = 0.385;

/// A picture's size and camera.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The camera.
    pub camera: Intrinsics,
}

impl View {
    /// A view of focal length 1 round the optical axis.
    pub fn unit() -> View {
        View {
            width: 1,
            height: 1,
            camera: Intrinsics::new(1.0, 1.0, 0.0, 0.0),
        }
    }

    /// Image point \[px\] of a point in camera axes \[mm\].
    pub fn project(&self, p: Vec3) -> Vec2 {
        let z = p.z.max(1.0);
        Vec2::new(
            self.camera.fx * p.x / z + self.camera.cx,
            self.camera.fy * p.y / z + self.camera.cy,
        )
    }

    /// The same on the sample grid.
    pub fn to_samples(&self, p: Vec3) -> Projected {
        let q = self.project(p);
        let s = SUPER as f32;
        Projected {
            x: s * (q.x + 0.5) - 0.5,
            y: s * (q.y + 0.5) - 0.5,
            inv_z: if p.z > NEAR_MM { 1.0 / p.z } else { 0.0 },
        }
    }
}

/// A person's eyes.
#[derive(Clone, Copy, Debug)]
pub struct Eyes {
    /// Unit gaze of the image left's and the image right's eye, head axes.
    pub gaze: [Vec3; 2],
    /// Albedo of the sclera.
    pub white: f32,
    /// Iris albedo.
    pub iris: f32,
    /// Pupil radius over iris radius.
    pub pupil: f32,
    /// Strength of irregular stripes, as of reflections or bad texture.
    pub mottled: f32,
    /// Albedo of pupils that send the light of a lamp beside the camera back; 0 for dark ones.
    pub retro: f32,
}

/// A head in front of the camera.
pub struct Posed {
    /// Vertices \[mm, camera axes\].
    pub vertices: Vec<Vec3>,
    /// Unit normals, camera axes.
    pub normals: Vec<Vec3>,
    /// Head to camera.
    pub rotation: Mat3,
}

impl Posed {
    /// Moves a head's vertices (head axes) before the camera; hair stands off by `push_mm`.
    pub fn new(mesh: &Mesh, head: &[Vec3], push_mm: &[f32], rotation: Mat3, at: Vec3) -> Posed {
        let mut vertices: Vec<Vec3> = head.iter().map(|v| rotation * *v + at).collect();
        let mut normals = mesh.normals(&vertices);
        if push_mm.iter().any(|p| *p != 0.0) {
            for ((v, n), p) in vertices.iter_mut().zip(&normals).zip(push_mm) {
                *v += *n * *p;
            }
            normals = mesh.normals(&vertices);
        }
        Posed {
            vertices,
            normals,
            rotation,
        }
    }
}

/// A prop: clothes, glasses, a hand.
#[derive(Clone, Debug, Default)]
pub struct Prop {
    /// Vertices \[mm, camera axes\].
    pub vertices: Vec<Vec3>,
    /// Corners.
    pub triangles: Vec<[u32; 3]>,
    /// Albedo per vertex.
    pub albedo: Vec<f32>,
    /// Strength of reflections.
    pub gloss: f32,
    /// Below 1 for lenses. What is behind counts as visible up to [`HIDES`].
    pub opacity: f32,
    /// What its halves mirror, if they do.
    pub mirror: Option<Mirror>,
    /// Hair: where there is some, and how bright.
    pub strands: Option<Strands>,
}

impl Prop {
    /// Light that it mirrors at a point of a triangle, with the weights of its corners.
    pub fn mirrored(&self, corners: [usize; 3], weights: [f32; 3]) -> f32 {
        let Some(mirror) = &self.mirror else {
            return 0.0;
        };
        let lens = usize::from(corners[0] >= self.vertices.len() / 2);
        let corners = corners.map(|i| self.vertices[i]);
        let point = weights.iter().zip(corners).map(|(w, v)| *w * v).sum();
        mirror.light(lens, point)
    }

    fn normals(&self) -> Vec<Vec3> {
        let mut sums = vec![Vec3::ZERO; self.vertices.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| self.vertices[i as usize]);
            let n = (b - a).cross(c - a);
            t.iter().for_each(|&i| sums[i as usize] += n);
        }
        // Sheets are seen from both sides.
        let facing = |n: Vec3, v: &Vec3| if n.dot(*v) > 0.0 { -n } else { n };
        (sums.iter().zip(&self.vertices))
            .map(|(n, v)| facing(n.normalize_or_zero(), v))
            .collect()
    }
}

/// Everything in the picture.
pub struct Scene<'a> {
    /// Topology.
    pub mesh: &'a Mesh,
    /// The head.
    pub head: &'a Posed,
    /// Its skin.
    pub painted: &'a Painted,
    /// Its eyes.
    pub eyes: Eyes,
    /// Everything else.
    pub props: &'a [Prop],
    /// Light.
    pub lights: &'a Lights,
}

/// A drawn picture.
pub struct Drawn {
    /// Linear light, row-major.
    pub light: Vec<f32>,
    /// Depths, on the sample grid.
    pub target: Target,
}

/// Light from one vertex: (diffuse factor, sheen).
type Lit = (f32, f32);

/// Draws a scene over a background of linear light.
pub fn draw(scene: &Scene, view: &View, background: &[f32]) -> Drawn {
    let mut target = Target::new(view.width * SUPER, view.height * SUPER);
    let seen: Vec<Projected> = scene
        .head
        .vertices
        .iter()
        .map(|v| view.to_samples(*v))
        .collect();
    target.draw(&seen, &scene.mesh.triangles, 0, Cull::Back);
    let props: Vec<DrawnProp> = scene
        .props
        .iter()
        .map(|p| DrawnProp::new(p, view, scene.lights))
        .collect();
    let mut base = scene.mesh.triangles.len() as u32;
    let mut bases = Vec::new();
    for (prop, drawn) in scene.props.iter().zip(&props) {
        bases.push(base);
        if prop.opacity >= 1.0 {
            drawn.draw(prop, &mut target, base);
        }
        base += prop.triangles.len() as u32;
    }
    let shader = Shader::new(scene, view, seen);
    let mut samples = vec![f32::NAN; target.id.len()];
    for (at, (out, &id)) in samples.iter_mut().zip(&target.id).enumerate() {
        let (x, y) = ((at % target.width) as f32, (at / target.width) as f32);
        if id == EMPTY {
            continue;
        }
        let prop = bases.partition_point(|b| *b <= id);
        *out = match prop.checked_sub(1) {
            None => shader.head(id as usize, x, y),
            Some(k) => {
                props[k]
                    .shade(&scene.props[k], (id - bases[k]) as usize, x, y)
                    .0
            }
        };
    }
    let mut light = resolve(&samples, &target, background, view.width);
    for (prop, drawn) in scene
        .props
        .iter()
        .zip(&props)
        .filter(|(p, _)| p.opacity < 1.0)
    {
        drawn.overlay(prop, &mut target, &mut light, view.width);
    }
    Drawn { light, target }
}

/// Averages samples into pixels; where nothing was drawn the background shines through.
fn resolve(samples: &[f32], target: &Target, background: &[f32], width: usize) -> Vec<f32> {
    (background.iter().enumerate())
        .map(|(i, &back)| {
            let (x, y) = (i % width * SUPER, i / width * SUPER);
            let mut sum = 0.0;
            for row in samples.chunks_exact(target.width).skip(y).take(SUPER) {
                for s in row.iter().skip(x).take(SUPER) {
                    sum += if s.is_nan() { back } else { *s };
                }
            }
            sum / (SUPER * SUPER) as f32
        })
        .collect()
}

struct DrawnProp {
    seen: Vec<Projected>,
    lit: Vec<Lit>,
    /// Level of the picture of strands.
    level: usize,
}

impl DrawnProp {
    fn new(prop: &Prop, view: &View, lights: &Lights) -> DrawnProp {
        let lit = |(n, v): (&Vec3, &Vec3)| {
            let lit = lights.through_bars(*v);
            let (mut diffuse, sheen) = lights.reflect(*n, (-*v).normalize_or_zero(), 1.0, lit);
            if let Some(sky) = &lights.sky {
                diffuse += sky.diffuse(*n, u64::MAX);
            }
            // What lets light pass returns so much less of it.
            let diffuse = diffuse * prop.opacity;
            (diffuse, sheen * prop.gloss / lights.sheen.max(1e-3))
        };
        let mut lit: Vec<Lit> = prop.normals().iter().zip(&prop.vertices).map(lit).collect();
        let nearer_mm = prop.strands.as_ref().map_or(0.0, |s| s.nearer_mm);
        let seen = |v: &Vec3| view.to_samples(*v - v.normalize_or_zero() * nearer_mm);
        let seen: Vec<Projected> = prop.vertices.iter().map(seen).collect();
        let mut level = 0;
        if let Some(strands) = &prop.strands {
            level = strands.level(&prop.triangles, &seen);
            for (lit, open) in lit.iter_mut().zip(&strands.open) {
                *lit = (lit.0 * open, lit.1 * open);
            }
        }
        DrawnProp { seen, lit, level }
    }

    fn draw(&self, prop: &Prop, target: &mut Target, base: u32) {
        let Some(strands) = &prop.strands else {
            return target.draw(&self.seen, &prop.triangles, base, Cull::None);
        };
        let is_there = |triangle, at, w| strands.is_there(triangle, at, w, self.level);
        target.draw_where(&self.seen, &prop.triangles, base, Cull::None, is_there);
    }

    /// Light from a triangle at a sample, and its 1/z there.
    fn shade(&self, prop: &Prop, triangle: usize, x: f32, y: f32) -> (f32, f32) {
        let t = prop.triangles[triangle].map(|i| i as usize);
        let w = weights(t.map(|i| self.seen[i]), x, y).to_array();
        let (mut light, mut inv_z) = (0.0, 0.0);
        for (w, i) in w.iter().zip(t) {
            let (diffuse, sheen) = self.lit[i];
            light += w * (prop.albedo[i] * diffuse + sheen);
            inv_z += w * self.seen[i].inv_z;
        }
        light += prop.mirrored(t, w);
        if let Some(strands) = &prop.strands {
            light *= strands.tone(triangle, w, self.level);
        }
        (light, inv_z)
    }

    /// Blends a see-through prop over the picture.
    fn overlay(&self, prop: &Prop, target: &mut Target, light: &mut [f32], width: usize) {
        let mut own = Target::new(target.width, target.height);
        own.draw(&self.seen, &prop.triangles, 0, Cull::None);
        for (at, &id) in own.id.iter().enumerate().filter(|(_, id)| **id != EMPTY) {
            if own.inv_z[at] < target.inv_z[at] {
                continue;
            }
            let (x, y) = (at % own.width, at / own.width);
            let (value, _) = self.shade(prop, id as usize, x as f32, y as f32);
            let pixel = &mut light[y / SUPER * width + x / SUPER];
            *pixel += (value - *pixel * prop.opacity) / (SUPER * SUPER) as f32;
            if prop.opacity > HIDES {
                target.inv_z[at] = own.inv_z[at];
            }
        }
    }
}

/// Shades the head: light per vertex (vertices lie denser than pixels), texture and eyes per
/// sample.
struct Shader<'a> {
    scene: &'a Scene<'a>,
    seen: Vec<Projected>,
    lit: Vec<Lit>,
    level: usize,
    eye_centres: [Vec3; 2],
    material: Vec<(usize, Material)>,
    /// Middle of the lips \[mm, camera axes\], and light that comes in between them.
    lips: (Vec3, f32),
}

impl<'a> Shader<'a> {
    fn new(scene: &'a Scene<'a>, view: &View, seen: Vec<Projected>) -> Self {
        let head = scene.head;
        let reach = Reach::new(scene.lights.key, head.rotation);
        let lit: Vec<Lit> = (head
            .normals
            .iter()
            .zip(&head.vertices)
            .zip(&scene.mesh.reached))
        .zip(&scene.mesh.open)
        .map(|(((n, v), reached), open)| {
            let to_camera = -*v * v.length_recip();
            let lights = scene.lights;
            let lit = reach.lit(*reached) * lights.through_bars(*v);
            let (mut diffuse, sheen) = lights.reflect(*n, to_camera, *open, lit);
            if let Some(sky) = &lights.sky {
                diffuse += sky.diffuse(*n, *reached);
            }
            (diffuse, sheen)
        })
        .collect();
        let lips = [48, 54, 51, 57].map(|i| scene.mesh.landmarks[i] as usize);
        let middle = lips.iter().map(|v| head.vertices[*v]).sum::<Vec3>() / 4.0;
        let light = lips.iter().map(|v| lit[*v].0).sum::<f32>() / 4.0;
        let bridge = head.vertices[scene.mesh.landmarks[27] as usize];
        let samples_per_mm = view.camera.fx * SUPER as f32 / bridge.z.max(NEAR_MM);
        // The face tile is about 240 mm wide.
        let texels_per_mm = super::texture::TILE as f32 / 240.0;
        Shader {
            level: scene.painted.texture.level(samples_per_mm / texels_per_mm),
            eye_centres: [0, 1].map(|k| eye_centre(scene.mesh, head, k)),
            material: scene
                .mesh
                .materials
                .iter()
                .map(|(m, r)| (r.end, *m))
                .collect(),
            lips: (middle, INNER_LIGHT * light),
            scene,
            seen,
            lit,
        }
    }

    /// Linear light of a triangle of the head at a sample.
    fn head(&self, triangle: usize, x: f32, y: f32) -> f32 {
        let mesh = self.scene.mesh;
        let t = mesh.triangles[triangle].map(|i| i as usize);
        let w = weights(t.map(|i| self.seen[i]), x, y);
        let [wa, wb, wc] = w.to_array();
        let lit = t.map(|i| self.lit[i]);
        let diffuse = wa * lit[0].0 + wb * lit[1].0 + wc * lit[2].0;
        let sheen = wa * lit[0].1 + wb * lit[1].1 + wc * lit[2].1;
        let of = self.material.partition_point(|(end, _)| *end <= triangle);
        let lights = self.scene.lights;
        match self.material[of].1 {
            Material::Skin => {
                let uv = mesh.corner_uv[triangle];
                let uv = uv[0] * wa + uv[1] * wb + uv[2] * wc;
                let albedo = self.scene.painted.texture.sample(uv, self.level);
                lights.albedo(albedo) * diffuse + sheen
            }
            Material::Socket => 0.03 * diffuse,
            Material::Mouth | Material::Teeth if mesh.inner_albedo.is_some() => {
                self.inner(triangle, t, w)
            }
            Material::Mouth => (0.05 * diffuse).max(0.012),
            Material::Teeth => 0.55 * diffuse.max(0.25),
            Material::EyeRight => self.eye(0, t, w, diffuse),
            Material::EyeLeft => self.eye(1, t, w, diffuse),
        }
    }

    /// Teeth, gums, tongue and cheeks: light comes in through the lips and falls off behind them.
    fn inner(&self, triangle: usize, t: [usize; 3], w: Vec3) -> f32 {
        let albedo = self.scene.mesh.inner_albedo.as_ref();
        let albedo = albedo.map_or([0.05; 3], |all| all[triangle]);
        let albedo = Vec3::from(albedo).dot(w);
        let point = t.map(|i| self.scene.head.vertices[i]);
        let point = point[0] * w.x + point[1] * w.y + point[2] * w.z;
        let behind = (point - self.lips.0).dot(self.scene.head.rotation.z_axis);
        let falls = (-behind.max(0.0) / INNER_MM).exp();
        albedo * self.lips.1 * falls
    }

    fn eye(&self, k: usize, t: [usize; 3], w: Vec3, diffuse: f32) -> f32 {
        let v = t.map(|i| self.scene.head.vertices[i]);
        let p = v[0] * w.x + v[1] * w.y + v[2] * w.z;
        let out = (p - self.eye_centres[k]).normalize_or_zero();
        let eyes = &self.scene.eyes;
        let gaze = self.scene.head.rotation * eyes.gaze[k];
        let angle = out.dot(gaze).clamp(-1.0, 1.0).acos() / IRIS_RAD;
        let edge = |r: f32, soft: f32| super::noise::smoothstep(r - soft, r + soft, angle);
        let ring = 1.0 - 0.6 * edge(0.82, 0.15);
        let iris = eyes.iris * ring * (0.8 + 0.4 * edge(0.6, 0.3));
        let white = eyes.white * (1.0 - 0.2 * edge(2.2, 1.2));
        let dark = eyes.retro.max(0.004);
        let pupil = dark + (iris - dark) * edge(eyes.pupil, 0.08);
        let mut albedo = pupil + (white - pupil) * edge(1.0, 0.09);
        if eyes.mottled > 0.0 {
            let local = self.scene.head.rotation.transpose() * out;
            let stripes = super::noise::fractal(local * Vec3::new(22.0, 6.0, 6.0), 2, 71);
            albedo *= (1.0 + 2.0 * eyes.mottled * stripes).max(0.1);
        }
        let lights = self.scene.lights;
        let half = (lights.key - p.normalize()).normalize_or_zero();
        let catch = super::noise::smoothstep(0.986, 0.996, out.dot(half));
        let mirrored = lights.sky.as_ref().map_or(0.0, |sky| sky.mirrored(p, out));
        albedo * diffuse + 0.4 * catch * lights.key_power * diffuse.min(1.0) + mirrored
    }
}

/// The middle of an eyeball \[mm, camera axes\]: that of its box, because vertices are dense at the
/// cornea.
pub fn eye_centre(mesh: &Mesh, head: &Posed, eye: usize) -> Vec3 {
    let points = mesh.eyes[eye].iter().map(|v| head.vertices[*v as usize]);
    let local = points.map(|p| head.rotation.transpose() * p);
    let (low, high) = local.fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
    head.rotation * ((low + high) / 2.0)
}
