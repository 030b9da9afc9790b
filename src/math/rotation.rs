//! Head rotations: conversion between angles, matrix and quaternion.
//!
//! Camera axes: x right, y down, z away from the camera. A head with the identity rotation looks
//! straight into the camera (nose along −z). `R = Ry(−yaw) · Rx(−pitch) · Rz(roll)`, column
//! vectors, right-handed rotations about each axis. yaw > 0 turns the face to the image right,
//! pitch > 0 turns it up, roll > 0 tilts it clockwise in the image.

use glam::{Mat3, Vec3};

/// Yaw, pitch and roll of a head \[deg\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadAngles {
    /// > 0: the face turns to the image right. −180..180.
    pub yaw_deg: f32,
    /// > 0: the face turns up. −90..90.
    pub pitch_deg: f32,
    /// > 0: the head tilts clockwise in the image. −180..180.
    pub roll_deg: f32,
}

/// The head-to-camera rotation of these angles.
pub fn head_rotation(angles: HeadAngles) -> Mat3 {
    let sc = |deg: f32| {
        let rad = deg.to_radians();
        (libm::sinf(rad), libm::cosf(rad))
    };
    let (sy, cy) = sc(-angles.yaw_deg);
    let (sp, cp) = sc(-angles.pitch_deg);
    let (sr, cr) = sc(angles.roll_deg);
    let yaw = Mat3::from_cols(Vec3::new(cy, 0., -sy), Vec3::Y, Vec3::new(sy, 0., cy));
    let pitch = Mat3::from_cols(Vec3::X, Vec3::new(0., cp, sp), Vec3::new(0., -sp, cp));
    let roll = Mat3::from_cols(Vec3::new(cr, sr, 0.), Vec3::new(-sr, cr, 0.), Vec3::Z);
    yaw * pitch * roll
}

/// The angles of a head-to-camera rotation; the inverse of [`head_rotation`] for |pitch| < 90°.
pub fn head_angles(rotation: &Mat3) -> HeadAngles {
    // With the nose direction d = R·(0, 0, −1): yaw = atan2(dx, −dz), pitch = asin(−dy).
    let z = rotation.z_axis;
    HeadAngles {
        yaw_deg: libm::atan2f(-z.x, z.z).to_degrees(),
        pitch_deg: libm::asinf(z.y.clamp(-1.0, 1.0)).to_degrees(),
        // The middle row of R is cos(pitch)·(sin roll, cos roll, ·).
        roll_deg: libm::atan2f(rotation.x_axis.y, rotation.y_axis.y).to_degrees(),
    }
}

/// The rotation matrix of a unit quaternion x, y, z, w.
pub fn rotation_from_quaternion([x, y, z, w]: [f32; 4]) -> Mat3 {
    Mat3::from_cols(
        Vec3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + z * w),
            2.0 * (x * z - y * w),
        ),
        Vec3::new(
            2.0 * (x * y - z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z + x * w),
        ),
        Vec3::new(
            2.0 * (x * z + y * w),
            2.0 * (y * z - x * w),
            1.0 - 2.0 * (x * x + y * y),
        ),
    )
}

/// The rotation from a camera that looks straight at an image point to the camera itself: about the
/// axis that is perpendicular to both directions. `ray` is the point at unit depth.
pub fn towards(ray: Vec3) -> Mat3 {
    let z = ray.normalize_or(Vec3::Z);
    // Rodrigues' formula for the rotation of Z to z.
    let (x, y, cosine) = (z.x, z.y, z.z);
    let share = 1.0 / (1.0 + cosine.max(0.0));
    Mat3::from_cols(
        Vec3::new(1.0 - share * x * x, -share * x * y, -x),
        Vec3::new(-share * x * y, 1.0 - share * y * y, -y),
        Vec3::new(x, y, cosine),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_by_hand() {
        let nose = |yaw_deg, pitch_deg, roll_deg| {
            head_rotation(HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            }) * Vec3::new(0., 0., -1.)
        };
        assert!(
            nose(30., 0., 0.).x > 0.49,
            "yaw > 0: nose to the image right"
        );
        assert!(nose(0., 30., 0.).y < -0.49, "pitch > 0: nose up");
        let crown = head_rotation(HeadAngles {
            roll_deg: 30.,
            ..Default::default()
        }) * -Vec3::Y;
        assert!(crown.x > 0.49, "roll > 0: crown to the image right");
    }

    #[test]
    fn angles_round_trip() {
        for (yaw_deg, pitch_deg, roll_deg) in [
            (0., 0., 0.),
            (85., 10., -20.),
            (-60., -40., 30.),
            (120., 5., 170.),
        ] {
            let angles = HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            };
            let back = head_angles(&head_rotation(angles));
            assert!((back.yaw_deg - yaw_deg).abs() < 1e-3, "{back:?}");
            assert!((back.pitch_deg - pitch_deg).abs() < 1e-3, "{back:?}");
            assert!((back.roll_deg - roll_deg).abs() < 1e-3, "{back:?}");
        }
    }

    #[test]
    fn a_camera_that_looks_at_a_point_sees_it_straight_ahead() {
        let ray = Vec3::new(0.4, -0.2, 1.0);
        let rotation = towards(ray);
        assert!((rotation * Vec3::Z - ray.normalize()).length() < 1e-5);
        let product = rotation * rotation.transpose() - Mat3::IDENTITY;
        assert!(product.to_cols_array().iter().all(|v| v.abs() < 1e-5));
    }
}
