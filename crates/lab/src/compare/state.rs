//! The state of a frame (thesis 3.1): rotation, translation and eleven animation units.

use glam::{Mat3, Vec3};

/// Animation units, as many as the thesis uses of Candide-3; ARKit's shapes that each one moves.
pub const UNITS: [&[&str]; 11] = [
    &["browDownLeft", "browDownRight"],
    &["browInnerUp"],
    &["browOuterUpLeft", "browOuterUpRight"],
    &["eyeBlinkLeft", "eyeBlinkRight"],
    &["eyeWideLeft", "eyeWideRight"],
    &["jawOpen"],
    &["mouthSmileLeft", "mouthSmileRight"],
    &["mouthFrownLeft", "mouthFrownRight"],
    &["mouthFunnel"],
    &["mouthPucker"],
    &["mouthStretchLeft", "mouthStretchRight"],
];

/// Numbers of the rigid part.
pub const RIGID: usize = 6;
/// Numbers of a state: 17, as in the thesis.
pub const SIZE: usize = RIGID + UNITS.len();

/// A change of state: rotation vector about the camera's axes \[rad\], translation \[mm\], units.
pub type Step = [f64; SIZE];

/// Standard deviations of a change between frames at 30 Hz beside the predicted one:
/// rotation \[rad\], sideways and depth \[mm\], units.
pub const SIGMA: Step = {
    let mut sigma = [0.15; SIZE];
    let mut k = 0;
    while k < 3 {
        sigma[k] = 0.05;
        sigma[3 + k] = 8.0;
        k += 1;
    }
    sigma[5] = 15.0;
    sigma
};

/// Share of the last frame's motion that the next frame is predicted to have.
pub const DAMPING: f64 = 0.8;

/// Pose and animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Head to camera.
    pub rotation: Mat3,
    /// Of the head's origin in the camera frame \[mm\].
    pub translation: Vec3,
    /// Weights of [`UNITS`], 0 to 1.
    pub units: [f32; UNITS.len()],
}

/// Nearest that a head comes to the camera \[mm\].
const NEAREST_MM: f32 = 100.0;

impl State {
    /// After a change.
    pub fn moved(&self, step: &[f64]) -> State {
        let vector = |at: usize| Vec3::from([0, 1, 2].map(|k| step[at + k] as f32));
        let turned = Mat3::from_quat(glam::Quat::from_scaled_axis(vector(0))) * self.rotation;
        let mut translation = self.translation + vector(3);
        translation.z = translation.z.max(NEAREST_MM);
        let mut units = self.units;
        for (unit, change) in units.iter_mut().zip(&step[RIGID..]) {
            *unit = (*unit + *change as f32).clamp(0.0, 1.0);
        }
        State {
            rotation: turned,
            translation,
            units,
        }
    }

    /// The rigid change from `before` to this state.
    pub fn motion_since(&self, before: &State) -> Step {
        let turn = glam::Quat::from_mat3(&(self.rotation * before.rotation.transpose()));
        let turn = turn.to_scaled_axis();
        let moved = self.translation - before.translation;
        let mut step = [0.0; SIZE];
        let values = turn.to_array().into_iter().chain(moved.to_array());
        step.iter_mut()
            .zip(values)
            .for_each(|(s, v)| *s = f64::from(v));
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_is_the_inverse_of_moving() {
        let start = State {
            rotation: Mat3::from_rotation_y(0.4),
            translation: Vec3::new(10.0, -5.0, 600.0),
            units: [0.2; UNITS.len()],
        };
        let mut step = [0.0; SIZE];
        step[..RIGID].copy_from_slice(&[0.1, -0.2, 0.05, 3.0, 4.0, -20.0]);
        let moved = start.moved(&step);
        let back = moved.motion_since(&start);
        assert!(step.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-4));
        step[RIGID] = 5.0;
        assert_eq!(start.moved(&step).units[0], 1.0);
    }
}
