//! Where the visible face contour can run: paths over the cheek from each jaw landmark.
//!
//! Photographs label the jaw on the visible outline, which slides over the cheek as the head turns.
//! As in landmark marching (Zhu et al., CVPR 2015), each jaw landmark gets a path of vertices that
//! lead from it inwards; whichever of them is outermost in the image lies on the outline.

use glam::{Vec2, Vec3};
use posewise::shape::LANDMARKS;

/// Jaw landmarks of iBUG 68 (0–16).
pub const JAW: usize = 17;

/// Vertices of one path, the landmark included.
const PATH: usize = 8;

/// Half the width of the strip of skin that a path may wander in \[mm\].
const STRIP_MM: f32 = 6.0;

/// Share of the way from a jaw landmark to the face's middle line (or, for the chin, to the
/// mouth) that a path covers: the outline never gets further in before the nose hides it.
const REACH: f32 = 0.6;

/// Unit outward normals of vertices, area-weighted over their triangles.
pub fn normals(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| Vec3::from(vertices[v as usize]));
        let area = (b - a).cross(c - a);
        t.iter().for_each(|v| sums[*v as usize] += area);
    }
    sums.iter().map(|n| n.normalize_or_zero().into()).collect()
}

/// Outward directions of the jaw landmarks in the frontal view (x, y): normals of the jaw line.
pub fn outward(points: &[[f32; 3]; LANDMARKS]) -> [[f32; 2]; JAW] {
    std::array::from_fn(|i| {
        let (a, b) = (points[i.saturating_sub(1)], points[(i + 1).min(JAW - 1)]);
        // The jaw line runs from the image left over the chin to the right.
        Vec2::new(a[1] - b[1], b[0] - a[0])
            .normalize_or_zero()
            .into()
    })
}

/// Paths of up to [`PATH`] vertices for the 17 jaw landmarks; only vertices with `skin` are used.
pub fn contour_paths(
    mean: &[[f32; 3]],
    triangles: &[[u32; 3]],
    landmarks: &[u32; LANDMARKS],
    skin: impl Fn(usize) -> bool,
) -> [Vec<u32>; JAW] {
    let normals = normals(mean, triangles);
    let points = landmarks.map(|v| mean[v as usize]);
    let directions = outward(&points);
    let mouth = Vec3::from(points[57]);
    std::array::from_fn(|i| {
        let out = Vec3::new(directions[i][0], directions[i][1], 0.0);
        let side = Vec3::new(-out.y, out.x, 0.0);
        let start = Vec3::from(points[i]);
        let reach = REACH * out.dot(start - mouth * Vec3::new(0.0, 1.0, 0.0)).max(20.0);
        // The skin in a strip that runs inwards and forwards, by its way from the landmark.
        let strip: Vec<(f32, f32, u32)> = (0..mean.len())
            .filter(|v| skin(*v))
            .filter_map(|v| {
                let way = Vec3::from(mean[v]) - start;
                let (inward, forward) = (-way.dot(out), -way.z);
                let facing = Vec3::from(normals[v]).dot(out - 0.5 * Vec3::Z);
                let inside = inward > -2.0 && inward < reach && forward > -3.0 && facing > 0.0;
                let off = way.dot(side).abs();
                (inside && off < STRIP_MM).then_some((inward + forward, off, v as u32))
            })
            .collect();
        let end = strip.iter().fold(0.0f32, |m, s| m.max(s.0));
        let mut path = vec![landmarks[i]];
        for k in 1..PATH {
            let want = end * k as f32 / (PATH - 1) as f32;
            let cost = |s: &(f32, f32, u32)| (s.0 - want).abs() + 0.5 * s.1;
            let best = strip.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
            path.extend(best.map(|b| b.2).filter(|v| !path.contains(v)));
        }
        path
    })
}
