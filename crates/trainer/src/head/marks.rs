//! How far people mark landmarks from where a network that saw no such marks puts them in
//! photographs.
//!
//! Where a landmark of the training labels is, the convention of renders says
//! ([`Head::conventional_offsets_mm`](super::Head)), or the map of MediaPipe's face mesh. People
//! put some of them elsewhere. `posewise-train marks` measures what is left over on photographs
//! with manual landmarks. The last step of a free model's cascade takes it off.

use glam::{Mat3, Vec2, Vec3};
use posewise::shape::{LANDMARKS, MIRROR};

/// Changes with the tables.
pub const MARKS_VERSION: u32 = 1;
pub const MESH_MARKS_VERSION: u32 = 2;

/// Whose landmarks people mark elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Labels {
    /// Renders by the convention, and nothing else.
    Convention,
    /// Photographs by the map of the face mesh, and renders by fits to those.
    FaceMesh,
}

/// Of [`Labels::Convention`]: offsets \[mm, head frame\] of the landmarks of the image's left half
/// and of the middle, in order of their indices. Those of the right half are mirrored. The lids of
/// a pair move alike, so that eyes stay as open as they are.
const MARKS_MM: [[f32; 3]; 39] = [
    [-1.5, -1.9, 2.0],
    [-0.7, 0.8, 2.2],
    [-0.4, 2.4, 0.9],
    [0.2, 3.1, -0.5],
    [1.0, 3.2, -2.3],
    [1.5, 3.0, -2.3],
    [2.7, 1.3, -2.6],
    [2.0, 1.0, -2.3],
    [0.0, -0.2, -2.4],
    [-1.4, 0.7, 0.4],
    [-2.8, -0.3, 1.8],
    [-0.9, -1.7, 1.4],
    [0.7, -1.3, 0.6],
    [1.3, 0.4, -0.7],
    [0.0, -3.1, -1.3],
    [0.0, -1.9, -0.1],
    [0.0, -2.1, 0.8],
    [0.0, -2.3, -0.4],
    [-0.5, -0.7, -4.1],
    [-0.6, 0.2, -2.5],
    [0.0, 0.8, -2.8],
    [0.0, -1.2, -1.0],
    [-0.3, -1.2, 0.0],
    [-0.1, -1.0, -0.1],
    [-0.4, -1.1, -0.7],
    [-0.1, -1.0, -0.1],
    [-0.3, -1.2, 0.0],
    [1.0, 0.3, -0.5],
    [0.8, 1.8, 0.2],
    [-0.3, 0.9, -0.5],
    [0.0, 1.9, -0.4],
    [-1.5, 0.9, -1.7],
    [-2.4, 1.3, -2.7],
    [0.0, 0.7, -2.1],
    [2.0, 0.5, -1.8],
    [2.0, -0.2, -3.9],
    [0.0, 0.1, -3.1],
    [-1.5, 0.6, -4.1],
    [0.0, 0.1, -3.4],
];

/// As [`MARKS_MM`], for [`Labels::FaceMesh`].
const MESH_MARKS_MM: [[f32; 3]; 39] = [
    [-0.5, 0.1, 2.9],
    [-0.4, 0.3, 2.2],
    [-0.1, 0.4, 1.7],
    [0.3, 0.9, 0.2],
    [0.6, 0.7, -0.6],
    [0.9, 0.5, -0.6],
    [1.4, -0.2, -1.2],
    [0.8, -0.3, -1.1],
    [0.0, -0.6, -1.1],
    [0.1, -1.6, -0.4],
    [0.4, -1.0, 0.6],
    [0.3, -0.9, 0.9],
    [0.3, -1.0, 0.8],
    [0.2, -1.3, 0.0],
    [0.0, 0.6, -0.4],
    [0.0, 0.2, -1.2],
    [0.0, -0.1, -1.6],
    [0.0, -0.5, -1.1],
    [0.5, 0.1, -2.8],
    [0.3, -0.1, -1.9],
    [0.0, -0.4, -2.0],
    [0.3, 0.3, 0.0],
    [0.0, 0.5, 0.4],
    [-0.2, 0.5, 0.4],
    [-0.1, 0.5, -0.4],
    [-0.2, 0.5, 0.4],
    [0.0, 0.5, 0.4],
    [0.1, 0.7, 0.4],
    [-0.1, -0.1, -0.2],
    [-0.2, -0.4, -0.9],
    [0.0, -0.4, -0.9],
    [0.1, 0.5, -0.9],
    [0.3, 0.7, -1.9],
    [0.0, 0.7, -1.5],
    [0.4, 0.7, -0.2],
    [-0.4, 0.1, -2.8],
    [0.0, 0.2, -2.3],
    [0.4, 0.1, -3.0],
    [0.0, 0.3, -2.4],
];

/// The offset of each landmark \[mm, head frame\].
pub fn marks_mm(labels: Labels) -> [Vec3; LANDMARKS] {
    let table = match labels {
        Labels::Convention => MARKS_MM,
        Labels::FaceMesh => MESH_MARKS_MM,
    };
    let mut marks = [Vec3::ZERO; LANDMARKS];
    let left = (0..LANDMARKS).filter(|i| *i <= MIRROR[*i]);
    for (i, [x, y, z]) in left.zip(table) {
        marks[MIRROR[i]] = Vec3::new(-x, y, z);
        marks[i] = Vec3::new(x, y, z);
    }
    marks
}

/// The offset of each landmark in the picture \[px\] of a head of this rotation (head to camera).
pub fn marks_px(labels: Labels, rotation: Mat3, px_per_mm: f32) -> [Vec2; LANDMARKS] {
    marks_mm(labels).map(|mark| px_per_mm * (rotation * mark).truncate())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_symmetric() {
        for labels in [Labels::Convention, Labels::FaceMesh] {
            let marks = marks_mm(labels);
            for i in 0..LANDMARKS {
                let [x, y, z] = marks[MIRROR[i]].to_array();
                assert_eq!(marks[i].to_array(), [-x, y, z], "landmark {i}");
            }
        }
        assert_eq!(
            (0..LANDMARKS).filter(|i| *i <= MIRROR[*i]).count(),
            MARKS_MM.len()
        );
    }
}
