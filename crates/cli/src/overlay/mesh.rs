//! Triangles between the 68 landmarks, for drawing.

use delaunator::{Point, triangulate};
use glam::{Quat, Vec3};
use posewise::TrackResult;

/// Corners of each triangle, all turned the same way when seen from in front of the face.
pub type Triangles = Vec<[usize; 3]>;

/// Triangulates the 3D landmarks as seen from straight in front of the head (Delaunay).
pub fn triangulate_face(result: &TrackResult) -> Triangles {
    let back = Quat::from_array(result.rotation).inverse();
    let origin = Vec3::from(result.translation_mm);
    let front: Vec<Point> = result
        .points_mm
        .iter()
        .map(|p| back * (Vec3::from(*p) - origin))
        .map(|p| Point {
            x: f64::from(p.x),
            y: f64::from(p.y),
        })
        .collect();
    if front.iter().any(|p| !(p.x.is_finite() && p.y.is_finite())) {
        return Triangles::new();
    }
    let found = triangulate(&front);
    found
        .triangles
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]])
        .filter(|t| !is_sliver(&front, t))
        .map(|t| {
            let area = twice_area(t.map(|i| [front[i].x as f32, front[i].y as f32]));
            if area < 0.0 { [t[0], t[2], t[1]] } else { t }
        })
        .collect()
}

/// Twice the signed area, > 0 when the corners go clockwise on screen.
pub fn twice_area([a, b, c]: [[f32; 2]; 3]) -> f32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The hull's long thin triangles along the jaw and over the brows say nothing.
fn is_sliver(points: &[Point], triangle: &[usize; 3]) -> bool {
    let p = triangle.map(|i| [points[i].x as f32, points[i].y as f32]);
    let side = |a: usize, b: usize| (p[a][0] - p[b][0]).hypot(p[a][1] - p[b][1]);
    let longest = side(0, 1).max(side(1, 2)).max(side(2, 0));
    twice_area(p).abs() < 0.12 * longest * longest && triangle.iter().all(|i| *i < 27)
}
