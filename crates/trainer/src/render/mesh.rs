//! The head as the renderer uses it: drawable triangles by material, dense identity modes, sparse
//! expressions, and per vertex which directions of light reach it.

use super::raster::{Cull, Projected, Target};
use crate::head::Head;
use crate::head::makehuman::{Mix, Moves, mix};
use anyhow::{Result, ensure};
use glam::{Vec2, Vec3};
use posewise::shape::{JAW, LANDMARKS};
use std::ops::Range;

/// Identity modes that renders use; the rest move vertices by less than half a millimetre.
pub const IDENTITIES: usize = 40;

/// Below this height \[mm\] the head's mesh ends in a plate that turns with the head; a torso takes
/// its place.
const CHEST_MM: f32 = 172.0;

/// What a triangle is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Face, neck, scalp and ears: everything that has a texture.
    Skin,
    /// Eye sockets, behind the lids.
    Socket,
    /// Cheeks from inside, gums, tongue.
    Mouth,
    /// Both rows.
    Teeth,
    /// The eyeball at the image left of a frontal face.
    EyeRight,
    /// The eyeball at the image right of a frontal face.
    EyeLeft,
}

const PARTS: [(&str, Material); 9] = [
    ("face", Material::Skin),
    ("head_neck", Material::Skin),
    ("eye_socket_L", Material::Socket),
    ("eye_socket_R", Material::Socket),
    ("mouth_socket", Material::Mouth),
    ("gums_tongue", Material::Mouth),
    ("teeth", Material::Teeth),
    ("sclera_R", Material::EyeRight),
    ("sclera_L", Material::EyeLeft),
];

/// Directions from which [`Mesh::reached`] is known.
pub const DIRECTIONS: usize = 64;

/// A displacement of the vertices that it moves.
pub struct Shape {
    /// ARKit name.
    pub name: String,
    /// What it moves at 1.
    pub moves: Moves,
}

impl Shape {
    /// The vertices that it moves.
    pub fn moved(&self) -> impl Iterator<Item = u32> {
        self.moves.iter().map(|(v, _)| *v)
    }
}

/// Each material's run of the triangles.
pub type Runs = Vec<(Material, Range<usize>)>;

/// The head's topology and statistics.
pub struct Mesh {
    /// Neutral mean vertices \[mm, head frame\].
    pub mean: Vec<Vec3>,
    /// Modes of identity; none where heads are mixed otherwise.
    pub identity: Vec<Vec<Vec3>>,
    /// Expressions.
    pub shapes: Vec<Shape>,
    /// Corners, counter-clockwise from outside, sorted by material.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the corners: u 0..1 is the face tile, 1..2 the rest; v up.
    pub corner_uv: Vec<[Vec2; 3]>,
    /// Which corners of the skin's triangles are on an ear.
    pub ear: Vec<[bool; 3]>,
    /// Albedo of the corners of teeth and mouth; `None`: the same everywhere.
    pub inner_albedo: Option<Vec<[f32; 3]>>,
    /// Vertices without triangles that are means of others.
    pub means: Vec<(u32, Mix)>,
    /// Runs of `triangles`.
    pub materials: Runs,
    /// Vertex of each landmark.
    pub landmarks: [u32; LANDMARKS],
    /// Vertex of each jaw landmark on the lower jaw's edge; none at the chin.
    pub jaw_edge: [Option<u32>; JAW],
    /// Vertices of the eyeballs: the image left's (subject's right), the image right's.
    pub eyes: [Vec<u32>; 2],
    /// Bit d: light from direction d of [`directions`] reaches the vertex of the mean head.
    pub reached: Vec<u64>,
    /// Share of the sky that each vertex of the mean head sees.
    pub open: Vec<f32>,
    /// For each expression of the animation list its place in `shapes`.
    pub animation: Vec<Option<usize>>,
}

impl Mesh {
    /// Prepares a head; takes about a second.
    pub fn new(head: &Head) -> Result<Mesh> {
        let (numbers, materials) = drawn_triangles(head)?;
        let uv = |i: u32| Vec2::from(head.uv[i as usize]);
        let vertices = |v: &[[f32; 3]]| v.iter().map(|v| Vec3::from(*v)).collect::<Vec<_>>();
        let eye = |name: &str| -> Vec<u32> {
            let part = head.part(name);
            let of = (0..)
                .zip(&head.vertex_part)
                .filter(|(_, p)| Some(**p) == part);
            of.map(|(v, _)| v).collect()
        };
        let corner_uv: Vec<[Vec2; 3]> = (numbers.iter())
            .map(|n| head.triangle_uv[*n].map(uv))
            .collect();
        Ok(Mesh {
            mean: vertices(&head.mean),
            identity: head
                .identity
                .iter()
                .take(IDENTITIES)
                .map(|m| vertices(m))
                .collect(),
            shapes: head
                .expressions
                .iter()
                .map(|e| Shape {
                    name: e.name.clone(),
                    moves: (0..)
                        .zip(vertices(&e.delta))
                        .filter(|(_, d)| d.length_squared() > 1e-6)
                        .collect(),
                })
                .collect(),
            triangles: numbers.iter().map(|n| head.triangles[*n]).collect(),
            ear: corner_uv.iter().map(|uv| uv.map(is_ear)).collect(),
            corner_uv,
            inner_albedo: None,
            means: Vec::new(),
            materials,
            landmarks: head.landmarks,
            jaw_edge: head.jaw_edge,
            eyes: [eye("sclera_R"), eye("sclera_L")],
            reached: Vec::new(),
            open: Vec::new(),
            animation: head.animation.to_vec(),
        }
        .lit())
    }

    /// The same with what light reaches its vertices.
    pub fn lit(mut self) -> Mesh {
        self.reached = self.light_reach();
        self.open = self.openness();
        self
    }

    /// Moves the vertices that are means of others to where those are.
    pub fn settle(&self, head: &mut [Vec3]) {
        for (v, of) in &self.means {
            head[*v as usize] = mix(head, of);
        }
    }

    /// Place of an expression in `shapes`.
    pub fn shape(&self, name: &str) -> Option<usize> {
        self.shapes.iter().position(|s| s.name == name)
    }

    /// Vertices \[mm, head frame\] of a person with an expression (place in `shapes`, weight).
    pub fn vertices(&self, identity: &[f32], expression: &[(usize, f32)]) -> Vec<Vec3> {
        let mut out = self.mean.clone();
        for (mode, &w) in self.identity.iter().zip(identity) {
            out.iter_mut().zip(mode).for_each(|(o, d)| *o += *d * w);
        }
        self.express(&mut out, expression);
        out
    }

    /// The vertex with triangles that a landmark is, or mostly lies at.
    pub fn corner_of(&self, landmark: usize) -> u32 {
        let v = self.landmarks[landmark];
        let of = self.means.iter().find(|(mean, _)| *mean == v);
        let most = of.and_then(|(_, of)| of.iter().max_by(|a, b| a.1.total_cmp(&b.1)));
        most.map_or(v, |(corner, _)| *corner)
    }

    /// Adds an expression (place in `shapes`, weight) to a head.
    pub fn express(&self, head: &mut [Vec3], expression: &[(usize, f32)]) {
        for &(shape, w) in expression {
            for &(v, d) in &self.shapes[shape].moves {
                head[v as usize] += d * w;
            }
        }
    }

    /// Unit outward normals, area-weighted over the triangles.
    pub fn normals(&self, vertices: &[Vec3]) -> Vec<Vec3> {
        let mut sums = vec![Vec3::ZERO; vertices.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| vertices[i as usize]);
            let n = (b - a).cross(c - a);
            t.iter().for_each(|&i| sums[i as usize] += n);
        }
        let mut normals: Vec<Vec3> = sums.iter().map(|n| n.normalize_or_zero()).collect();
        for (v, of) in &self.means {
            normals[*v as usize] = mix(&normals, of).normalize_or_zero();
        }
        normals
    }

    /// The triangles of a material.
    pub fn run(&self, material: Material) -> Range<usize> {
        let found = self.materials.iter().find(|(m, _)| *m == material);
        found.map(|(_, r)| r.clone()).unwrap_or(0..0)
    }

    fn openness(&self) -> Vec<f32> {
        let around = directions();
        let normals = self.normals(&self.mean);
        (normals.iter().zip(&self.reached))
            .map(|(n, reached)| {
                let facing = around.map(|d| n.dot(d).max(0.0));
                let seen = facing
                    .iter()
                    .enumerate()
                    .filter(|(d, _)| reached >> d & 1 == 1);
                seen.map(|(_, f)| f).sum::<f32>() / facing.iter().sum::<f32>().max(1e-3)
            })
            .collect()
    }

    /// Draws the mean head from every direction and stores which vertices are visible: ambient
    /// occlusion and soft shadows without casting rays later.
    fn light_reach(&self) -> Vec<u64> {
        const SIDE: usize = 200;
        const MM_PER_SAMPLE: f32 = 2.0;
        // Tolerance for neighbours on the same surface.
        const SLACK_MM: f32 = 5.0;
        const FAR_MM: f32 = 1000.0;
        let centre = Vec3::new(0.0, 20.0, 60.0);
        let mut reached = vec![0u64; self.mean.len()];
        for (bit, d) in directions().iter().enumerate() {
            let z = -*d;
            let x = z.any_orthonormal_vector();
            let y = z.cross(x);
            let seen: Vec<Projected> = (self.mean.iter())
                .map(|v| {
                    let p = *v - centre;
                    Projected {
                        x: p.dot(x) / MM_PER_SAMPLE + SIDE as f32 / 2.0,
                        y: p.dot(y) / MM_PER_SAMPLE + SIDE as f32 / 2.0,
                        // Orthographic: any decreasing function of depth serves.
                        inv_z: FAR_MM - p.dot(z),
                    }
                })
                .collect();
            let mut target = Target::new(SIDE, SIDE);
            target.draw(&seen, &self.triangles, 0, Cull::Back);
            for (r, p) in reached.iter_mut().zip(&seen) {
                let (px, py) = (p.x.round() as usize, p.y.round() as usize);
                let inside = px < SIDE && py < SIDE;
                let near = if inside {
                    target.inv_z[py * SIDE + px]
                } else {
                    0.0
                };
                *r |= u64::from(p.inv_z + SLACK_MM >= near) << bit;
            }
        }
        reached
    }
}

/// Texture coordinates of the ears lie in strips at both sides of the face tile.
fn is_ear(uv: Vec2) -> bool {
    uv.x < 1.0 && (uv.x < 0.12 || uv.x > 0.88) && (0.38..0.70).contains(&uv.y)
}

/// Whether a torso takes the place of a point of the mean head.
fn is_chest(p: Vec3) -> bool {
    p.y > CHEST_MM || (p.y > 110.0 && p.x.abs() > 70.0)
}

/// Numbers of the triangles that are drawn, sorted by material, and each material's run of them.
fn drawn_triangles(head: &Head) -> Result<(Vec<usize>, Runs)> {
    let chest = |t: &[u32; 3]| (t.iter()).all(|v| is_chest(Vec3::from(head.mean[*v as usize])));
    let mut numbers = Vec::new();
    let mut materials = Runs::new();
    for (name, material) in PARTS {
        // Only the face is required; a head without teeth is drawn without.
        let Some(part) = head.part(name) else {
            ensure!(name != "face", "the head has no face");
            continue;
        };
        let start = numbers.len();
        let of_part = (0..head.triangles.len()).filter(|n| head.triangle_part[*n] == part);
        numbers.extend(of_part.filter(|n| !chest(&head.triangles[*n])));
        match materials.last_mut() {
            Some((last, run)) if *last == material => run.end = numbers.len(),
            _ => materials.push((material, start..numbers.len())),
        }
    }
    Ok((numbers, materials))
}

/// Evenly distributed unit directions (a Fibonacci lattice).
pub fn directions() -> [Vec3; DIRECTIONS] {
    std::array::from_fn(|i| {
        let z = 1.0 - (2 * i + 1) as f32 / DIRECTIONS as f32;
        let r = (1.0 - z * z).sqrt();
        let a = i as f32 * 2.399_963;
        Vec3::new(r * a.cos(), r * a.sin(), z)
    })
}
