//! Where the vertices of the mesh lie on heads of another family.

use super::{Thinned, pulls::pulls};
use anyhow::Result;
use glam::Vec3;
use posewise::shape::{LANDMARKS, WHOLE_PULL};

/// A point of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    corners: [u32; 3],
    weights: Vec3,
}

impl Place {
    /// A vertex of the head itself.
    pub fn at(vertex: u32) -> Place {
        Place {
            corners: [vertex; 3],
            weights: Vec3::X,
        }
    }

    /// The value there, of values of the vertices.
    pub fn of(&self, values: &[Vec3]) -> Vec3 {
        let [a, b, c] = self.corners.map(|v| values[v as usize]);
        a * self.weights.x + b * self.weights.y + c * self.weights.z
    }
}

/// For each vertex the point of another head that is nearest to it, when the mean mesh is drawn to
/// that head's landmarks.
pub fn places_on(
    thinned: &Thinned,
    landmarks: &[Vec3; LANDMARKS],
    points: &[Vec3],
    triangles: &[[u32; 3]],
) -> Result<Vec<Place>> {
    let own: Vec<Vec3> = thinned
        .vertices
        .iter()
        .map(|v| thinned.surface.point(*v))
        .collect();
    let pulls = pulls(&thinned.surface, &thinned.vertices)?;
    let drawn = own.iter().zip(&pulls).map(|(point, (by, shares))| {
        let moves = by.iter().zip(shares).map(|(landmark, share)| {
            let landmark = usize::from(*landmark);
            let share = f32::from(*share) / f32::from(WHOLE_PULL);
            (landmarks[landmark] - own[landmark]) * share
        });
        *point + moves.sum::<Vec3>()
    });
    Ok(drawn
        .map(|point| nearest(point, points, triangles))
        .collect())
}

/// The point of a surface that is nearest to one.
pub fn nearest(point: Vec3, points: &[Vec3], triangles: &[[u32; 3]]) -> Place {
    let mut best = (f32::INFINITY, Place::at(0));
    for corners in triangles {
        let [a, b, c] = corners.map(|v| points[v as usize]);
        let weights = weights(point, [a, b, c]);
        let at = a * weights.x + b * weights.y + c * weights.z;
        let far = at.distance_squared(point);
        if far < best.0 {
            let corners = *corners;
            best = (far, Place { corners, weights });
        }
    }
    best.1
}

/// Weights of the corners at the point of a triangle that is nearest to one.
fn weights(point: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let (u, v, w) = (b - a, c - a, point - a);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (wu, wv) = (w.dot(u), w.dot(v));
    let area = (uu * vv - uv * uv).max(1e-12);
    let (s, t) = ((wu * vv - wv * uv) / area, (wv * uu - wu * uv) / area);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        return Vec3::new(1.0 - s - t, s, t);
    }
    let along = |from: Vec3, to: Vec3| {
        let way = to - from;
        ((point - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0)
    };
    let (k, l, m) = (along(a, b), along(b, c), along(c, a));
    let edges = [
        Vec3::new(1.0 - k, k, 0.0),
        Vec3::new(0.0, 1.0 - l, l),
        Vec3::new(m, 0.0, 1.0 - m),
    ];
    let far = |w: &Vec3| (a * w.x + b * w.y + c * w.z).distance_squared(point);
    let [mut nearest, others @ ..] = edges;
    for other in others {
        if far(&other) < far(&nearest) {
            nearest = other;
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_of_a_triangle() {
        let points = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0];
        let place = |point| nearest(point, &points, &[[0, 1, 2]]).of(&points);
        let inside = Vec3::new(0.5, 0.5, 3.0);
        assert!(place(inside).distance(Vec3::new(0.5, 0.5, 0.0)) < 1e-6);
        assert!(place(Vec3::new(3.0, 3.0, 0.0)).distance(Vec3::new(1.0, 1.0, 0.0)) < 1e-6);
        assert!(place(Vec3::new(-1.0, 1.0, 1.0)).distance(Vec3::Y) < 1e-6);
    }
}
