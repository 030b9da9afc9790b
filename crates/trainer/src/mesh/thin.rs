//! Takes vertices from a surface until as many are left as are wanted, where it needs them least.

use super::surface::{Edge, Surface};
use anyhow::{Result, ensure};
use glam::Vec3;
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// What must stay, and how dense the surface is to be.
pub struct Wanted<'a> {
    /// Vertices that stay.
    pub fixed: &'a BTreeSet<u32>,
    /// Edges along which lines run, from either end: a vertex on them moves along them only.
    pub lines: BTreeSet<Edge>,
    /// By vertex of the head: how long an edge may be there \[mm\].
    pub length_mm: &'a [f32],
    /// Vertices in the end.
    pub count: usize,
}

/// Least cosine of the angle by which a triangle turns.
const LEAST_TURN: f32 = 0.3;
/// Least height of a triangle over its longest side.
const LEAST_HEIGHT: f32 = 0.12;
/// A surface that moves by this counts as much as an edge of the wanted length \[mm\].
const MOVED_MM: f32 = 2.5;
/// Vertices with more neighbours than this are not wanted, each adds so much.
const NEIGHBOURS: usize = 7;
const CROWDED: f32 = 0.15;

/// A vertex that may go: how bad that is, in millionths, the vertex, and when that was found.
type Candidate = Reverse<(u64, u32, u32)>;

/// Thins the surface; gives the lines, along which vertices are gone too.
pub fn thin(surface: &mut Surface, mut wanted: Wanted<'_>) -> Result<BTreeSet<Edge>> {
    let mut left = surface.vertices().count();
    let mut found = vec![0u32; surface.points.len()];
    let mut heap: BinaryHeap<Candidate> = BinaryHeap::new();
    let all: Vec<u32> = surface.vertices().collect();
    for vertex in all {
        heap.extend(candidate(surface, &wanted, vertex, 0));
    }
    while left > wanted.count {
        let next = heap.pop();
        ensure!(next.is_some(), "{left} vertices cannot go");
        let Some(Reverse((_, vertex, when))) = next else {
            continue;
        };
        if when != found[vertex as usize] {
            continue;
        }
        let Some((_, onto)) = best(surface, &wanted, vertex) else {
            continue;
        };
        let ends = wanted.ends(vertex);
        if let [a, b] = ends[..] {
            for end in [a, b] {
                wanted.lines.remove(&(vertex, end));
                wanted.lines.remove(&(end, vertex));
            }
            let other = if a == onto { b } else { a };
            wanted.lines.extend([(onto, other), (other, onto)]);
        }
        let mut touched = surface.neighbours(vertex);
        surface.collapse(vertex, onto);
        left -= 1;
        touched.extend(surface.neighbours(onto));
        for vertex in touched {
            found[vertex as usize] += 1;
            heap.extend(candidate(surface, &wanted, vertex, found[vertex as usize]));
        }
    }
    Ok(wanted.lines)
}

impl Wanted<'_> {
    /// The vertices to which lines run from one.
    fn ends(&self, vertex: u32) -> Vec<u32> {
        let all = self.lines.range((vertex, 0)..=(vertex, u32::MAX));
        all.map(|(_, end)| *end).collect()
    }
}

fn candidate(surface: &Surface, wanted: &Wanted<'_>, vertex: u32, when: u32) -> Option<Candidate> {
    let (cost, _) = best(surface, wanted, vertex)?;
    Some(Reverse(((cost * 1e6) as u64, vertex, when)))
}

/// Where a vertex goes at the least cost.
fn best(surface: &Surface, wanted: &Wanted<'_>, vertex: u32) -> Option<(f32, u32)> {
    if wanted.fixed.contains(&vertex) {
        return None;
    }
    let ends = wanted.ends(vertex);
    let places: Vec<u32> = match ends.len() {
        0 => surface.neighbours(vertex).into_iter().collect(),
        2 => ends,
        _ => return None,
    };
    let costs = places.into_iter().filter_map(|onto| {
        let cost = cost(surface, wanted, vertex, onto)?;
        Some((cost, onto))
    });
    costs.min_by(|(a, v), (b, w)| a.total_cmp(b).then(v.cmp(w)))
}

/// How bad it is to move a vertex onto a neighbour; `None` where it must not.
fn cost(surface: &Surface, wanted: &Wanted<'_>, vertex: u32, onto: u32) -> Option<f32> {
    if !surface.may_collapse(vertex, onto) {
        return None;
    }
    let (from, to) = (surface.point(vertex), surface.point(onto));
    let (mut longest, mut moved) = (0.0f32, 0.0f32);
    for corners in surface.around(vertex) {
        let before = surface.normal(corners).normalize_or_zero();
        moved = moved.max(before.dot(to - from).abs());
        if corners.contains(&onto) {
            continue;
        }
        let corners = corners.map(|c| if c == vertex { onto } else { c });
        let area = surface.normal(corners);
        let side = sides(surface, corners).into_iter().fold(0.0, f32::max);
        let is_flat = area.length() < LEAST_HEIGHT * side * side;
        if is_flat || area.normalize_or_zero().dot(before) < LEAST_TURN {
            return None;
        }
        for corner in corners.iter().filter(|c| **c != onto) {
            let wanted = wanted.length_mm[*corner as usize].min(wanted.length_mm[onto as usize]);
            longest = longest.max(surface.point(*corner).distance(to) / wanted);
        }
    }
    let apart = from.distance(to) / wanted.length_mm[vertex as usize];
    let joined = surface
        .neighbours(vertex)
        .union(&surface.neighbours(onto))
        .count()
        - 2;
    let crowd = CROWDED * joined.saturating_sub(NEIGHBOURS) as f32;
    Some(longest.max(apart) + moved / MOVED_MM + crowd)
}

fn sides(surface: &Surface, [a, b, c]: [u32; 3]) -> [f32; 3] {
    let [a, b, c]: [Vec3; 3] = [a, b, c].map(|v| surface.point(v));
    [a.distance(b), b.distance(c), c.distance(a)]
}
