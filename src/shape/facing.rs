//! Facing: the rotation of a head relative to the line of sight, and its deviations.
//!
//! The axes are the camera's after the smallest rotation that turns its z axis to the head's
//! origin. A head with facing angles of 0 looks into the lens, wherever in the picture it is. What
//! the picture of a face shows of a rotation is this one. The bearing of the face, which the axis
//! angles hold too, comes from the intrinsics alone.

use super::Pose;
use crate::math::{HeadAngles, head_angles, towards};
use glam::{Mat3, Vec3};

impl Pose {
    /// The head's rotation relative to the line of sight.
    pub fn facing(&self) -> Mat3 {
        towards(self.translation_mm).transpose() * self.rotation
    }

    /// Yaw, pitch and roll relative to the line of sight.
    pub fn facing_angles(&self) -> HeadAngles {
        head_angles(&self.facing())
    }

    /// Cosine of the angle between the nose's direction and the line from the head to the camera.
    pub fn facing_cosine(&self) -> f32 {
        let sight = self.translation_mm.normalize_or(Vec3::Z);
        self.rotation.z_axis.dot(sight)
    }

    /// Angle between the nose's direction and the line from the head to the camera \[deg\].
    pub fn facing_angle_deg(&self) -> f32 {
        let [x, y, z] = self.facing().z_axis.to_array();
        libm::atan2f(libm::sqrtf(x * x + y * y), z).to_degrees()
    }

    /// Variances of the facing angles \[rad²\] by a covariance of the pose: rotation vector about
    /// the camera's axes \[rad\], then translation \[mm\].
    pub fn facing_variances(&self, covariance: &[[f32; 6]; 6]) -> [f32; 3] {
        self.facing_by_pose().map(|row| {
            let product = |column: &[f32; 6]| column.iter().zip(&row).map(|(c, r)| c * r).sum();
            let products: [f32; 6] = covariance.each_ref().map(product);
            products.iter().zip(&row).map(|(p, r)| p * r).sum()
        })
    }

    /// Derivatives of yaw, pitch and roll relative to the line of sight \[rad\] by a rotation
    /// vector about the camera's axes \[rad\] and a translation \[mm\].
    fn facing_by_pose(&self) -> [[f32; 6]; 3] {
        let to_camera = towards(self.translation_mm);
        let (level, [sin, cos], back) = self.level(&to_camera);
        let roll = Vec3::new(-sin, 0.0, cos) / level;
        let pitch = -Vec3::new(cos, 0.0, sin);
        let yaw = back.y * roll - Vec3::Y;
        let squared = self.translation_mm.length_squared().max(1.0);
        [yaw, pitch, roll].map(|by_turn| {
            let by_turn = to_camera * by_turn;
            // A translation d turns the line of sight by t × d / t², and a little about itself.
            let by_move = self.translation_mm.cross(by_turn) / squared;
            let ([a, b, c], [d, e, f]) = (by_turn.to_array(), by_move.to_array());
            [a, b, c, d, e, f]
        })
    }

    /// Cosine of the facing pitch, sine and cosine of the facing yaw, and the head's z axis, from
    /// axes along the line of sight.
    fn level(&self, to_camera: &Mat3) -> (f32, [f32; 2], Vec3) {
        let back = (to_camera.transpose() * self.rotation).z_axis;
        // Looking straight up or down yaw and roll are one angle: no deviation of them is finite.
        let level = libm::sqrtf(back.x * back.x + back.z * back.z).max(LEAST_LEVEL);
        (level, [-back.x / level, back.z / level], back)
    }
}

/// Least cosine of a pitch, in the derivatives of yaw and roll.
const LEAST_LEVEL: f32 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(yaw_deg: f32, pitch_deg: f32, roll_deg: f32, at: [f32; 3]) -> Pose {
        let angles = HeadAngles {
            yaw_deg,
            pitch_deg,
            roll_deg,
        };
        Pose::of_angles(angles, Vec3::from(at))
    }

    fn numbers(angles: HeadAngles) -> [f32; 3] {
        [angles.yaw_deg, angles.pitch_deg, angles.roll_deg]
    }

    #[test]
    fn facing_is_zero_for_a_head_that_looks_into_the_lens() {
        // 30° to the image right, the head turned back by as much.
        let side = pose(-30.0, 0.0, 0.0, [500.0, 0.0, 866.025]);
        assert!(numbers(side.facing_angles()).iter().all(|v| v.abs() < 1e-3));
        assert!((side.facing_cosine() - 1.0).abs() < 1e-6);
        // 20° below the middle: to look into the lens is to look up.
        let below = pose(0.0, 20.0, 0.0, [0.0, 342.02, 939.69]);
        assert!(
            numbers(below.facing_angles())
                .iter()
                .all(|v| v.abs() < 1e-3)
        );
    }

    #[test]
    fn facing_is_the_axis_angles_in_the_middle_and_less_the_bearing_beside_it() {
        let middle = pose(40.0, -10.0, 5.0, [0.0, 0.0, 700.0]);
        let [yaw, pitch, roll] = numbers(middle.facing_angles());
        assert!((yaw - 40.0).abs() < 1e-3 && (pitch + 10.0).abs() < 1e-3);
        assert!((roll - 5.0).abs() < 1e-3);
        // The face is 10° to the image right: 40° to the right of the camera's axis are 50° from
        // the line of sight, on which the face looks 10° to the left when it looks into the lens.
        let beside = pose(40.0, 0.0, 0.0, [173.648, 0.0, 984.808]);
        assert!((beside.facing_angles().yaw_deg - 50.0).abs() < 1e-2);
    }

    #[test]
    fn the_facing_angle_is_yaw_and_pitch_together() {
        let at = [173.648, 90.0, 984.808];
        for [yaw, pitch] in [
            [0.0, 0.0],
            [50.0, 0.0],
            [-20.0, 35.0],
            [120.0, 10.0],
            [3.0, -89.0],
        ] {
            let pose = pose(yaw, pitch, 15.0, at);
            let [yaw, pitch, _] = numbers(pose.facing_angles()).map(f32::to_radians);
            let angle = (yaw.cos() * pitch.cos()).acos().to_degrees();
            let found = pose.facing_angle_deg();
            assert!((found - angle).abs() < 0.1, "{found} is not {angle}");
            assert!((found.to_radians().cos() - pose.facing_cosine()).abs() < 1e-5);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_angles() {
        let at = pose(55.0, 15.0, -20.0, [60.0, -40.0, 600.0]);
        let rows = at.facing_by_pose();
        let before = numbers(at.facing_angles());
        for unknown in 0..6 {
            let mut change = [[0.0; 3]; 2];
            let size = if unknown < 3 { 0.01 } else { 5.0 };
            change[unknown / 3][unknown % 3] = size;
            let [turn, shift] = change.map(Vec3::from);
            let after = numbers(at.moved(turn, shift).facing_angles());
            for (row, (a, b)) in rows.iter().zip(after.iter().zip(before)) {
                let found = (a - b).to_radians() / size;
                let error = (found - row[unknown]).abs() * size;
                assert!(error < 6e-4, "{unknown}: {found} {}", row[unknown]);
            }
        }
    }
}
