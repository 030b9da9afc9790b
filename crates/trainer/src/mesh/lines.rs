//! Where landmarks and lines lie on the head.

use super::surface::Surface;
use crate::head::Head;
use anyhow::{Context, Result, ensure};
use glam::Vec3;
use posewise::shape::{LANDMARKS, MIRROR, MeshLine};
use std::collections::BTreeSet;

/// A landmark's vertex is within this of the kit's own \[mm\] …
const NEAR_MM: f32 = 7.0;
/// … and an open jaw or a shut eye moves both alike \[mm\]: the lips and the lids of an eye are
/// near each other.
const ALIKE_MM: f32 = 4.0;
/// Expressions at this weight say so.
const PARTLY: f32 = 0.35;

/// The vertex nearest to where the 3D face has each landmark, the same on both sides.
pub fn landmarks(head: &Head, surface: &Surface, wanted: &[Vec3]) -> Result<[u32; LANDMARKS]> {
    let moves: Vec<&Vec<[f32; 3]>> = ["jawOpen", "eyeBlinkLeft", "eyeBlinkRight"]
        .iter()
        .filter_map(|name| head.expressions.iter().find(|e| e.name == *name))
        .map(|expression| &expression.delta)
        .collect();
    let all: Vec<u32> = surface.vertices().collect();
    let mut out = head.landmarks;
    let mut taken = BTreeSet::new();
    for i in (0..LANDMARKS).filter(|i| *i <= MIRROR[*i]) {
        let own = head.landmarks[i];
        let (a, b) = (wanted[i], wanted[MIRROR[i]]);
        let mut place = (a + b * Vec3::new(-1.0, 1.0, 1.0)) / 2.0;
        let is_middle = i == MIRROR[i];
        if is_middle {
            place.x = 0.0;
        }
        let is_alike = |vertex: u32| {
            moves.iter().all(|by_vertex| {
                let [a, b] = [vertex, own].map(|v| Vec3::from(by_vertex[v as usize]));
                PARTLY * a.distance(b) < ALIKE_MM
            })
        };
        let near = all.iter().copied().filter(|vertex| {
            surface.point(*vertex).distance(surface.point(own)) < NEAR_MM
                && (!is_middle || surface.point(*vertex).x.abs() < 0.1)
                && is_alike(*vertex)
                && !taken.contains(vertex)
        });
        out[i] = nearest(surface, near, place).with_context(|| format!("landmark {i}"))?;
        taken.insert(out[i]);
        if !is_middle {
            let mirrored = surface.point(out[i]) * Vec3::new(-1.0, 1.0, 1.0);
            let others = all.iter().copied().filter(|vertex| !taken.contains(vertex));
            out[MIRROR[i]] = nearest(surface, others, mirrored).context("no other side")?;
            taken.insert(out[MIRROR[i]]);
        }
    }
    Ok(out)
}

fn nearest(surface: &Surface, among: impl Iterator<Item = u32>, place: Vec3) -> Option<u32> {
    among.min_by(|a, b| {
        let far = |v: &u32| surface.point(*v).distance_squared(place);
        far(a).total_cmp(&far(b))
    })
}

/// Landmarks along a line, and whether it is a loop.
pub fn path(line: MeshLine) -> Option<(Vec<usize>, bool)> {
    Some(match line {
        MeshLine::OuterLips => ((48..60).collect(), true),
        MeshLine::InnerLips => ((60..68).collect(), true),
        MeshLine::LeftEye => ((42..48).collect(), true),
        MeshLine::RightEye => ((36..42).collect(), true),
        MeshLine::LeftBrow => ((22..27).collect(), false),
        MeshLine::RightBrow => ((17..22).collect(), false),
        _ => return None,
    })
}

/// The vertices of each line of [`path`], before the surface is thinned.
pub fn drawn(surface: &Surface, landmarks: &[u32; LANDMARKS]) -> Result<Vec<(MeshLine, Vec<u32>)>> {
    let mut taken: BTreeSet<u32> = landmarks.iter().copied().collect();
    let mut drawn = Vec::new();
    for line in MeshLine::ALL {
        let Some((path, is_loop)) = path(line) else {
            continue;
        };
        let mut vertices: Vec<u32> = vec![landmarks[path[0]]];
        let back = is_loop.then_some(path[0]);
        for landmark in path.iter().skip(1).copied().chain(back) {
            let from = vertices[vertices.len() - 1];
            let way = surface.way(from, landmarks[landmark], &taken);
            ensure!(way.len() > 1, "no way to landmark {landmark}");
            taken.extend(&way);
            vertices.extend(way.into_iter().skip(1));
        }
        if is_loop {
            vertices.pop();
        }
        drawn.push((line, vertices));
    }
    Ok(drawn)
}

/// The edges of a line.
pub fn edges(line: MeshLine, vertices: &[u32]) -> Vec<(u32, u32)> {
    let is_loop = path(line).is_none_or(|(_, is_loop)| is_loop);
    let next = vertices.iter().skip(1).chain(vertices.first());
    let count = vertices.len() - usize::from(!is_loop);
    let pairs = vertices.iter().zip(next).take(count);
    pairs.map(|(a, b)| (*a, *b)).collect()
}
