//! Candide-3 as a head that can be drawn: its 184 triangles divided into curved patches (Phong
//! tessellation, Boubekeur and Alexa 2008) and painted. Behind its edge, which is that of a mask,
//! the head is closed by a vault; ears and a neck are added.
//!
//! It is drawn as a prop; the mesh that the renderer wants has its landmarks and no triangles.

use super::paint::Painter;
use crate::rigid::rotation_onto;
use anyhow::{Result, ensure};
use glam::{Mat3, Vec3};
use posewise::shape::FITTED;
use posewise_train::head::{Head, Wfm};
use posewise_train::render::draw::Prop;
use posewise_train::render::expression::Expression;
use posewise_train::render::mesh::Mesh;
use posewise_train::render::noise::{normal, smoothstep};
use posewise_train::render::skin::Looks;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::f32::consts::FRAC_PI_2;
use std::path::Path;

/// Parts of each triangle's edges.
const PARTS: usize = 16;
/// How far patches bulge towards their corners' tangent planes.
const BULGE: f32 = 0.6;
/// Spread of the shape units, over the standard deviation that training takes for them.
const SPREAD: f32 = 0.8;

/// The wireframe, ready to be drawn.
pub struct Candide {
    head: Head,
    /// Landmarks without triangles, for the renderer.
    pub mesh: Mesh,
    /// To the pose in which the morphable head looks ahead.
    turn: Mat3,
    patches: Patches,
    /// Vertices along the edge of the mask, in order.
    edge: Vec<u32>,
}

/// The divided triangles.
struct Patches {
    /// Of each point, the triangle that it is taken from and its weights.
    points: Vec<(usize, [f32; 3])>,
    triangles: Vec<[u32; 3]>,
    /// Neighbours of each point; none for those on an open edge, which stay where they are.
    neighbours: Vec<Vec<u32>>,
}

impl Patches {
    /// Neighbours share the points of their edge, so that light does not break there.
    fn new(faces: &[[u32; 3]]) -> Patches {
        let mut numbers: BTreeMap<Vec<(u32, usize)>, u32> = BTreeMap::new();
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for (n, face) in faces.iter().enumerate() {
            let mut point = |i: usize, j: usize| {
                let parts = [PARTS - i - j, i, j];
                let mut key: Vec<(u32, usize)> = face.iter().copied().zip(parts).collect();
                key.retain(|(_, part)| *part > 0);
                key.sort();
                *numbers.entry(key).or_insert_with(|| {
                    points.push((n, parts.map(|part| part as f32 / PARTS as f32)));
                    points.len() as u32 - 1
                })
            };
            for (i, j) in (0..PARTS).flat_map(|i| (0..PARTS - i).map(move |j| (i, j))) {
                triangles.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
                if i + j + 1 < PARTS {
                    triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
        let mut sides: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for [a, b, c] in &triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *sides.entry((*from.min(to), *from.max(to))).or_default() += 1;
            }
        }
        let mut neighbours = vec![Vec::new(); points.len()];
        for (a, b) in sides.keys() {
            neighbours[*a as usize].push(*b);
            neighbours[*b as usize].push(*a);
        }
        for ((a, b), _) in sides.iter().filter(|(_, count)| **count == 1) {
            neighbours[*a as usize].clear();
            neighbours[*b as usize].clear();
        }
        Patches {
            points,
            triangles,
            neighbours,
        }
    }

    /// Rounds the creases between patches.
    fn smooth(&self, points: &mut Vec<Vec3>) {
        /// Wide enough for a crease to vanish, narrow against a nose.
        const ROUNDS: usize = 12;
        for _ in 0..ROUNDS {
            let moved = points.iter().zip(&self.neighbours).map(|(p, around)| {
                let sum: Vec3 = around.iter().map(|n| points[*n as usize]).sum();
                match around.len() {
                    0 => *p,
                    n => p.lerp(sum / n as f32, 0.6),
                }
            });
            *points = moved.collect();
        }
    }
}

/// One person's Candide-3.
pub struct Face {
    identity: Vec<f32>,
    albedo: Vec<f32>,
    vault: Vec<f32>,
    rest: Vec<Prop>,
}

impl Candide {
    /// Reads the wireframe. Its zero pose is set to that of `kit` by the inner landmarks.
    pub fn read(path: &Path, kit: &Mesh) -> Result<Candide> {
        let head = Head::of_wfm(&Wfm::read(path)?)?;
        let bare = Head {
            triangles: Vec::new(),
            triangle_uv: Vec::new(),
            triangle_part: Vec::new(),
            ..head.clone()
        };
        let inner = |points: &dyn Fn(u32) -> Vec3, landmarks: &[u32]| -> Vec<Vec3> {
            landmarks[17..].iter().map(|v| points(*v)).collect()
        };
        let own = inner(&|v| Vec3::from(head.mean[v as usize]), &head.landmarks);
        let other = inner(&|v| kit.mean[v as usize], &kit.landmarks);
        Ok(Candide {
            turn: rotation_onto(&own, &other),
            mesh: Mesh::new(&bare)?,
            patches: Patches::new(&head.triangles),
            edge: edge(&head)?,
            head,
        })
    }

    /// A random person with these looks.
    pub fn face(&self, rng: &mut ChaCha8Rng, looks: &Looks) -> Face {
        let identity = self.head.identity.iter();
        let identity = identity.map(|_| SPREAD * normal(rng).clamp(-2.5, 2.5));
        let mean: Vec<Vec3> = self.head.mean.iter().map(|v| Vec3::from(*v)).collect();
        let landmarks = self.head.landmarks.map(|v| mean[v as usize]);
        let painter = Painter::new(looks, &landmarks);
        let albedo = self.surface(&mean).into_iter().map(|p| painter.albedo(p));
        Face {
            identity: identity.collect(),
            albedo: albedo.collect(),
            vault: vault_points(
                &self
                    .edge
                    .iter()
                    .map(|v| mean[*v as usize])
                    .collect::<Vec<_>>(),
            )
            .into_iter()
            .map(|p| painter.albedo(p))
            .collect(),
            rest: rest(looks),
        }
    }

    /// The landmarks' vertices of [`Candide::mesh`] (head axes), and everything to be drawn.
    pub fn draw(&self, face: &Face, expression: &Expression) -> (Vec<Vec3>, Vec<Prop>) {
        let animation: [f32; FITTED] = expression.animation();
        let shaped = self.head.vertices(&face.identity, &animation);
        let vertices: Vec<Vec3> = shaped.iter().map(|v| Vec3::from(*v)).collect();
        let mut surface = Prop::opaque(0.05);
        surface.vertices = self.surface(&vertices);
        surface.triangles = self.patches.triangles.clone();
        surface.albedo = face.albedo.clone();
        let along: Vec<Vec3> = self.edge.iter().map(|v| vertices[*v as usize]).collect();
        let rings: Vec<Vec<Vec3>> = vault_points(&along)
            .chunks_exact(along.len())
            .map(<[Vec3]>::to_vec)
            .collect();
        let mut vault = Prop::opaque(0.02);
        vault.skin(&rings, 0.0, false);
        vault.albedo = face.vault.clone();
        let mut props = vec![surface, vault];
        props.extend(face.rest.iter().cloned());
        props
            .iter_mut()
            .for_each(|p| p.transform(self.turn, Vec3::ZERO));
        (vertices.iter().map(|v| self.turn * *v).collect(), props)
    }

    /// Points of the divided triangles.
    fn surface(&self, vertices: &[Vec3]) -> Vec<Vec3> {
        let own: Vec<[f32; 3]> = vertices.iter().map(|v| v.to_array()).collect();
        let normals = self.head.normals(&own);
        let curved = |(n, w): &(usize, [f32; 3])| {
            let t = self.head.triangles[*n].map(|v| v as usize);
            let flat: Vec3 = (0..3).map(|k| vertices[t[k]] * w[k]).sum();
            let on_plane = |k: usize| {
                let normal = Vec3::from(normals[t[k]]);
                flat - normal * (flat - vertices[t[k]]).dot(normal)
            };
            let curved: Vec3 = (0..3).map(|k| on_plane(k) * w[k]).sum();
            flat.lerp(curved, BULGE)
        };
        let mut points = self.patches.points.iter().map(curved).collect();
        self.patches.smooth(&mut points);
        points
    }
}

/// The longest closed line of edges that belong to one triangle only.
fn edge(head: &Head) -> Result<Vec<u32>> {
    let mut count: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for [a, b, c] in &head.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *count.entry((*from.min(to), *from.max(to))).or_default() += 1;
        }
    }
    let mut open: Vec<(u32, u32)> = count.iter().filter(|c| *c.1 == 1).map(|c| *c.0).collect();
    let mut longest = Vec::new();
    while let Some((first, mut at)) = open.pop() {
        let mut line = vec![first];
        while at != first {
            line.push(at);
            let Some(next) = open.iter().position(|(a, b)| *a == at || *b == at) else {
                break;
            };
            let (a, b) = open.swap_remove(next);
            at = if a == at { b } else { a };
        }
        if at == first && line.len() > longest.len() {
            longest = line;
        }
    }
    ensure!(longest.len() > 8, "the wireframe has no edge");
    Ok(longest)
}

/// Rings from the edge of the mask over the back of the head.
fn vault_points(edge: &[Vec3]) -> Vec<Vec3> {
    const RINGS: usize = 24;
    /// Height that the rings shrink towards \[mm\].
    const MIDDLE_MM: f32 = -20.0;
    let ring = |k: usize| {
        let (s, c) = (k as f32 / RINGS as f32 * FRAC_PI_2).sin_cos();
        edge.iter().map(move |p| {
            // Below the ears the head ends at the neck.
            let low = smoothstep(20.0, 75.0, p.y);
            let deep = 150.0 - 85.0 * low;
            let wide = c * (1.0 + 0.45 * s * (1.0 - low));
            let y = MIDDLE_MM + (p.y - MIDDLE_MM) * (c * (1.0 + 0.25 * s)).min(1.0);
            Vec3::new(p.x * wide, y, p.z + deep * s)
        })
    };
    (0..=RINGS).flat_map(ring).collect()
}

/// What Candide-3 lacks besides: ears, the inside of the mouth, the neck.
fn rest(looks: &Looks) -> Vec<Prop> {
    let mouth = Vec3::new(0.0, 62.0, 6.0);
    let mut all = vec![ball(mouth, Vec3::new(26.0, 24.0, 18.0), 0.03)];
    for side in [-1.0, 1.0] {
        let at = Vec3::new(side * 72.0, 8.0, 62.0);
        all.push(ball(at, Vec3::new(7.0, 31.0, 18.0), looks.skin));
    }
    let mut neck = Prop::opaque(0.0);
    let rings: Vec<Vec<Vec3>> = [(20.0, 48.0), (90.0, 52.0), (140.0, 56.0), (185.0, 70.0)]
        .map(|(y, radius)| ring(Vec3::new(0.0, y, 72.0), radius, radius))
        .to_vec();
    neck.skin(&rings, 0.95 * looks.skin, false);
    all.push(neck);
    all
}

fn ring(at: Vec3, across: f32, deep: f32) -> Vec<Vec3> {
    const SIDES: usize = 40;
    (0..SIDES)
        .map(|i| {
            let (s, c) = (i as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
            at + Vec3::new(across * c, 0.0, deep * s)
        })
        .collect()
}

fn ball(at: Vec3, half: Vec3, albedo: f32) -> Prop {
    let mut prop = Prop::opaque(0.02);
    let rings: Vec<Vec<Vec3>> = (0..=24)
        .map(|k| {
            let (s, c) = (k as f32 / 24.0 * std::f32::consts::PI).sin_cos();
            ring(at - Vec3::Y * half.y * c, half.x * s, half.z * s)
        })
        .collect();
    prop.skin(&rings, albedo, false);
    prop
}
