//! What a monitor sees of one frame.

use crate::shape::SHUT;
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
    /// Distance of the lids in that of open ones, of the person's left and right eye: 0 shut, 1
    /// open, below 0 unknown (`fused_openness`).
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

/// Openness of an eye that is open for sure, at least: outside of the thresholds of a closure.
const OPEN_AT_LEAST: f32 = 0.5;
/// By how much the distance of the lids is shortened where the eye is shut for sure, and how sure
/// that is where it begins and where it is whole. The network takes eyes for shut from about 0.5 of
/// the way on, so it does not say how far they are.
const SHORTER: f32 = 0.6;
const SHUT_SURE: (f32, f32) = (0.5, 0.85);

/// Below this reading of the lids their distance falls steeply to 0 \[per reading\]: a reading of 0
/// is that of any distance that is shorter than [`SHUT`].
const STEEP: f32 = 4.0;

/// Distance of the lids in that of open ones, by the reading `eye_open`, which has 0 at [`SHUT`]
/// already. Lids that are shut by 80 % have 0.2 here, where P80 has its limit; they read 0.05.
fn distance(lids: f32) -> f32 {
    (SHUT + (1.0 - SHUT) * lids).min(STEEP * lids)
}

/// Openness of an eye by its lids and by the network that sees it: lids that look down or are badly
/// placed do not shut an eye that is open for sure, and the other way round. Where the network
/// cannot tell, and behind dark glasses and reflections, it is unknown, −1: what covers an eye
/// moves its lids anywhere.
pub fn fused_openness(lids: f32, eye: &Eye) -> f32 {
    let lids = if lids > 0.0 { distance(lids) } else { lids };
    match eye.unknown {
        EyeUnknown::DarkGlasses | EyeUnknown::Glare | EyeUnknown::Uncertain => -1.0,
        EyeUnknown::Known if lids >= 0.0 => {
            // −1 shut for sure, 1 open for sure.
            let sure = 2.0 * eye.open - 1.0;
            match sure >= 0.0 {
                true => lids.max(sure * OPEN_AT_LEAST),
                false => {
                    let (some, whole) = SHUT_SURE;
                    let share = ((-sure - some) / (whole - some)).clamp(0.0, 1.0);
                    lids * (1.0 - SHORTER * share)
                }
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
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} {b}");
        near(fused_openness(0.4, &eye(EyeUnknown::NotSeen, 0.0)), 0.496);
        near(fused_openness(0.04, &eye(EyeUnknown::NotSeen, 0.0)), 0.16);
        assert_eq!(fused_openness(0.0, &eye(EyeUnknown::NotSeen, 0.0)), 0.0);
        assert_eq!(
            fused_openness(0.1, &eye(EyeUnknown::DarkGlasses, -1.0)),
            -1.0
        );
        assert_eq!(fused_openness(0.1, &eye(EyeUnknown::Known, 1.0)), 0.5);
        assert_eq!(fused_openness(0.4, &eye(EyeUnknown::Uncertain, 0.5)), -1.0);
        near(fused_openness(0.4, &eye(EyeUnknown::Known, 0.0)), 0.1984);
        near(fused_openness(0.4, &eye(EyeUnknown::Known, 0.25)), 0.496);
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
