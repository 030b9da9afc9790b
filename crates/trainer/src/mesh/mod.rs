//! Writes section `MESH`: the face of the head with fewer vertices, which are vertices of the head.
//!
//! The region is cut out, without what is inside of lids, lips and nostrils. The landmarks take the
//! vertices nearest to where the 3D face has them; lines between them follow the head's edges.
//! Vertices go until [`VERTICES`] are left, most of them near eyes, lips and nose (`thin`).

mod lines;
mod other;
mod pulls;
mod surface;
mod thin;

use crate::face_section::{Mode, combined, identity_directions, quantised};
use crate::head::Head;
use crate::render;
use anyhow::{Context, Result, ensure};
use glam::Vec3;
pub use other::{Place, nearest, places_on};
use posewise::shape::{
    ANIMATION_NAMES, FaceModel, Identity, LANDMARKS, MAX_IDENTITIES, MESH_BLOCK, MESH_RING,
    MESH_TAG, MeshLine,
};
use posewise_format::SectionWriter;
use std::collections::{BTreeMap, BTreeSet};
use surface::{Edge, Surface, edge};
use thin::{Wanted, thin};

/// Vertices of the mesh: a multiple of [`MESH_BLOCK`].
pub const VERTICES: usize = 528;

/// Tip of the nose.
const NOSE: usize = 30;

/// A thinned face.
pub struct Thinned {
    /// Vertices of the head, those of the landmarks first.
    pub vertices: Vec<u32>,
    surface: Surface,
    lines: Vec<(MeshLine, Vec<u32>)>,
}

/// Whether a point of the mean head \[mm\] is in the mesh: up to where hair begins, back to the
/// ears, down to below the jaw.
fn is_in_region(p: Vec3) -> bool {
    let below_jaw = p.y + 0.75 * p.z > 122.0;
    let above_ear = p.y < -5.0 && p.z > 58.0;
    let lobe = p.y > 42.0 && p.z > 62.0;
    p.y > -74.0 && p.z < 72.0 && !below_jaw && !above_ear && !lobe
}

/// Whether a point of the mean head \[mm\] is around the nostrils, whose inside is no part of the
/// mesh.
fn is_of_nose(p: Vec3) -> bool {
    p.x.abs() < 26.0 && (15.0..55.0).contains(&p.y) && p.z < -5.0
}

/// Vertices of the nose that see less of the sky than this are inside of it.
const INSIDE: f32 = 0.3;

/// How long edges are to be near a landmark \[mm\], and how much longer for each millimetre away
/// from it.
fn edge_mm(landmark: usize) -> (f32, f32) {
    match landmark {
        0..17 => (10.0, 0.3),
        17..27 => (7.0, 0.25),
        27..31 => (7.0, 0.25),
        31..36 => (4.5, 0.3),
        36..48 => (3.2, 0.33),
        _ => (3.5, 0.33),
    }
}

/// Longest edges \[mm\].
const LONGEST_MM: f32 = 16.0;

/// Thins the face of a head. `landmarks_mm`: where the 3D face has the landmarks.
pub fn thinned(head: &Head, landmarks_mm: &[Vec3]) -> Result<Thinned> {
    let face = head.part("face").context("the head has no face")?;
    let points: Vec<Vec3> = head.mean.iter().map(|p| Vec3::from(*p)).collect();
    let open = render::mesh::Mesh::new(head)?.open;
    let is_dark = |v: &u32| is_of_nose(points[*v as usize]) && open[*v as usize] < INSIDE;
    let inside = |t: &[u32; 3]| {
        t.iter().all(|v| is_in_region(points[*v as usize])) && !t.iter().all(is_dark)
    };
    let triangles: Vec<[u32; 3]> = (head.triangles.iter().zip(&head.triangle_part))
        .filter(|(t, part)| **part == face && inside(t))
        .map(|(t, _)| *t)
        .collect();
    let whole = Surface::new(points, &triangles);
    let landmarks = lines::landmarks(head, &whole, landmarks_mm)?;
    let drawn = lines::drawn(&whole, &landmarks)?;
    let holes = [MeshLine::InnerLips, MeshLine::LeftEye, MeshLine::RightEye];
    let walls: BTreeSet<Edge> = (drawn.iter())
        .filter(|(line, _)| holes.contains(line))
        .flat_map(|(line, vertices)| lines::edges(*line, vertices))
        .map(|(a, b)| edge(a, b))
        .collect();
    let mut surface = whole.keep_reached(landmarks[NOSE], &walls);
    let boundary = surface.boundary();
    let along = drawn
        .iter()
        .flat_map(|(line, vertices)| lines::edges(*line, vertices));
    let along: BTreeSet<Edge> = (boundary.iter().copied().chain(along))
        .flat_map(|(a, b)| [(a, b), (b, a)])
        .collect();
    let length_mm: Vec<f32> = surface
        .points
        .iter()
        .map(|p| length_at(&surface, &landmarks, *p))
        .collect();
    let fixed = landmarks.iter().copied().collect();
    let wanted = Wanted {
        fixed: &fixed,
        lines: along,
        length_mm: &length_mm,
        count: VERTICES,
    };
    thin(&mut surface, wanted)?;
    let left: BTreeSet<u32> = surface.vertices().collect();
    ensure!(fixed.is_subset(&left), "a landmark is outside of the mesh");
    let mut others: Vec<u32> = left.difference(&fixed).copied().collect();
    others.sort_by_key(|v| along_curve(surface.point(*v)));
    let vertices: Vec<u32> = landmarks.iter().copied().chain(others).collect();
    let mut lines: Vec<(MeshLine, Vec<u32>)> = drawn
        .into_iter()
        .map(|(line, mut all)| {
            all.retain(|v| left.contains(v));
            (line, all)
        })
        .collect();
    lines.push((MeshLine::Edge, outline(&surface)?));
    Ok(Thinned {
        vertices,
        surface,
        lines,
    })
}

fn length_at(surface: &Surface, landmarks: &[u32; LANDMARKS], p: Vec3) -> f32 {
    let lengths = landmarks.iter().enumerate().map(|(i, vertex)| {
        let (length, slope) = edge_mm(i);
        length + slope * surface.point(*vertex).distance(p)
    });
    lengths.fold(LONGEST_MM, f32::min)
}

/// The longest loop of edges with one triangle.
fn outline(surface: &Surface) -> Result<Vec<u32>> {
    let boundary = surface.boundary();
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    for [a, b, c] in surface.triangles() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if boundary.contains(&edge(from, to)) {
                next.insert(from, to);
            }
        }
    }
    let mut longest = Vec::new();
    while let Some((start, mut at)) = next.pop_first() {
        let mut all = vec![start];
        while let Some(following) = next.remove(&at) {
            all.push(at);
            at = following;
        }
        ensure!(at == start, "the edge of the mesh is open");
        if all.len() > longest.len() {
            longest = all;
        }
    }
    Ok(longest)
}

/// The section for a head, whose landmarks are where the finished 3D face has them.
pub fn mesh_section(head: &Head, face: &FaceModel<'_>) -> Result<SectionWriter> {
    let neutral = face.neutral(&Identity::default());
    let thinned = thinned(head, neutral.landmarks())?;
    let vertices = &thinned.vertices;
    ensure!(
        vertices.len().is_multiple_of(MESH_BLOCK),
        "a block is not full"
    );
    let place: BTreeMap<u32, u16> = vertices.iter().copied().zip(0..).collect();
    let pick = |values: &[[f32; 3]]| -> Vec<[f32; 3]> {
        vertices.iter().map(|v| values[*v as usize]).collect()
    };
    let modes: Vec<Mode> = head.identity.iter().map(|mode| pick(mode)).collect();
    let identity: Vec<Mode> = identity_directions(head)
        .iter()
        .map(|direction| combined(&modes, direction))
        .collect();
    ensure!(identity.len() <= MAX_IDENTITIES, "too many identity modes");
    let animation = ANIMATION_NAMES.iter().map(|name| {
        let found = head.expressions.iter().find(|e| e.name == *name);
        match found {
            Some(expression) => pick(&expression.delta),
            None => vec![[0.0; 3]; vertices.len()],
        }
    });
    let animation: Vec<Mode> = animation.collect();
    let triangles: Vec<u16> = (thinned.surface.triangles().flatten())
        .map(|v| place[&v])
        .collect();
    let lists: Vec<Vec<u16>> = MeshLine::ALL
        .iter()
        .map(
            |line| match thinned.lines.iter().find(|(of, _)| of == line) {
                Some((_, all)) => all.iter().map(|v| place[v]).collect(),
                None => (0..LANDMARKS as u16).collect(),
            },
        )
        .collect();
    let pulls = pulls::pulls(&thinned.surface, vertices)?;
    let rings: Vec<u16> = (vertices.iter())
        .flat_map(|v| ring(&thinned.surface, *v).map(|v| place[&v]))
        .collect();
    let kinds = [&identity, &animation].map(|modes| quantised(modes));
    let (moved, runs) = runs(&kinds);
    let mut section = SectionWriter::new(MESH_TAG);
    section
        .scalar(vertices.len() as u32)
        .scalar(identity.len() as u32)
        .scalar(triangles.len() as u32 / 3)
        .scalar(lists.iter().map(Vec::len).sum::<usize>() as u32)
        .scalar(runs.len() as u32)
        .array(pick(&head.mean).as_flattened())
        .array(&kinds[0].0)
        .array(&kinds[1].0)
        .array(&moved)
        .array(runs.as_flattened())
        .array(
            pulls
                .iter()
                .map(|(by, _)| *by)
                .collect::<Vec<_>>()
                .as_flattened(),
        )
        .array(
            pulls
                .iter()
                .map(|(_, pull)| *pull)
                .collect::<Vec<_>>()
                .as_flattened(),
        )
        .array(&rings)
        .array(&triangles)
        .array(uvs(head, vertices).as_flattened())
        .array(
            &lists
                .iter()
                .map(|list| list.len() as u16)
                .collect::<Vec<_>>(),
        )
        .array(&lists.concat());
    Ok(section)
}

/// Scales of modes, and the modes.
type Quantised = (Vec<f32>, Vec<Vec<[i8; 3]>>);

/// For each block of vertices which modes move it, a bit each, and block by block what these do.
fn runs(kinds: &[Quantised; 2]) -> (Vec<u8>, Vec<[i8; 3 * MESH_BLOCK]>) {
    let modes = kinds
        .iter()
        .zip(STILL_MM)
        .flat_map(|((scales, modes), still)| {
            let still = scales.iter().map(move |scale| still / scale);
            modes.iter().zip(still)
        });
    let modes: Vec<(&Vec<[i8; 3]>, f32)> = modes.collect();
    let (mut moved, mut runs) = (Vec::new(), Vec::new());
    for first in (0..modes[0].0.len()).step_by(MESH_BLOCK) {
        let first_byte = moved.len();
        moved.resize(first_byte + modes.len().div_ceil(8), 0);
        for (k, (mode, still)) in modes.iter().enumerate() {
            let numbers = mode[first..first + MESH_BLOCK].as_flattened();
            if numbers.iter().any(|v| f32::from(*v).abs() > *still) {
                moved[first_byte + k / 8] |= 1 << (k % 8);
                runs.push(*numbers.first_chunk().expect("a whole block"));
            }
        }
    }
    (moved, runs)
}

/// A block that a mode moves by no more along any axis stays: an identity mode at a standard
/// deviation, an animation mode at weight 1 \[mm\].
const STILL_MM: [f32; 2] = [0.03, 0.15];

/// Where a point of the face \[mm\] is on a curve that fills the plane (Hilbert), so that vertices
/// of a block are neighbours and few modes move only a part of it.
fn along_curve(p: Vec3) -> u32 {
    const BITS: u32 = 6;
    const MM: f32 = 4.0;
    let most = (1 << BITS) - 1;
    let [mut x, mut y] = [p.x / MM + 32.0, p.y / MM + 24.0].map(|v| (v.max(0.0) as u32).min(most));
    let mut at = 0;
    for bit in (0..BITS).rev() {
        let (right, down) = (x >> bit & 1, y >> bit & 1);
        at = at << 2 | ((3 * right) ^ down);
        if down == 0 {
            if right == 1 {
                (x, y) = (most - x, most - y);
            }
            (x, y) = (y, x);
        }
    }
    at
}

/// Four of the vertices around one, evenly.
fn ring(surface: &Surface, vertex: u32) -> [u32; MESH_RING] {
    let ring = surface.ring(vertex);
    std::array::from_fn(|k| ring[k * ring.len() / MESH_RING])
}

/// Texture coordinates of vertices; v up.
fn uvs(head: &Head, vertices: &[u32]) -> Vec<[f32; 2]> {
    let mut of: BTreeMap<u32, [f32; 2]> = BTreeMap::new();
    let face = head.part("face");
    let corners = (head.triangles.iter().zip(&head.triangle_uv)).zip(&head.triangle_part);
    for ((corners, uvs), _) in corners.filter(|(_, part)| Some(**part) == face) {
        for (vertex, uv) in corners.iter().zip(uvs) {
            of.entry(*vertex).or_insert(head.uv[*uv as usize]);
        }
    }
    vertices
        .iter()
        .map(|v| of.get(v).copied().unwrap_or_default())
        .collect()
}
