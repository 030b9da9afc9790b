//! A face that the caller expects somewhere.

use crate::detect::Detection;

/// Range of the longer side of a hint's box \[px\].
const SIDE_PX: core::ops::RangeInclusive<f32> = 16.0..=32_768.0;
/// Largest coordinate of a hint's box \[px\].
const FARTHEST_PX: f32 = 65_536.0;

/// Where a face is expected: what another detector, or a tracker of another camera, has found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FaceHint {
    /// Box of the landmarks: left, top, width, height \[px\]. It reaches from the brows to below
    /// the chin and from ear to ear; boxes of whole heads are larger.
    pub face_box: [f32; 4],
    /// Yaw \[deg\], 0 where it is not known.
    pub yaw_deg: f32,
    /// Roll \[deg\], 0 where it is not known.
    pub roll_deg: f32,
}

impl FaceHint {
    /// A face that looks at the camera.
    pub const fn new(face_box: [f32; 4]) -> Self {
        FaceHint {
            face_box,
            yaw_deg: 0.0,
            roll_deg: 0.0,
        }
    }

    /// With these angles \[deg\].
    pub const fn with_angles(self, yaw_deg: f32, roll_deg: f32) -> Self {
        FaceHint {
            yaw_deg,
            roll_deg,
            ..self
        }
    }

    /// The same as a detection; `None` where a number is out of range.
    pub(super) fn detection(&self) -> Option<Detection> {
        let [x, y, width, height] = self.face_box;
        let size = width.max(height);
        let is_valid = SIDE_PX.contains(&size)
            && width > 0.0
            && height > 0.0
            && x.abs() <= FARTHEST_PX
            && y.abs() <= FARTHEST_PX
            && self.yaw_deg.abs() <= 180.0
            && self.roll_deg.abs() <= 360.0;
        is_valid.then_some(Detection {
            x: x + width / 2.0,
            y: y + height / 2.0,
            size,
            roll: self.roll_deg.to_radians(),
            // Normalised: 1 is a profile.
            yaw: (self.yaw_deg / 90.0).clamp(-1.0, 1.0),
            ..Detection::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hint_is_a_detection_or_out_of_range() {
        let hint = FaceHint::new([10.0, 20.0, 80.0, 100.0]).with_angles(-45.0, 90.0);
        let found = hint.detection().expect("in range");
        assert_eq!([found.x, found.y, found.size], [50.0, 70.0, 100.0]);
        assert_eq!(found.yaw, -0.5);
        for bad in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
            for k in 0..4 {
                let mut hint = hint;
                hint.face_box[k] = bad;
                let is_place = k < 2 && bad == -1.0;
                assert_eq!(hint.detection().is_some(), is_place, "{hint:?}");
            }
        }
        assert_eq!(hint.with_angles(f32::NAN, 0.0).detection(), None);
    }
}
