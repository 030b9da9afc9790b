//! The surface of a mesh: places and normals of its vertices.

use glam::Vec3;
use posewise::mesh::MeshVertex;

use super::axes;

/// Vertices in the frame of 3D programs.
pub struct Surface {
    /// \[m\]
    pub places: Vec<Vec3>,
    /// Of length 1.
    pub normals: Vec<Vec3>,
}

impl Surface {
    /// That of these vertices, head frame \[mm\]. Normals are means of the triangles', by area.
    pub fn new(vertices: &[MeshVertex], triangles: &[[u16; 3]]) -> Self {
        let places: Vec<Vec3> = vertices.iter().map(axes::place).collect();
        let mut normals = vec![Vec3::ZERO; places.len()];
        for corners in triangles {
            let corners = corners.map(usize::from);
            let [a, b, c] = corners.map(|corner| places[corner]);
            let normal = (b - a).cross(c - a);
            for corner in corners {
                normals[corner] += normal;
            }
        }
        for normal in &mut normals {
            // A vertex of no triangle is not seen.
            *normal = normal.try_normalize().unwrap_or(Vec3::Z);
        }
        Surface { places, normals }
    }
}
