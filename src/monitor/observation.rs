//! What a monitor sees of one frame.

use crate::track::{Eye, EyeUnknown, State, TrackResult};

/// One frame as a monitor sees it: a subset of [`TrackResult`]. A number that is not finite is
/// unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Observation {
    /// Only a face that is tracked is observed: a coasted one repeats an earlier frame.
    pub state: State,
    /// As [`TrackResult::confidence`].
    pub confidence: f32,
    /// Yaw in the camera frame \[deg\], > 0: the face turns to the image right.
    pub yaw_deg: f32,
    /// Pitch in the camera frame \[deg\], > 0: the face turns up.
    pub pitch_deg: f32,
    /// Midway between the eyeballs, camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// Standard deviations of the rotation about the camera's axes \[deg\].
    pub rotation_sigma_deg: [f32; 3],
    /// Openness of the person's left and right eye: 0 shut, 1 open, below 0 unknown.
    pub eye_open: [f32; 2],
    /// Animation weight `jawOpen`, 0..1, below 0 unknown.
    pub jaw_open: f32,
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
        eye_open: [-1.0; 2],
        jaw_open: -1.0,
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

/// Openness of an eye that is open for sure, at least, and of one that is shut for sure, at most:
/// outside of the thresholds of a closure.
const OPEN_AT_LEAST: f32 = 0.5;
const SHUT_AT_MOST: f32 = 0.1;

/// Openness of an eye by its lids and by the network that sees it: lids that look down or are badly
/// placed do not shut an eye that is open for sure, and the other way round. In between the lids
/// say it. Behind dark glasses and reflections it is unknown, −1.
pub fn fused_openness(lids: f32, eye: &Eye) -> f32 {
    match eye.unknown {
        EyeUnknown::DarkGlasses | EyeUnknown::Glare => -1.0,
        EyeUnknown::Known | EyeUnknown::Uncertain if lids >= 0.0 => {
            // −1 shut for sure, 1 open for sure.
            let sure = 2.0 * eye.open - 1.0;
            match sure >= 0.0 {
                true => lids.max(sure * OPEN_AT_LEAST),
                false => lids.min(1.0 + sure * (1.0 - SHUT_AT_MOST)),
            }
        }
        _ => lids,
    }
}

impl From<&TrackResult> for Observation {
    fn from(result: &TrackResult) -> Self {
        let ([left, right], [left_eye, right_eye]) = (&result.eye_open, &result.eyes.each);
        let mouth = result.landmarks.get(MOUTH).unwrap_or_default();
        let visibility: f32 = mouth.iter().map(|landmark| landmark.visibility).sum();
        let is_visible = visibility >= MOUTH_VISIBILITY * MOUTH.len() as f32;
        let jaw_open = result.animation.get(JAW_OPEN).filter(|_| is_visible);
        Observation {
            state: result.state,
            confidence: result.confidence,
            yaw_deg: result.yaw_deg,
            pitch_deg: result.pitch_deg,
            translation_mm: result.translation_mm,
            rotation_sigma_deg: result.rotation_sigma_deg,
            eye_open: [
                fused_openness(*left, left_eye),
                fused_openness(*right, right_eye),
            ],
            jaw_open: jaw_open.copied().unwrap_or(-1.0),
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
    fn lids_and_network_are_fused() {
        let eye = |unknown, open| Eye {
            unknown,
            open,
            ..Eye::EMPTY
        };
        assert_eq!(fused_openness(0.4, &eye(EyeUnknown::NotSeen, 0.0)), 0.4);
        assert_eq!(
            fused_openness(0.1, &eye(EyeUnknown::DarkGlasses, -1.0)),
            -1.0
        );
        assert_eq!(fused_openness(0.1, &eye(EyeUnknown::Known, 1.0)), 0.5);
        assert_eq!(fused_openness(0.4, &eye(EyeUnknown::Uncertain, 0.5)), 0.4);
        assert!(fused_openness(0.6, &eye(EyeUnknown::Known, 0.0)) < 0.11);
        assert_eq!(fused_openness(-1.0, &eye(EyeUnknown::Known, 1.0)), -1.0);
    }

    #[test]
    fn a_hidden_mouth_is_unknown() {
        let mut result = TrackResult::EMPTY;
        result.animation[JAW_OPEN] = 0.7;
        assert_eq!(Observation::from(&result).jaw_open, -1.0);
        for landmark in &mut result.landmarks[48..60] {
            landmark.visibility = 1.0;
        }
        assert_eq!(Observation::from(&result).jaw_open, 0.7);
    }
}
