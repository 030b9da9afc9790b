//! Head rotations in the angle conventions of the data sets.
//!
//! R is the head-to-camera rotation of docs/conventions.md: x to the image right, y down, z away
//! from the camera; yaw > 0 to the image right, pitch > 0 up, roll > 0 clockwise.

use glam::Mat3;
use posewise::math::{HeadAngles, head_angles, head_rotation};

/// Yaw, pitch, roll \[deg\].
pub type Angles = [f64; 3];

/// Head-to-camera rotation of yaw, pitch and roll as posewise has them.
pub fn rotation([yaw, pitch, roll]: Angles) -> Mat3 {
    head_rotation(HeadAngles {
        yaw_deg: yaw as f32,
        pitch_deg: pitch as f32,
        roll_deg: roll as f32,
    })
}

/// Yaw, pitch and roll as posewise has them.
pub fn angles(rotation: &Mat3) -> Angles {
    let a = head_angles(rotation);
    [a.yaw_deg, a.pitch_deg, a.roll_deg].map(f64::from)
}

/// The rotation since a first one, in the axes of the first head.
pub fn relative(first: &Mat3, now: &Mat3) -> Angles {
    angles(&(first.transpose() * *now))
}

/// R = Rx(a)·Ry(b)·Rz(c) \[rad\].
fn of_xyz([a, b, c]: [f32; 3]) -> Mat3 {
    Mat3::from_rotation_x(a) * Mat3::from_rotation_y(b) * Mat3::from_rotation_z(c)
}

/// Boston University: columns 5 to 7 of a row are roll, yaw, pitch \[deg\]; positive are
/// anticlockwise, to the image right, and down. R = Rx(pitch)·Ry(−yaw)·Rz(−roll).
///
/// Source of order and signs: the evaluation scripts of OpenFace, which compare with them.
pub fn of_boston([roll, yaw, pitch]: [f64; 3]) -> Mat3 {
    of_xyz([pitch, -yaw, -roll].map(|a| a.to_radians() as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn near(a: Angles, b: Angles) {
        let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-3, "{a:?} {b:?}");
    }

    /// Where the tip of the nose and the crown point to in the image.
    fn directions(r: &Mat3) -> (Vec3, Vec3) {
        (*r * Vec3::NEG_Z, *r * Vec3::NEG_Y)
    }

    #[test]
    fn signs_of_single_rotations() {
        let (nose, _) = directions(&of_boston([0.0, 30.0, 0.0]));
        assert!(
            (nose.x - 0.5).abs() < 1e-6,
            "Boston: yaw to the image right"
        );
        let (nose, _) = directions(&of_boston([0.0, 0.0, 30.0]));
        assert!((nose.y - 0.5).abs() < 1e-6, "Boston: pitch down");
        let (_, crown) = directions(&of_boston([30.0, 0.0, 0.0]));
        assert!((crown.x + 0.5).abs() < 1e-6, "Boston: roll anticlockwise");
    }

    #[test]
    fn conversions_are_inverse() {
        for [yaw, pitch, roll] in [[0.0; 3], [50.0, -20.0, 10.0], [-70.0, 30.0, -40.0]] {
            let ours = rotation([yaw, pitch, roll]);
            near(angles(&ours), [yaw, pitch, roll]);
            near(relative(&ours, &ours), [0.0; 3]);
        }
    }
}
