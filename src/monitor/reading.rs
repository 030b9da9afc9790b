//! What of an observation is known.

use super::closure::Lids;
use super::config::MonitorConfig;
use super::natural::is_learnt;
use super::observation::Observation;
use super::place::Seat;
use super::state::UnknownReason;
use crate::math::{HeadAngles, towards};
use crate::shape::{FARTHEST_MM, Pose};
use crate::track::State;
use glam::Vec3;

/// Largest standard deviation of an angle of a known pose \[deg\]. Chosen: the whole width of the
/// road in the default zones. Without intrinsics a face at the frame's corner has 14°; a profile of
/// which nothing is visible has 20° at a confidence of 0.5.
const MOST_SIGMA_DEG: f32 = 30.0;
/// Standard deviation of a gaze that comes without one, and the largest of a known gaze \[deg\].
/// Chosen: below that of the tracker's, and half of the width of the road in the default zones.
const USUAL_GAZE_SIGMA_DEG: f32 = 5.0;
const MOST_GAZE_SIGMA_DEG: f32 = 15.0;
/// Largest angle of a head \[deg\].
const MOST_DEG: f32 = 180.0;
/// How much less the head must be turned for eyes to be known again \[deg\].
const TURNED_MARGIN_DEG: f32 = 3.0;

/// The known part of an observation.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    /// Openness of both eyes together, relative to this person's open eyes; or why it is unknown.
    pub(super) openness: Result<f32, UnknownReason>,
    /// See [`Observation::may_look_down`].
    pub(super) may_look_down: bool,
    /// Openness of each eye, as the tracker reports it; for a known openness.
    pub(super) eyes: [Option<f32>; 2],
    /// Openness of the jaw.
    pub(super) jaw: Option<f32>,
    /// Where a face is, the driver's or another one \[mm\].
    pub(super) at_mm: Option<Vec3>,
    /// Where the head is and where it is turned to.
    pub(super) pose: Option<HeadPose>,
    /// Yaw and pitch of the gaze, of the kind of [`HeadPose::turn_deg`] \[deg\].
    pub(super) gaze_deg: Option<[f32; 2]>,
    /// Its standard deviation \[deg\].
    pub(super) gaze_sigma_deg: f32,
}

/// Where a head is and where it is turned to.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeadPose {
    /// Yaw and pitch that zones of angles compare \[deg\]: relative to the camera's axes, or to the
    /// line of sight where the focal length is assumed.
    pub(super) turn_deg: [f32; 2],
    /// Yaw and pitch relative to the line of sight \[deg\].
    facing_deg: [f32; 2],
    /// Camera frame \[mm\].
    pub(super) origin_mm: Vec3,
    /// Whether `turn_deg` is relative to the line of sight.
    is_facing: bool,
}

impl HeadPose {
    /// Pitch of `turn_deg`.
    pub(super) fn pitch_deg(&self) -> f32 {
        let [_, pitch] = self.turn_deg;
        pitch
    }

    /// Yaw and pitch \[deg\], of the kind of `turn_deg`, of a unit direction in the camera frame;
    /// `None` for what is none.
    fn angles_of(&self, direction: Vec3) -> Option<[f32; 2]> {
        let ray = match self.is_facing {
            true => towards(self.origin_mm).transpose() * direction,
            false => direction,
        };
        let yaw = libm::atan2f(ray.x, -ray.z).to_degrees();
        let pitch = libm::asinf((-ray.y).clamp(-1.0, 1.0)).to_degrees();
        // No comparison holds for a NaN.
        let is_unit = (ray.length_squared() - 1.0).abs() < 0.1;
        is_unit.then_some([yaw, pitch])
    }

    /// The unit direction of these angles, of the kind of `turn_deg`, in the camera frame.
    pub(super) fn ray(&self, yaw_deg: f32, pitch_deg: f32) -> Vec3 {
        // Where a nose of this yaw and pitch points; see `math::rotation`.
        let (yaw, pitch) = (yaw_deg.to_radians(), pitch_deg.to_radians());
        let level = libm::cosf(pitch);
        let ray = Vec3::new(
            level * libm::sinf(yaw),
            -libm::sinf(pitch),
            -level * libm::cosf(yaw),
        );
        match self.is_facing {
            true => towards(self.origin_mm) * ray,
            false => ray,
        }
    }
}

impl Reading {
    /// Nothing is known.
    pub(super) const NONE: Reading = Reading {
        openness: Err(UnknownReason::NoFace),
        may_look_down: false,
        eyes: [None; 2],
        jaw: None,
        at_mm: None,
        pose: None,
        gaze_deg: None,
        gaze_sigma_deg: 0.0,
    };

    /// How the lids are, if they seem shut.
    pub(super) fn lids(&self) -> Lids {
        match self.eyes {
            _ if self.openness.is_err() => Lids::Unknown,
            _ if self.may_look_down => Lids::MayLookDown,
            _ if self.gaze_deg.is_some() => Lids::WithGaze,
            [Some(_), Some(_)] => Lids::Shut,
            _ => Lids::OneShut,
        }
    }

    /// How far the gaze is lowered in the head \[deg\], where it is known.
    pub(super) fn lowered_deg(&self) -> Option<f32> {
        let ([_, gaze], pose) = (self.gaze_deg?, self.pose?);
        Some(pose.pitch_deg() - gaze)
    }

    pub(super) fn new(
        seen: &Observation,
        last: &Reading,
        open_eye: [f32; 2],
        seat: &Seat,
        config: &MonitorConfig,
    ) -> Reading {
        let unknown = |reason| Reading {
            openness: Err(reason),
            ..Reading::NONE
        };
        if seen.state != State::Tracking {
            return unknown(UnknownReason::NoFace);
        }
        let Some(pose) = known_pose(seen, config) else {
            return unknown(UnknownReason::LowConfidence);
        };
        let at_mm = Some(pose.origin_mm);
        if seat.is_elsewhere(pose.origin_mm, config) {
            return Reading {
                at_mm,
                ..unknown(UnknownReason::Elsewhere)
            };
        }
        let reading = Reading {
            at_mm,
            pose: Some(pose),
            ..Reading::NONE
        };
        let [yaw, pitch] = pose.facing_deg;
        let margin = match last.openness {
            Err(UnknownReason::Turned) => TURNED_MARGIN_DEG,
            _ => 0.0,
        };
        if yaw.abs() > config.eye_yaw_deg - margin || pitch.abs() > config.eye_pitch_deg - margin {
            return Reading {
                openness: Err(UnknownReason::Turned),
                ..reading
            };
        }
        let gaze_sigma_deg = match seen.gaze_sigma_deg {
            sigma if sigma > 0.0 => sigma,
            _ => USUAL_GAZE_SIGMA_DEG,
        };
        let is_sure = gaze_sigma_deg <= MOST_GAZE_SIGMA_DEG;
        let is_share = |v: &f32| (0.0..=1.0).contains(v);
        let eyes = seen.eye_open.map(|open| open.filter(is_share));
        Reading {
            openness: fuse(eyes, open_eye).ok_or(UnknownReason::Hidden),
            may_look_down: seen.may_look_down,
            eyes,
            jaw: seen.jaw_open.filter(is_share),
            gaze_deg: (seen.gaze.filter(|_| is_sure)).and_then(|gaze| pose.angles_of(gaze.into())),
            gaze_sigma_deg,
            ..reading
        }
    }
}

/// Pose of the head, if it is certain.
fn known_pose(seen: &Observation, config: &MonitorConfig) -> Option<HeadPose> {
    let angles = [seen.yaw_deg, seen.pitch_deg];
    // No comparison holds for a NaN.
    let is_certain = |sigma: &f32| (0.0..=MOST_SIGMA_DEG).contains(sigma);
    let is_known = seen.confidence >= config.min_confidence
        && angles.iter().all(|angle| angle.abs() <= MOST_DEG)
        && seen.translation_mm.iter().all(|v| v.abs() <= FARTHEST_MM)
        && seen.rotation_sigma_deg.iter().all(is_certain);
    if !is_known {
        return None;
    }
    // The roll changes neither the nose's direction nor these angles.
    let angles = HeadAngles {
        yaw_deg: seen.yaw_deg,
        pitch_deg: seen.pitch_deg,
        roll_deg: 0.0,
    };
    let pose = Pose::of_angles(angles, seen.translation_mm.into());
    let facing = pose.facing_angles();
    let facing_deg = [facing.yaw_deg, facing.pitch_deg];
    // A road that is given is relative to the camera's axes.
    let is_facing = seen.camera_assumed && is_learnt(config);
    Some(HeadPose {
        turn_deg: match is_facing {
            true => facing_deg,
            false => [seen.yaw_deg, seen.pitch_deg],
        },
        facing_deg,
        origin_mm: pose.translation_mm,
        is_facing,
    })
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
        (seen.state, seen.confidence, seen.eye_open) = (State::Tracking, 1.0, [Some(1.0); 2]);
        let read =
            |seen: &Observation| Reading::new(seen, &Reading::NONE, [1.0; 2], &Seat::NEW, &config);
        assert_eq!(read(&seen).openness, Ok(1.0));
        let wrong: [fn(&mut Observation); 6] = [
            |seen| seen.confidence = f32::NAN,
            |seen| seen.yaw_deg = f32::INFINITY,
            |seen| seen.rotation_sigma_deg[1] = f32::NAN,
            |seen| seen.translation_mm[2] = f32::NAN,
            |seen| seen.eye_open = [Some(f32::NAN), Some(-1.0)],
            |seen| seen.pitch_deg = 3e38,
        ];
        for change in wrong {
            let mut seen = seen;
            change(&mut seen);
            assert!(read(&seen).openness.is_err(), "{seen:?}");
        }
    }
}
