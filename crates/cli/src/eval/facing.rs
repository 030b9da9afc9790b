//! The head relative to the line from the face to the camera.

use glam::{Mat3, Quat, Vec3};
use posewise::math::{HeadAngles, head_angles};
use posewise::track::TrackResult;

/// Yaw, pitch and roll that the head would have if its position were turned onto the optical axis
/// by the smallest rotation: 0, 0 looks into the lens.
pub fn facing(result: &TrackResult) -> HeadAngles {
    let to_face = Vec3::from(result.translation_mm).normalize_or(Vec3::Z);
    let onto_axis = Quat::from_rotation_arc(to_face, Vec3::Z);
    head_angles(&Mat3::from_quat(
        onto_axis * Quat::from_array(result.rotation),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head 20° to the right that looks along the camera's axis, and one that looks into the lens.
    #[test]
    fn facing_by_hand() {
        let mut result = TrackResult::EMPTY;
        let beside = Quat::from_rotation_y(20f32.to_radians());
        result.translation_mm = (beside * Vec3::new(0.0, 0.0, 800.0)).to_array();
        result.rotation = Quat::IDENTITY.to_array();
        let angles = facing(&result);
        assert!((angles.yaw_deg - 20.0).abs() < 1e-3, "{angles:?}");
        result.rotation = beside.to_array();
        let angles = facing(&result);
        assert!(angles.yaw_deg.abs() < 1e-3 && angles.pitch_deg.abs() < 1e-3);
    }
}
