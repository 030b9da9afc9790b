//! The 68 points of a posed head: projections of the fixed vertices, whether each is seen, and
//! the 2D points in the photographs' convention, where the jaw follows the visible outline.
//!
//! As in landmark marching (Zhu et al., CVPR 2015) each jaw point has a path over the cheek; of the
//! path's points the one that lies outermost in the image is on the outline. The paths begin on the
//! lower jaw's edge, where the outline runs on the side that turns towards the camera, and reach
//! below the chin's vertices, which lie on its front. Along the outline the points are at even
//! distances, on each side of the chin.

use super::draw::{Drawn, Posed, SUPER, View};
use super::mesh::{Material, Mesh};
use super::raster::Target;
use crate::head::{BELOW_MM, at_place, even_places};
use glam::{Mat3, Vec2, Vec3};
use posewise::shape::{JAW, LANDMARKS};

/// Half the width of the chin \[mm\].
const CHIN_MM: f32 = 36.0;

/// Points beside each cheek, from the uppermost on.
const CHEEK: usize = 6;

/// Distance of the frontal camera in whose picture the jaw's points have even distances \[mm\].
const FAR_MM: f32 = 1000.0;

/// A point on an edge of the mesh.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    ends: [u32; 2],
    share: f32,
}

/// A path from a jaw landmark inwards, and the outward direction in the frontal view.
struct Path {
    points: Vec<Crossing>,
    outward: Vec2,
}

/// Finds the 68 points.
pub struct Landmarker {
    vertices: [u32; LANDMARKS],
    /// Offsets from the vertices to the labels of photographs \[mm, head axes\].
    offsets: [Vec3; LANDMARKS],
    paths: Vec<Path>,
    /// Positions of the jaw's points along the line through the paths' outermost points.
    places: [f32; JAW],
}

/// The 68 points of a picture.
#[derive(Clone, Debug)]
pub struct Points {
    /// Photographs' convention \[px\].
    pub contour: [Vec2; LANDMARKS],
    /// Projections of the fixed vertices \[px\].
    pub fixed: [Vec2; LANDMARKS],
    /// Whether the `contour` points are seen.
    pub contour_seen: [bool; LANDMARKS],
    /// Whether the `fixed` points are seen.
    pub fixed_seen: [bool; LANDMARKS],
    /// Fixed vertices \[mm, camera axes\].
    pub solid: [Vec3; LANDMARKS],
}

/// The fewest of the 51 inner landmarks that show a face.
const LEAST_SEEN: usize = 6;

impl Points {
    /// Whether enough is seen to tell that there is a face.
    pub fn show_a_face(&self) -> bool {
        let seen = self.contour_seen[JAW..].iter().filter(|seen| **seen);
        seen.count() >= LEAST_SEEN
    }
}

/// How far behind the drawn surface a landmark may lie and still count as seen \[mm\].
const SEEN_SLACK_MM: f32 = 5.0;

impl Landmarker {
    /// Cuts the mean head along the paths. `offsets_mm` (head axes) move the `contour` points of
    /// the inner landmarks to where photographs' labels sit; those missing are 0.
    pub fn new(mesh: &Mesh, offsets_mm: &[[f32; 3]]) -> Landmarker {
        let at = |i: usize| mesh.mean[mesh.landmarks[i] as usize];
        let paths = (0..JAW)
            .map(|i| {
                let (start, below_mm) = match mesh.jaw_edge[i] {
                    Some(edge) => (mesh.mean[edge as usize], 0.0),
                    None => (at(i), BELOW_MM),
                };
                let end = path_end(i, &at);
                let outward = (at(i) - end).truncate().normalize_or_zero();
                // The uppermost points move only sideways, the chin only up and down.
                let outward = match i {
                    0..=3 | 13..=16 => Vec2::new(outward.x.signum(), 0.0),
                    8 => Vec2::Y,
                    _ => outward,
                };
                let vertex = Crossing {
                    ends: [mesh.landmarks[i]; 2],
                    share: 0.0,
                };
                Path {
                    points: [vec![vertex], cut(mesh, start, end, below_mm)].concat(),
                    outward,
                }
            })
            .collect();
        let mut landmarker = Landmarker {
            vertices: mesh.landmarks,
            offsets: std::array::from_fn(|i| {
                offsets_mm
                    .get(i)
                    .map(|o| Vec3::from(*o))
                    .unwrap_or_default()
            }),
            paths,
            places: std::array::from_fn(|i| i as f32),
        };
        // Even distances hold in the frontal view; turned heads keep the same points.
        landmarker.places = places_by_side(&landmarker.frontal_outline(mesh));
        landmarker
    }

    /// Lets the points beside the cheeks slide level: what annotators put beside an eye, a nose or
    /// a mouth stays beside it however the head turns. Their heights are those of even distances in
    /// the frontal view.
    pub fn levelled(mut self, mesh: &Mesh) -> Landmarker {
        let outline = self.frontal_outline(mesh).map(|p| p.extend(0.0));
        let edge = |i: usize| mesh.jaw_edge[i].map(|v| mesh.mean[v as usize]);
        let vertex = |i: usize| mesh.mean[mesh.landmarks[i] as usize];
        for i in (0..JAW).filter(|i| *i < CHEEK || *i >= JAW - CHEEK) {
            // Seen from so far away heights hardly depend on how far a point is.
            let height = at_place(&outline, self.places[i]).y * FAR_MM;
            let side = |k: usize| if i < JAW / 2 { k } else { JAW - 1 - k };
            let mut line: Vec<Vec3> = (0..JAW / 2).map_while(|k| edge(side(k))).collect();
            if line.len() < 2 {
                line = (0..JAW / 2).map(|k| vertex(side(k))).collect();
            }
            let below = line
                .partition_point(|p| p.y < height)
                .clamp(1, line.len() - 1);
            let (a, b) = (line[below - 1], line[below]);
            let start = a.lerp(b, ((height - a.y) / (b.y - a.y)).clamp(0.0, 1.0));
            let end = path_end(i, &vertex);
            self.paths[i] = Path {
                points: cut(mesh, start, Vec3::new(end.x, start.y, end.z), 0.0),
                outward: Vec2::new(start.x.signum(), 0.0),
            };
        }
        self.places = places_by_side(&self.frontal_outline(mesh));
        self
    }

    /// The mean head's outline as a camera far ahead sees it, at unit focal length.
    fn frontal_outline(&self, mesh: &Mesh) -> [Vec2; JAW] {
        let ahead = Posed::new(mesh, &mesh.mean, &[], Mat3::IDENTITY, FAR_MM * Vec3::Z);
        self.outline(&ahead, &View::unit(), 0.0)
    }

    /// The outline where each path meets it \[px\].
    fn outline(&self, head: &Posed, view: &View, roll_deg: f32) -> [Vec2; JAW] {
        std::array::from_fn(|i| view.project(self.outermost(i, head, view, roll_deg).0))
    }

    /// The outline point (camera axes) of jaw landmark `i` in a picture whose face is rolled.
    fn outermost(&self, i: usize, head: &Posed, view: &View, roll_deg: f32) -> (Vec3, Vec3) {
        let vertex = self.vertices[i] as usize;
        let mut best = (head.vertices[vertex], head.normals[vertex]);
        let path = &self.paths[i];
        let d = Vec2::from_angle(roll_deg.to_radians()).rotate(path.outward);
        let mut reach = f32::NEG_INFINITY;
        for c in &path.points {
            let [a, b] = c.ends.map(|v| v as usize);
            let p = head.vertices[a].lerp(head.vertices[b], c.share);
            let r = view.project(p).dot(d);
            if r > reach {
                reach = r;
                best = (p, head.normals[a].lerp(head.normals[b], c.share));
            }
        }
        best
    }

    /// All points of a drawn head.
    pub fn points(&self, head: &Posed, view: &View, drawn: &Drawn, roll_deg: f32) -> Points {
        let fixed = self.vertices.map(|v| {
            let v = v as usize;
            (head.vertices[v], head.normals[v])
        });
        let contour: [(Vec3, Vec3); LANDMARKS] = std::array::from_fn(|i| match i {
            0..JAW => self.outermost(i, head, view, roll_deg),
            _ => (fixed[i].0 + head.rotation * self.offsets[i], fixed[i].1),
        });
        let seen = |i: usize, (p, n): (Vec3, Vec3)| {
            // The outline's own normal is square to the view; lids and lips fold where they close.
            let facing = match i {
                0..JAW => true,
                36..48 | 60..LANDMARKS => n.dot(p.normalize()) < 0.6,
                _ => n.dot(p.normalize()) < 0.1,
            };
            facing && is_drawn(p, view, &drawn.target)
        };
        let mut projected = contour.map(|(p, _)| view.project(p));
        let outline: [Vec3; JAW] = std::array::from_fn(|i| projected[i].extend(0.0));
        for (point, place) in projected.iter_mut().zip(self.places) {
            *point = at_place(&outline, place).truncate();
        }
        Points {
            contour: projected,
            fixed: fixed.map(|(p, _)| view.project(p)),
            contour_seen: std::array::from_fn(|i| match i {
                0..JAW => seen(i, contour[i]),
                _ => seen(i, fixed[i]),
            }),
            fixed_seen: std::array::from_fn(|i| {
                let square = fixed[i].1.dot(fixed[i].0.normalize()) < 0.25;
                seen(i, fixed[i]) && (i >= JAW || square)
            }),
            solid: fixed.map(|(p, _)| p),
        }
    }
}

/// Places along the jaw's line, in numbers of its points, that lie at even distances on each side
/// of the chin.
fn places_by_side(line: &[Vec2; JAW]) -> [f32; JAW] {
    const CHIN: usize = JAW / 2;
    let line = line.map(|p| p.extend(0.0));
    let [right, left] = [&line[..=CHIN], &line[CHIN..]].map(even_places::<{ CHIN + 1 }>);
    std::array::from_fn(|i| match i < CHIN {
        true => right[i],
        false => CHIN as f32 + left[i - CHIN],
    })
}

/// Whether nothing nearer was drawn over a point.
pub fn is_drawn(p: Vec3, view: &View, target: &Target) -> bool {
    let q = view.to_samples(p);
    // Outside the picture nothing hides it.
    let Some(inv_z) = target.nearest_around(q.x, q.y) else {
        return true;
    };
    // A pixel further in, the surface may have come nearer.
    let slope_mm = 1.5 * p.z / (view.camera.fx * SUPER as f32);
    inv_z == 0.0 || 1.0 / inv_z > p.z - SEEN_SLACK_MM - slope_mm
}

/// Where the outline of jaw landmark `i` can slide to at most.
fn path_end(i: usize, at: &impl Fn(usize) -> Vec3) -> Vec3 {
    let height = at(i).y;
    let right = i < 8;
    let pick = |r: usize, l: usize| at(if right { r } else { l });
    // Sideways at the landmark's own height, so far in as the given feature.
    let level = |inner: Vec3| Vec3::new(inner.x, height, inner.z + 12.0);
    match if i > 8 { 16 - i } else { i } {
        0 => level(pick(36, 45)),
        1 => level(pick(41, 46)),
        2 => level(pick(31, 35) * Vec3::new(1.8, 1.0, 1.0)),
        3 => level(pick(48, 54)),
        4 => pick(48, 54) + Vec3::new(0.0, 6.0, 4.0),
        5 => pick(59, 55) + Vec3::new(0.0, 6.0, 2.0),
        6 => pick(58, 56) + Vec3::new(0.0, 6.0, 2.0),
        7 => pick(58, 56) + Vec3::new(0.0, 6.0, 2.0),
        _ => at(57) + Vec3::new(0.0, 6.0, 2.0),
    }
}

/// Where the mesh's edges cross the plane through a path's ends and the skin's normal, from
/// `below_mm` beyond the start on.
fn cut(mesh: &Mesh, start: Vec3, end: Vec3, below_mm: f32) -> Vec<Crossing> {
    let along = end - start;
    // The cheek faces half sideways, half forwards; the chin only forwards.
    let sideways = f32::from(start.x.abs() > CHIN_MM);
    let out = Vec3::new(start.x.signum() * sideways, 0.0, -1.0);
    let normal = along.cross(out).normalize_or_zero();
    let run = mesh.run(Material::Skin);
    let mut points: Vec<(f32, Crossing)> = Vec::new();
    for n in run {
        if mesh.corner_uv[n][0].x > 1.0 || mesh.ear[n][0] {
            continue;
        }
        let t = &mesh.triangles[n];
        for k in 0..3 {
            let (va, vb) = (t[k], t[(k + 1) % 3]);
            let (a, b) = (
                mesh.mean[va as usize] - start,
                mesh.mean[vb as usize] - start,
            );
            let (da, db) = (a.dot(normal), b.dot(normal));
            // Each edge belongs to two triangles; take it once.
            if va > vb || (da > 0.0) == (db > 0.0) {
                continue;
            }
            let share = da / (da - db);
            let p = a.lerp(b, share);
            let way = p.dot(along) / along.length_squared();
            let inside = (0.0..=1.0).contains(&way) && p.z < 2.0;
            if inside || way < 0.0 && p.y > 0.0 && p.length() < below_mm {
                points.push((
                    way,
                    Crossing {
                        ends: [va, vb],
                        share,
                    },
                ));
            }
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.into_iter().map(|(_, c)| c).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_even_on_each_side_of_the_chin() {
        // Steps of 1 on one side; of 1, 3, 1, 3 … on the other.
        let mut at = 0.0;
        let line: [Vec2; JAW] = std::array::from_fn(|i| {
            at += if i > 8 && i % 2 == 0 { 3.0 } else { 1.0 };
            Vec2::new(at, 0.0)
        });
        let outline = line.map(|p| p.extend(0.0));
        let points = places_by_side(&line).map(|place| at_place(&outline, place));
        for (side, step) in [(0..8, 1.0), (8..16, 2.0)] {
            for i in side {
                assert!((points[i + 1].x - points[i].x - step).abs() < 1e-4, "{i}");
            }
        }
    }
}
