//! Settings and zones for the rules that they follow.

use super::config::{MonitorConfig, Place, ZonesBy};
use super::zone::{Zone, ZoneShape};

/// A rule whose times and thresholds a monitor takes. None of them makes a system that is approved
/// by it: the rules demand more than a monitor of heads, lids and gazes can give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Preset {
    /// No rule: the values of [`Preset::EuroNcap`] with the 15 % of P80 over 60 s that Wierwille
    /// (1994) and NSTSCE 25-UI-177 (2026) have.
    #[default]
    General,
    /// Euro NCAP 2026, driver state monitoring: a glance of 3 to 4 s is long; 10 s within 30 s are
    /// too long and are cleared by 2 s on the road; microsleep 1 to 2 s, sleep from 3 s,
    /// unresponsive from 6 s of closed eyes; a degraded system is reported within 10 s.
    EuroNcap,
    /// Regulation (EU) 2023/2590 (ADDW) above 50 km/h: gaze in area 3, below a plane 30° down, for
    /// more than 3.5 s. Only that area counts as away from the road.
    EuAddwFast,
    /// The same from 20 to 50 km/h: 6 s.
    EuAddwSlow,
    /// Regulation (EU) 2021/1341 (DDAW), whose measure is a sleepiness of 8 on the Karolinska
    /// scale. It names no P80: 12 % over 60 s and over 180 s are the warning level of the field
    /// test of NHTSA and VTTI (DOT HS 811 117).
    EuDdaw,
}

impl Preset {
    /// Every preset.
    pub const ALL: [Preset; 5] = [
        Preset::General,
        Preset::EuroNcap,
        Preset::EuAddwFast,
        Preset::EuAddwSlow,
        Preset::EuDdaw,
    ];

    /// Its name in every table and language, as `euro-ncap`.
    pub const fn name(self) -> &'static str {
        match self {
            Preset::General => "general",
            Preset::EuroNcap => "euro-ncap",
            Preset::EuAddwFast => "eu-addw-fast",
            Preset::EuAddwSlow => "eu-addw-slow",
            Preset::EuDdaw => "eu-ddaw",
        }
    }

    /// Its settings.
    pub const fn config(self) -> MonitorConfig {
        match self {
            Preset::General | Preset::EuroNcap => GENERAL,
            Preset::EuAddwFast => MonitorConfig {
                long_glance_us: 3_500_000,
                ..GENERAL
            },
            Preset::EuAddwSlow => MonitorConfig {
                long_glance_us: 6_000_000,
                ..GENERAL
            },
            Preset::EuDdaw => MonitorConfig {
                drowsy_p80_60: 0.12,
                ..GENERAL
            },
        }
    }

    /// Its zones, relative to the direction of the road; the same for both sides of the car.
    pub const fn zones(self) -> &'static [Zone] {
        match self {
            Preset::EuAddwFast | Preset::EuAddwSlow => &ADDW,
            _ => &ZONES,
        }
    }
}

impl Default for MonitorConfig {
    fn default() -> Self {
        Preset::default().config()
    }
}

const GENERAL: MonitorConfig = MonitorConfig {
    // Arbiters of driver monitors bridge gaps of 0.3 s.
    gap_us: 300_000,
    // Chosen: a tracked face has 0.95 and more in nearly all frames.
    min_confidence: 0.5,
    // Chosen: the tracker's yaw is up to 4° too small beyond 60°, and no eye may count there.
    eye_yaw_deg: 50.0,
    eye_pitch_deg: 40.0,
    // Rendered clips: 0.3, the limit of P70, misses eyes behind glasses that are read too open; up
    // to 0.35 next to no open ones are below.
    closed_below: 0.35,
    open_above: 0.45,
    // A blink takes 100 to 400 ms, in alert people 111 ± 51 ms.
    blink_us: 50_000,
    long_closure_us: 500_000,
    // Euro NCAP.
    microsleep_us: 1_000_000,
    sleep_us: 3_000_000,
    unresponsive_us: 6_000_000,
    // Wierwille 1994 and NSTSCE 25-UI-177 over 60 s; NHTSA and VTTI, DOT HS 811 117, over 180 s.
    drowsy_p80_60: 0.15,
    drowsy_p80_180: 0.12,
    // Wierwille 1994: awake below 7.5 %, drowsy above 15 %.
    awake_share: 0.5,
    // Chosen.
    min_known: 0.5,
    // A mouth ratio above 0.5 to 0.6 for 1.5 to 12 s; `jawOpen` is 1 for the widest mouth.
    yawn_above: 0.5,
    yawn_below: 0.35,
    yawn_us: 1_500_000,
    yawn_max_us: 12_000_000,
    // 12 to 20° within a second, back within 3 s.
    nod_deg: 12.0,
    nod_us: 3_000_000,
    // Chosen: below the windscreen. Instruments are 25° down, a telephone on the lap 50°.
    look_down_deg: 18.0,
    look_down_us: 500_000,
    // A camera straight ahead, or anywhere within the bounds of the natural pose.
    forward_yaw_deg: 0.0,
    forward_pitch_deg: 0.0,
    // Cameras stand up to 40° off the driver's axis.
    natural_yaw_deg: 45.0,
    natural_pitch_deg: 25.0,
    // Chosen: three times the tracker's error of yaw and pitch.
    zone_margin_deg: 3.0,
    zones_by: ZonesBy::Gaze,
    // Rendered glances with the eyes alone: 0.4 to 1.1 of the turn is found, mostly about 0.7.
    gaze_gain: 1.3,
    // Chosen: half way to the seat beside, which is 60 cm away.
    place: Place::Learnt,
    place_mm: [0.0; 3],
    place_radius_mm: 300.0,
    // Euro NCAP: 3 to 4 s; 10 s of 30; cleared after 2 s on the road.
    long_glance_us: 3_000_000,
    cumulative_us: 10_000_000,
    return_us: 300_000,
    clear_us: 2_000_000,
    // Euro NCAP: a degraded system is reported within 10 s.
    degraded_us: 10_000_000,
};

/// An angular zone: yaw and pitch from the road \[deg\], and the grace \[µs\].
const fn angles(yaw: [f32; 2], pitch: [f32; 2], is_road: bool, grace_us: u32) -> Zone {
    Zone {
        shape: ZoneShape::Angles {
            yaw_deg: yaw,
            pitch_deg: pitch,
        },
        is_road,
        grace_us,
    }
}

/// Glances at mirrors and instruments below a second are part of driving.
const MIRROR_US: u32 = 1_000_000;
/// Beyond any angle \[deg\].
const ALL: f32 = 180.0;

/// Mirrors are at 29° to 46° of gaze, instruments at 25° down, the lap at 50° down. Each zone
/// begins half way, so that it also holds a head that went only half of the way.
const ZONES: [Zone; 8] = [
    // 0 road: windscreen.
    angles([-15.0, 15.0], [-12.0, 12.0], true, 0),
    // 1 lap: telephone, floor.
    angles([-50.0, 50.0], [-ALL, -25.0], false, 0),
    // 2 instruments.
    angles([-15.0, 15.0], [-25.0, -12.0], false, MIRROR_US),
    // 3, 4 image right and left: mirrors, centre console, side windows.
    angles([15.0, 50.0], [-25.0, ALL], false, MIRROR_US),
    angles([-50.0, -15.0], [-25.0, ALL], false, MIRROR_US),
    // 5 roof.
    angles([-15.0, 15.0], [12.0, ALL], false, MIRROR_US),
    // 6, 7 over the shoulder, passenger.
    angles([50.0, ALL], [-ALL, ALL], false, MIRROR_US),
    angles([-ALL, -50.0], [-ALL, ALL], false, MIRROR_US),
];

/// The areas of Regulation (EU) 2023/2590. Only area 3 has times.
const ADDW: [Zone; 3] = [
    // 0: areas 1 and 2 but for what lies beyond ±55°: windscreen, windows, roof.
    angles([-55.0, 55.0], [-30.0, ALL], true, 0),
    // 1: area 3, below a plane 30° down.
    angles([-ALL, ALL], [-ALL, -30.0], false, 0),
    // 2: area 1 beyond ±55°, which the regulation does not time.
    angles([-ALL, ALL], [-30.0, ALL], false, u32::MAX),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_in_range() {
        for preset in Preset::ALL {
            assert_eq!(preset.config().check(), Ok(()), "{preset:?}");
            assert!(preset.zones().iter().all(|zone| zone.is_valid()));
            assert_eq!(preset.zones().iter().filter(|zone| zone.is_road).count(), 1);
        }
    }
}
