//! What a monitor sees of one frame.

use super::openness::openness;
use crate::track::{State, TrackResult};

/// One frame as a monitor sees it: a subset of [`TrackResult`]. A number that is not finite is
/// unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct Observation {
    /// Only a face that is tracked is observed: a coasted one repeats an earlier frame.
    pub state: State,
    /// As [`TrackResult::confidence`].
    pub confidence: f32,
    /// Yaw relative to the camera's axes \[deg\], > 0: the face turns to the image right.
    pub yaw_deg: f32,
    /// Pitch relative to the camera's axes \[deg\], > 0: the face turns up.
    pub pitch_deg: f32,
    /// Midway between the eyeballs, camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// Standard deviations of the rotation about the camera's axes \[deg\].
    pub rotation_sigma_deg: [f32; 3],
    /// Distance of the lids in that of open ones that look where these do, of the person's left
    /// and right eye: 0 shut, 1 open (`openness`).
    pub eye_open: [Option<f32>; 2],
    /// Lids that are as good as shut may follow a lowered gaze: a closure of such time alone is no
    /// longer than a blink, and PERCLOS leaves it out.
    pub may_look_down: bool,
    /// Animation weight `jawOpen`, 0..1, where the mouth is seen.
    pub jaw_open: Option<f32>,
    /// Unit gaze of both eyes, camera frame, where it is known.
    pub gaze: Option<[f32; 3]>,
    /// Its standard deviation about each axis that is perpendicular to it \[deg\]; 0: not known.
    pub gaze_sigma_deg: f32,
    /// As [`TrackResult::camera_assumed`]: a natural pose that is learnt, and the angles from the
    /// road with it, are relative to the line of sight then.
    pub camera_assumed: bool,
}

impl Observation {
    /// No face.
    pub const NONE: Observation = Observation {
        state: State::Searching,
        confidence: 0.0,
        yaw_deg: 0.0,
        pitch_deg: 0.0,
        translation_mm: [0.0; 3],
        rotation_sigma_deg: [0.0; 3],
        eye_open: [None; 2],
        may_look_down: false,
        jaw_open: None,
        gaze: None,
        gaze_sigma_deg: 0.0,
        camera_assumed: false,
    };
}

impl Default for Observation {
    fn default() -> Self {
        Self::NONE
    }
}

/// Index of `jawOpen` in [`crate::ANIMATION_NAMES`]; a test compares them.
const JAW_OPEN: usize = 9;
/// The landmarks of the mouth.
const MOUTH: core::ops::Range<usize> = 48..68;
/// Least mean visibility of the mouth's landmarks for a known `jaw_open`: a hand before the mouth
/// hides more than half of them.
const MOUTH_VISIBILITY: f32 = 0.5;

impl From<&TrackResult> for Observation {
    fn from(result: &TrackResult) -> Self {
        let mouth = result.landmarks.get(MOUTH).unwrap_or_default();
        let visibility: f32 = mouth.iter().map(|landmark| landmark.visibility).sum();
        let is_visible = visibility >= MOUTH_VISIBILITY * MOUTH.len() as f32;
        let jaw_open = result.animation.get(JAW_OPEN).filter(|_| is_visible);
        let eyes = openness(result.eye_open, &result.eyes);
        let gaze = result.eyes.gaze.ok().filter(|_| !eyes.are_shut);
        Observation {
            state: result.state,
            confidence: result.confidence,
            yaw_deg: result.yaw_deg,
            pitch_deg: result.pitch_deg,
            translation_mm: result.translation_mm,
            rotation_sigma_deg: result.rotation_sigma_deg,
            eye_open: eyes.eye_open,
            may_look_down: eyes.may_look_down,
            jaw_open: jaw_open.copied(),
            gaze: gaze.map(|gaze| gaze.camera),
            gaze_sigma_deg: gaze.map_or(0.0, |gaze| gaze.sigma_deg),
            camera_assumed: result.camera_assumed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jaw_is_where_the_names_say() {
        assert_eq!(crate::shape::ANIMATION_NAMES[JAW_OPEN], "jawOpen");
    }

    #[test]
    fn a_hidden_mouth_is_unknown() {
        let mut result = TrackResult::EMPTY;
        result.animation[JAW_OPEN] = 0.7;
        assert_eq!(Observation::from(&result).jaw_open, None);
        for landmark in &mut result.landmarks[48..60] {
            landmark.visibility = 1.0;
        }
        assert_eq!(Observation::from(&result).jaw_open, Some(0.7));
    }
}
