//! What a monitor knows now.

use super::config::ZonesBy;
use super::zone::{MAX_ZONES, ZoneState};

/// What the eyes do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum EyeState {
    /// It is not known.
    Unknown(UnknownReason),
    /// Open.
    Open,
    /// Closed, for the time of [`MonitorState::closure_us`].
    Closed,
}

impl EyeState {
    /// Its name in every table, as `open`.
    pub const fn name(self) -> &'static str {
        match self {
            EyeState::Unknown(_) => "unknown",
            EyeState::Open => "open",
            EyeState::Closed => "closed",
        }
    }

    /// Why it is unknown, if it is.
    pub const fn reason(self) -> Option<UnknownReason> {
        match self {
            EyeState::Unknown(reason) => Some(reason),
            EyeState::Open | EyeState::Closed => None,
        }
    }
}

/// Why the eyes are unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum UnknownReason {
    /// No face is tracked, or nothing was observed yet.
    #[default]
    NoFace,
    /// The confidence or the certainty of the pose is too low.
    LowConfidence,
    /// The head is turned away from the camera.
    Turned,
    /// The tracker sees neither eye: hidden, or moving too fast; or lids that seem shut may follow
    /// a lowered gaze.
    Hidden,
    /// The face that is seen is not at the driver's place.
    Elsewhere,
}

impl UnknownReason {
    /// Its name in every table, as `no-face`.
    pub const fn name(self) -> &'static str {
        match self {
            UnknownReason::NoFace => "no-face",
            UnknownReason::LowConfidence => "low-confidence",
            UnknownReason::Turned => "turned",
            UnknownReason::Hidden => "hidden",
            UnknownReason::Elsewhere => "elsewhere",
        }
    }

    /// `none` where the eyes are known, else the name of the reason.
    pub fn name_of(reason: Option<UnknownReason>) -> &'static str {
        reason.map_or("none", UnknownReason::name)
    }
}

/// How sleepy the driver is, by P80.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Drowsiness {
    /// Too little of the windows is known.
    #[default]
    Unknown,
    /// Both P80 are below [`super::MonitorConfig::awake_share`] of their thresholds.
    Awake,
    /// Between awake and drowsy.
    Questionable,
    /// A P80 has reached its threshold.
    Drowsy,
}

impl Drowsiness {
    /// Its name in every table, as `awake`.
    pub const fn name(self) -> &'static str {
        match self {
            Drowsiness::Unknown => "unknown",
            Drowsiness::Awake => "awake",
            Drowsiness::Questionable => "questionable",
            Drowsiness::Drowsy => "drowsy",
        }
    }
}

/// Measures of eye closure over a window of whole seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Perclos {
    /// Share of the known time with eyes closed by 70 % and more, 0..1.
    pub p70: f32,
    /// Share of the known time with eyes closed by 80 % and more, 0..1.
    pub p80: f32,
    /// Mean square of the closure over the known time, 0..1.
    pub em: f32,
    /// Share of the window in which the eyes were known, 0..1: low while the window fills.
    pub known: f32,
    /// Closures that ended in the window, blinks too.
    pub closures: u32,
    /// Their mean duration \[µs\], if there are any.
    pub mean_closure_us: Option<u32>,
}

/// What a monitor knows after an observation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MonitorState {
    /// Timestamp of the last observation \[µs\]; 0 before the first.
    pub timestamp_us: i64,
    /// What the eyes do.
    pub eyes: EyeState,
    /// Openness relative to this person's open eyes, both eyes together: 0 shut, 1 open.
    pub openness: Option<f32>,
    /// Known closed time of the closure that goes on \[µs\]; 0 without one.
    pub closure_us: u32,
    /// Measures over the last 60 whole seconds. They change once a second.
    pub perclos_60: Perclos,
    /// Measures over the last 180 whole seconds.
    pub perclos_180: Perclos,
    /// Blinks so far.
    pub blinks: u32,
    /// Yawns so far.
    pub yawns: u32,
    /// Nods so far.
    pub nods: u32,
    /// Known time for which the mouth has been open as in a yawn \[µs\]; 0 while it is shut.
    pub mouth_open_us: u32,
    /// Known time for which the eyes have looked down \[µs\]; 0 while they do not.
    pub look_down_us: u32,
    /// Where the driver looks.
    pub zone: ZoneState,
    /// What that is known by; `None` for an unknown zone.
    pub zone_by: Option<ZonesBy>,
    /// For how long without a break \[µs\].
    pub zone_us: u32,
    /// Known time away from the road in the glance that goes on \[µs\], less the grace of zones.
    pub away_us: u32,
    /// The same within the last 30 s \[µs\]: the current quarter of a second and the 119 before.
    pub away_30_us: u32,
    /// Known time in each zone so far \[µs\].
    pub zones_us: [u64; MAX_ZONES],
    /// Yaw and pitch of the face from the direction of the road \[deg\], where it is known.
    pub from_road_deg: Option<[f32; 2]>,
    /// The same of the gaze \[deg\].
    pub gaze_from_road_deg: Option<[f32; 2]>,
    /// Learnt offset of the natural pose in yaw and pitch \[deg\] from the configured road.
    pub natural_deg: [f32; 2],
    /// Whether it is final. Until a first estimate, after ten seconds, zones are unknown.
    pub natural_is_final: bool,
    /// Learnt offset of the gaze that is on the road, likewise.
    pub natural_gaze_deg: [f32; 2],
    /// Whether that is final. Until a first estimate, after ten seconds of known gaze, zones are
    /// met by the head.
    pub natural_gaze_is_final: bool,
    /// Openness of this person's open left and right eye, as the tracker reports it.
    pub open_eye: [f32; 2],
    /// Whether it is learnt, and so frozen; before, it is 1.
    pub open_eye_is_final: bool,
    /// The driver's place: midway between the eyes, camera frame \[mm\], where it is known.
    pub place_mm: Option<[f32; 3]>,
    /// Whether it is held, whoever is seen elsewhere.
    pub place_is_final: bool,
    /// How sleepy the driver is.
    pub drowsiness: Drowsiness,
    /// Eyes have been unknown for longer than [`super::MonitorConfig::degraded_us`].
    pub degraded: bool,
}
