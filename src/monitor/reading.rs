//! What of an observation is known.

use super::config::MonitorConfig;
use super::observation::Observation;
use super::state::Unknown;
use crate::shape::FARTHEST_MM;
use crate::track::State;

/// Largest standard deviation of an angle of a known pose \[deg\]. Chosen: the width of the road in
/// the default zones.
const MOST_SIGMA_DEG: f32 = 15.0;
/// Largest angle of a head \[deg\].
const MOST_DEG: f32 = 180.0;
/// How much less the head must be turned for eyes to be known again \[deg\].
const TURNED_MARGIN_DEG: f32 = 3.0;

/// The known part of an observation.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    /// Openness of both eyes together, relative to this person's open eyes.
    pub(super) openness: Option<f32>,
    /// Why it is unknown.
    pub(super) unknown: Unknown,
    /// Openness of each eye, as the tracker reports it; for a known openness.
    pub(super) eyes: [Option<f32>; 2],
    /// Openness of the jaw.
    pub(super) jaw: Option<f32>,
    /// Yaw and pitch in the camera frame \[deg\], and the head's place \[mm\].
    pub(super) pose: Option<([f32; 2], [f32; 3])>,
}

impl Reading {
    /// Nothing is known.
    pub(super) const NONE: Reading = Reading {
        openness: None,
        unknown: Unknown::NoFace,
        eyes: [None; 2],
        jaw: None,
        pose: None,
    };

    pub(super) fn new(
        seen: &Observation,
        last: &Reading,
        open_eye: [f32; 2],
        config: &MonitorConfig,
    ) -> Reading {
        let unknown = |unknown| Reading {
            unknown,
            ..Reading::NONE
        };
        if seen.state != State::Tracking {
            return unknown(Unknown::NoFace);
        }
        let Some(pose) = known_pose(seen, config) else {
            return unknown(Unknown::LowConfidence);
        };
        let reading = Reading {
            pose: Some(pose),
            ..Reading::NONE
        };
        let [yaw, pitch] = pose.0;
        let margin = match last.unknown {
            Unknown::Turned => TURNED_MARGIN_DEG,
            _ => 0.0,
        };
        if yaw.abs() > config.eye_yaw_deg - margin || pitch.abs() > config.eye_pitch_deg - margin {
            return Reading {
                unknown: Unknown::Turned,
                ..reading
            };
        }
        let is_share = |v: &f32| (0.0..=1.0).contains(v);
        let eyes = seen.eye_open.map(|open| Some(open).filter(is_share));
        let openness = fuse(eyes, open_eye);
        Reading {
            openness,
            unknown: match openness {
                Some(_) => Unknown::Known,
                None => Unknown::Hidden,
            },
            eyes,
            jaw: Some(seen.jaw_open).filter(is_share),
            ..reading
        }
    }
}

/// Angles and place of the head, if they are certain.
fn known_pose(seen: &Observation, config: &MonitorConfig) -> Option<([f32; 2], [f32; 3])> {
    let angles = [seen.yaw_deg, seen.pitch_deg];
    // No comparison holds for a NaN.
    let is_certain = |sigma: &f32| (0.0..=MOST_SIGMA_DEG).contains(sigma);
    let is_known = seen.confidence >= config.min_confidence
        && angles.iter().all(|angle| angle.abs() <= MOST_DEG)
        && seen.translation_mm.iter().all(|v| v.abs() <= FARTHEST_MM)
        && seen.rotation_sigma_deg.iter().all(is_certain);
    is_known.then_some((angles, seen.translation_mm))
}

/// Openness of both eyes: their mean, because lids move together, and one that is read too open or
/// too shut, mostly that of the farther eye, is made up for by the other. A wink is no closure.
fn fuse(eyes: [Option<f32>; 2], open_eye: [f32; 2]) -> Option<f32> {
    let [left, right] = open_eye;
    let relative = |eye: Option<f32>, open: f32| eye.map(|eye| (eye / open).min(1.0));
    match (relative(eyes[0], left), relative(eyes[1], right)) {
        (Some(a), Some(b)) => Some(0.5 * (a + b)),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eyes_are_fused() {
        let fused = |a, b| fuse([a, b], [1.0; 2]);
        assert_eq!(fused(None, None), None);
        assert_eq!(fused(Some(0.4), None), Some(0.4));
        assert_eq!(fused(Some(0.25), Some(0.75)), Some(0.5));
        assert_eq!(fuse([Some(0.8), None], [0.8, 1.0]), Some(1.0));
    }

    #[test]
    fn what_is_not_finite_is_unknown() {
        let config = MonitorConfig::default();
        let mut seen = Observation::NONE;
        (seen.state, seen.confidence, seen.eye_open) = (State::Tracking, 1.0, [1.0; 2]);
        let read = |seen: &Observation| Reading::new(seen, &Reading::NONE, [1.0; 2], &config);
        assert_eq!(read(&seen).openness, Some(1.0));
        let wrong: [fn(&mut Observation); 6] = [
            |seen| seen.confidence = f32::NAN,
            |seen| seen.yaw_deg = f32::INFINITY,
            |seen| seen.rotation_sigma_deg[1] = f32::NAN,
            |seen| seen.translation_mm[2] = f32::NAN,
            |seen| seen.eye_open = [f32::NAN, -1.0],
            |seen| seen.pitch_deg = 3e38,
        ];
        for change in wrong {
            let mut seen = seen;
            change(&mut seen);
            assert_eq!(read(&seen).openness, None, "{seen:?}");
        }
    }
}
