//! What the zones are met by: the gaze where it is known, the head where it is not.
//!
//! Zones are places that a gaze goes to. A head goes only part of that way, so where the gaze is
//! unknown, the head's turn from the road counts [`HEAD_GAIN`] times, and for as uncertain as such
//! a guess is. With [`ZonesBy::Head`] it counts as it is.

use super::config::{MonitorConfig, ZonesBy};
use super::natural::Natural;
use super::reading::{HeadPose, Reading};
use super::zone::{Direction, ZoneState, Zones};

/// How much farther from the road a gaze is than its head. Chosen: of the way to mirrors and
/// instruments heads go half to three quarters.
const HEAD_GAIN: f32 = 1.5;
/// Standard deviation of a gaze that is guessed so \[deg\]. Chosen: a head leaves the road of the
/// default zones at 15°.
const HEAD_SIGMA_DEG: f32 = 15.0;
/// Largest angle from the road \[deg\].
const MOST_DEG: f32 = 180.0;
/// Part of a direction's standard deviation that is added to the margin by which it must be outside
/// of a zone to leave it. Chosen.
const WIDER: f32 = 0.25;
/// For how long a gaze is outside of a zone before it has left it \[µs\]. No glance is shorter than
/// 120 ms (ISO 15007); saccades, lids that begin to fall and single wrong gazes are.
const DWELL_US: u32 = 80_000;
/// How many times the gain counts for eyes that look lower than the head: lids hide what tells how
/// far, so that of such turns 0.3 to 0.9 is found, mostly half. Chosen on rendered glances.
const LOWERED: f32 = 3.0;

/// Where head and gaze of an observation are turned to, if the road is known.
#[derive(Clone, Copy)]
pub(super) struct Directions {
    /// Yaw and pitch of both from the road \[deg\].
    pub(super) head_deg: Option<[f32; 2]>,
    pub(super) gaze_deg: Option<[f32; 2]>,
    /// What zones are met by where the gaze counts, and where the head does.
    pub(super) by_gaze: Option<Direction>,
    by_head: Option<Direction>,
}

impl Directions {
    pub(super) const NONE: Directions = Directions {
        head_deg: None,
        gaze_deg: None,
        by_gaze: None,
        by_head: None,
    };

    /// Of a reading, by what is learnt of this person's head and gaze.
    pub(super) fn new(
        reading: &Reading,
        of_head: &Natural,
        of_gaze: &Natural,
        config: &MonitorConfig,
    ) -> Directions {
        let Some(pose) = &reading.pose else {
            return Directions::NONE;
        };
        // Until its own road is known, a gaze is measured from that of the head.
        let is_by_gaze = config.zones_by == ZonesBy::Gaze;
        let has_own_road = is_by_gaze && of_gaze.is_known_beside(of_head, config);
        let is_head_known = of_head.is_known(config);
        let (gaze_road, is_gaze_known) = match has_own_road {
            true => (of_gaze, true),
            false => (of_head, is_head_known),
        };
        let head_deg = is_head_known.then(|| from_road(pose.turn_deg, of_head, config));
        let gaze_deg = reading.gaze_deg.filter(|_| is_gaze_known);
        let gaze_deg = gaze_deg.map(|at_deg| from_road(at_deg, gaze_road, config));
        let (by_gaze, by_head) = match is_by_gaze {
            true => (
                gaze_deg
                    .filter(|_| has_own_road)
                    .map(|gaze| farther(gaze, head_deg, config.gaze_gain))
                    .map(|at_deg| direction(at_deg, reading.gaze_sigma_deg, pose, config)),
                head_deg
                    .map(|turn| turn.map(|angle| HEAD_GAIN * angle))
                    .map(|at_deg| direction(at_deg, HEAD_SIGMA_DEG, pose, config)),
            ),
            false => (
                gaze_deg.map(|at_deg| direction(at_deg, 0.0, pose, config)),
                head_deg.map(|at_deg| direction(at_deg, 0.0, pose, config)),
            ),
        };
        Directions {
            head_deg,
            gaze_deg,
            by_gaze,
            by_head,
        }
    }
}

/// Yaw and pitch from the road without what is this person's own \[deg\].
fn from_road([yaw, pitch]: [f32; 2], natural: &Natural, config: &MonitorConfig) -> [f32; 2] {
    let [more_yaw, more_pitch] = natural.offset_deg();
    [
        yaw - more_yaw - config.forward_yaw_deg,
        pitch - more_pitch - config.forward_pitch_deg,
    ]
}

/// A gaze whose eyes have turned farther in the head than it is found \[deg\].
fn farther([yaw, pitch]: [f32; 2], head_deg: Option<[f32; 2]>, gain: f32) -> [f32; 2] {
    let [head_yaw, head_pitch] = head_deg.unwrap_or([yaw, pitch]);
    let more = gain - 1.0;
    let (aside, up) = (yaw - head_yaw, pitch - head_pitch);
    let more_up = match up < 0.0 {
        true => LOWERED * more,
        false => more,
    };
    [yaw + more * aside, pitch + more_up * up]
}

/// The direction that zones are set for, of these angles from the road \[deg\].
fn direction(
    at_deg: [f32; 2],
    sigma_deg: f32,
    pose: &HeadPose,
    config: &MonitorConfig,
) -> Direction {
    let [yaw_deg, pitch_deg] = at_deg.map(|angle| angle.clamp(-MOST_DEG, MOST_DEG));
    let (forward_yaw, forward_pitch) = (config.forward_yaw_deg, config.forward_pitch_deg);
    Direction {
        yaw_deg,
        pitch_deg,
        origin_mm: pose.origin_mm,
        ray: pose.ray(yaw_deg + forward_yaw, pitch_deg + forward_pitch),
        sigma_deg,
    }
}

/// What the zone is met by, and for how long it has been otherwise.
#[derive(Clone)]
pub(super) struct Aim {
    pub(super) by: Option<ZonesBy>,
    /// Known time for which the gaze has been outside of the zone, if it is \[µs\].
    outside_us: Option<u32>,
    /// Time for which the gaze has been unknown \[µs\].
    unknown_us: u32,
}

impl Aim {
    pub(super) const NONE: Aim = Aim {
        by: None,
        outside_us: None,
        unknown_us: 0,
    };

    /// Lets time pass with a gaze that is known or not.
    pub(super) fn pass(&mut self, time_us: u32, is_known: bool) {
        if !is_known {
            self.unknown_us = self.unknown_us.saturating_add(time_us);
        } else if let Some(outside_us) = &mut self.outside_us {
            *outside_us = outside_us.saturating_add(time_us);
        }
    }

    /// The zone of new directions after the last one. `is_lowered`: the eyes look down.
    pub(super) fn see(
        &mut self,
        to: &Directions,
        is_lowered: bool,
        zones: &Zones,
        last: ZoneState,
        config: &MonitorConfig,
    ) -> ZoneState {
        let is_by_gaze = config.zones_by == ZonesBy::Gaze;
        let gaze = to.by_gaze.filter(|_| is_by_gaze || is_lowered);
        if gaze.is_some() {
            self.unknown_us = 0;
        }
        // A gaze is awaited for as long as a blink takes, and one elsewhere for a moment.
        let is_held = is_by_gaze && self.by == Some(ZonesBy::Gaze) && last != ZoneState::Unknown;
        let (at, by) = match (gaze, to.by_head) {
            (Some(gaze), _) => (gaze, ZonesBy::Gaze),
            (None, Some(_)) if is_held && self.unknown_us <= config.gap_us => return last,
            (None, Some(head)) => (head, ZonesBy::Head),
            (None, None) => {
                self.by = None;
                return ZoneState::Unknown;
            }
        };
        let zone = zones.at(&at, last, config.zone_margin_deg + WIDER * at.sigma_deg);
        if zone != last && is_held && by == ZonesBy::Gaze {
            let outside_us = self.outside_us.get_or_insert(0);
            if *outside_us < DWELL_US {
                return last;
            }
        }
        (self.outside_us, self.by) = (None, Some(by));
        zone
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eyes_that_look_down_have_turned_farther() {
        let head = Some([10.0, -5.0]);
        let near = |a: [f32; 2], b: [f32; 2]| {
            assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-3, "{a:?}");
        };
        near(farther([20.0, 5.0], head, 1.3), [23.0, 8.0]);
        near(farther([0.0, -15.0], head, 1.3), [-3.0, -24.0]);
        near(farther([0.0, -15.0], head, 1.0), [0.0, -15.0]);
        near(farther([0.0, -15.0], None, 1.3), [0.0, -15.0]);
    }
}
