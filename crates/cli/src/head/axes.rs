//! From our frames to those of 3D programs: half a turn about x, and metres.
//!
//! Ours: x to the image right or to the person's left, y down, z away from the camera or of the
//! face \[mm\]. glTF's: x the same, y up, z towards the camera or out of the face \[m\]. Both are
//! right-handed.

use glam::Vec3;
use posewise::mesh::MeshVertex;

const MM: f32 = 1e-3;

/// A point, or a translation.
pub fn point([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x * MM, -y * MM, -z * MM]
}

/// The place of a vertex.
pub fn place(vertex: &MeshVertex) -> Vec3 {
    Vec3::from_array(point([vertex.x, vertex.y, vertex.z]))
}

/// A rotation, as a quaternion x, y, z, w.
pub fn rotation([x, y, z, w]: [f32; 4]) -> [f32; 4] {
    [x, -y, -z, w]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{EulerRot, Quat};

    /// A point of the head is where it was, whichever side of the turn it is moved on.
    #[test]
    fn poses_of_both_frames_agree() {
        let ours = Quat::from_euler(EulerRot::YXZ, 0.5, -0.3, 0.2);
        let (p, t) = (Vec3::new(30.0, 70.0, -20.0), Vec3::new(40.0, -50.0, 600.0));
        let expected = point((ours * p + t).to_array());
        let turn = Quat::from_array(rotation(ours.to_array()));
        let moved = turn * Vec3::from_array(point(p.to_array()));
        let found = moved + Vec3::from_array(point(t.to_array()));
        assert!(found.distance(Vec3::from_array(expected)) < 1e-6);
    }

    /// The nose, before the face, points to the camera; the chin is down.
    #[test]
    fn signs_by_hand() {
        assert_eq!(point([0.0, 0.0, -50.0])[2], 0.05);
        assert_eq!(point([0.0, 100.0, 0.0])[1], -0.1);
        // A head that turns to the image right turns its nose to +x.
        let right = Quat::from_rotation_y(-0.5);
        let nose = Quat::from_array(rotation(right.to_array())) * Vec3::Z;
        assert!(nose.x > 0.4, "{nose}");
    }
}
