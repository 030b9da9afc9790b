//! A triangle mesh from which vertices are taken one by one.

use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Numbers of two vertices, the smaller first.
pub type Edge = (u32, u32);

/// A way that is this far from the straight line counts twice \[mm\].
const ASIDE_MM: f32 = 1.5;

/// The edge between two vertices.
pub fn edge(a: u32, b: u32) -> Edge {
    (a.min(b), a.max(b))
}

/// Triangles over the vertices of a head; vertices without a triangle are not part of it.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Places of all vertices of the head \[mm\].
    pub points: Vec<Vec3>,
    triangles: BTreeMap<u32, [u32; 3]>,
    /// Numbers of the triangles at each vertex.
    at: Vec<BTreeSet<u32>>,
}

impl Surface {
    pub fn new(points: Vec<Vec3>, triangles: &[[u32; 3]]) -> Surface {
        let mut at = vec![BTreeSet::new(); points.len()];
        let triangles: BTreeMap<u32, [u32; 3]> = (0..).zip(triangles.iter().copied()).collect();
        for (number, corners) in &triangles {
            for corner in corners {
                at[*corner as usize].insert(*number);
            }
        }
        Surface {
            points,
            triangles,
            at,
        }
    }

    pub fn point(&self, vertex: u32) -> Vec3 {
        self.points[vertex as usize]
    }

    /// The corners of every triangle, in the order of their numbers.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.triangles.values().copied()
    }

    /// Vertices that have triangles, in their order.
    pub fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        (0..)
            .zip(&self.at)
            .filter(|(_, at)| !at.is_empty())
            .map(|(vertex, _)| vertex)
    }

    /// The triangles at a vertex.
    pub fn around(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.at[vertex as usize].iter().map(|t| self.triangles[t])
    }

    /// The vertices that an edge joins with one.
    pub fn neighbours(&self, vertex: u32) -> BTreeSet<u32> {
        let corners = self.around(vertex).flatten();
        corners.filter(|corner| *corner != vertex).collect()
    }

    /// How many triangles each edge has.
    fn edges(&self) -> BTreeMap<Edge, u32> {
        let mut edges = BTreeMap::new();
        for [a, b, c] in self.triangles() {
            for edge in [edge(a, b), edge(b, c), edge(c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        edges
    }

    /// The edges with one triangle.
    pub fn boundary(&self) -> BTreeSet<Edge> {
        let edges = self.edges().into_iter();
        edges
            .filter(|(_, n)| *n == 1)
            .map(|(edge, _)| edge)
            .collect()
    }

    /// Twice the area of a triangle, along its normal.
    pub fn normal(&self, [a, b, c]: [u32; 3]) -> Vec3 {
        let [a, b, c] = [a, b, c].map(|v| self.point(v));
        (b - a).cross(c - a)
    }

    /// Keeps the triangles that can be reached from a vertex without crossing these edges.
    pub fn keep_reached(self, from: u32, walls: &BTreeSet<Edge>) -> Surface {
        let mut by_edge: BTreeMap<Edge, Vec<u32>> = BTreeMap::new();
        for (number, [a, b, c]) in &self.triangles {
            for edge in [edge(*a, *b), edge(*b, *c), edge(*c, *a)] {
                by_edge.entry(edge).or_default().push(*number);
            }
        }
        let mut reached = BTreeSet::new();
        let mut next: Vec<u32> = self.at[from as usize].iter().copied().collect();
        while let Some(number) = next.pop() {
            if !reached.insert(number) {
                continue;
            }
            let [a, b, c] = self.triangles[&number];
            let open = [edge(a, b), edge(b, c), edge(c, a)];
            for edge in open.iter().filter(|edge| !walls.contains(edge)) {
                next.extend(&by_edge[edge]);
            }
        }
        let kept: Vec<[u32; 3]> = reached.iter().map(|t| self.triangles[t]).collect();
        Surface::new(self.points, &kept)
    }

    /// The shortest way along edges from one vertex to another, both included, that stays near the
    /// straight line and passes none of these; empty where there is none.
    pub fn way(&self, from: u32, to: u32, taken: &BTreeSet<u32>) -> Vec<u32> {
        // Dijkstra. Lengths in nanometres, so that they are ordered.
        let (start, end) = (self.point(from), self.point(to));
        let along = (end - start).normalize_or_zero();
        let length = |a: u32, b: u32| {
            let (a, b) = (self.point(a), self.point(b));
            let aside = along.cross((a + b) / 2.0 - start).length() / ASIDE_MM;
            (a.distance(b) * (1.0 + aside * aside) * 1e6) as u64
        };
        let mut before: BTreeMap<u32, (u64, u32)> = BTreeMap::from([(from, (0, from))]);
        let mut open = BTreeSet::from([(0, from)]);
        while let Some((far, vertex)) = open.pop_first() {
            if vertex == to {
                break;
            }
            for next in self.neighbours(vertex) {
                if next != to && taken.contains(&next) {
                    continue;
                }
                let far = far + length(vertex, next);
                if before.get(&next).is_none_or(|(known, _)| far < *known) {
                    if let Some((known, _)) = before.insert(next, (far, vertex)) {
                        open.remove(&(known, next));
                    }
                    open.insert((far, next));
                }
            }
        }
        let mut way = vec![to];
        while let Some((_, earlier)) = way.last().and_then(|last| before.get(last)) {
            if *earlier == way[way.len() - 1] {
                way.reverse();
                return way;
            }
            way.push(*earlier);
        }
        Vec::new()
    }

    /// Whether a vertex can be moved onto a neighbour without folding the surface together.
    pub fn may_collapse(&self, vertex: u32, onto: u32) -> bool {
        let shared = self
            .neighbours(vertex)
            .intersection(&self.neighbours(onto))
            .count();
        let between = self.around(vertex).filter(|t| t.contains(&onto)).count();
        shared == between && self.around(onto).count() > between
    }

    /// Moves a vertex onto a neighbour; the triangles between them vanish.
    pub fn collapse(&mut self, vertex: u32, onto: u32) {
        for number in std::mem::take(&mut self.at[vertex as usize]) {
            let corners = self.triangles[&number];
            if corners.contains(&onto) {
                self.triangles.remove(&number);
                for corner in corners {
                    self.at[corner as usize].remove(&number);
                }
            } else {
                let moved = corners.map(|c| if c == vertex { onto } else { c });
                self.triangles.insert(number, moved);
                self.at[onto as usize].insert(number);
            }
        }
    }

    /// The vertices around one in the order of its triangles; at an edge of the surface the vertex
    /// itself closes the ring.
    pub fn ring(&self, vertex: u32) -> Vec<u32> {
        let next: BTreeMap<u32, u32> = self
            .around(vertex)
            .map(|t| {
                let at = t.iter().position(|c| *c == vertex).unwrap_or_default();
                (t[(at + 1) % 3], t[(at + 2) % 3])
            })
            .collect();
        let ends: BTreeSet<u32> = next.values().copied().collect();
        let start = next.keys().find(|v| !ends.contains(v));
        let is_open = start.is_some();
        let Some(start) = start.or(next.keys().next()) else {
            return Vec::new();
        };
        let mut ring = vec![*start];
        while let Some(following) = next.get(&ring[ring.len() - 1]) {
            if following == start {
                break;
            }
            ring.push(*following);
        }
        if is_open {
            ring.push(vertex);
        }
        ring
    }
}
