//! A prior of the head's rotation, which the fit takes beside the landmarks.

use glam::{Mat3, Vec3};

/// A Gaussian over head-to-camera rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationPrior {
    /// Its mean.
    pub rotation: Mat3,
    /// Inverse covariance of a rotation vector about the camera's axes \[1/rad²\], symmetric.
    pub information: Mat3,
    /// Independent observations that it counts as.
    pub weight: f32,
}

impl RotationPrior {
    /// The rotation vector about the camera's axes that turns `rotation` into the mean \[rad\].
    pub fn residual(&self, rotation: &Mat3) -> Vec3 {
        rotation_vector(&(self.rotation * rotation.transpose()))
    }
}

/// The rotation vector of a rotation: its axis times its angle \[rad\], 0 for half a turn.
pub fn rotation_vector(rotation: &Mat3) -> Vec3 {
    let [x, y, z] = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
    // Twice the sine of the angle times the axis.
    let axis = Vec3::new(y.z - z.y, z.x - x.z, x.y - y.x);
    let sine = 0.5 * axis.length();
    let cosine = 0.5 * (x.x + y.y + z.z - 1.0);
    // Where the angle is small their ratio is 1.
    let ratio = match sine > 1e-4 {
        true => libm::atan2f(sine, cosine) / sine,
        false => 1.0,
    };
    0.5 * ratio * axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{HeadAngles, head_rotation};

    fn near(a: Mat3, b: Mat3) -> bool {
        (a - b).to_cols_array().iter().all(|v| v.abs() < 1e-5)
    }

    #[test]
    fn a_rotation_vector_turns_one_rotation_into_the_other() {
        let at = |yaw_deg, pitch_deg, roll_deg| {
            head_rotation(HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            })
        };
        let (a, b) = (at(10.0, 5.0, -3.0), at(70.0, -20.0, 15.0));
        let prior = RotationPrior {
            rotation: b,
            information: Mat3::IDENTITY,
            weight: 1.0,
        };
        let turn = prior.residual(&a);
        let turned = Mat3::from_axis_angle(turn.normalize(), turn.length()) * a;
        assert!(near(turned, b), "{turned:?}");
        assert!(prior.residual(&b).length() < 1e-6);
    }
}
