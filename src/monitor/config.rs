//! Settings of a monitor.

use crate::shape::FARTHEST_MM;

/// What the zones are met by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ZonesBy {
    /// By the gaze where it is known, by the head where it is not, whose turn from the road then
    /// counts one and a half times.
    #[default]
    Gaze,
    /// By the head as it is turned, but by the gaze while the eyes look down.
    Head,
}

impl ZonesBy {
    /// Its name in every table, as `gaze`.
    pub const fn name(self) -> &'static str {
        match self {
            ZonesBy::Gaze => "gaze",
            ZonesBy::Head => "head",
        }
    }

    /// `none`, or its name.
    pub fn name_of(by: Option<ZonesBy>) -> &'static str {
        by.map_or("none", ZonesBy::name)
    }
}

/// Whose face is the driver's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Place {
    /// That at the place where most of the first minute a face is seen.
    #[default]
    Learnt,
    /// That at [`MonitorConfig::place_mm`].
    Given,
    /// Every face.
    Any,
}

/// Settings. Times are in µs, at most 71 minutes. Every value has its source beside it in
/// [`super::Preset`]; a preset sets them all.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct MonitorConfig {
    /// How long an observation counts when no other follows, and how long closures, yawns, nods and
    /// glances go on while what they need is unknown. 100,000 to 2,000,000.
    pub gap_us: u32,
    /// Least confidence of a face that is observed, 0..1.
    pub min_confidence: f32,
    /// Largest |yaw| relative to the line of sight at which eyes and mouth are known \[deg\],
    /// 10..90.
    pub eye_yaw_deg: f32,
    /// Largest |pitch| relative to the line of sight at which eyes and mouth are known \[deg\],
    /// 10..90.
    pub eye_pitch_deg: f32,
    /// Eyes close below this openness, 0.05..0.9.
    pub closed_below: f32,
    /// They open above this one, which is larger; up to 0.95.
    pub open_above: f32,
    /// Shorter closures are not counted.
    pub blink_us: u32,
    /// A longer closure is no blink.
    pub long_closure_us: u32,
    /// A closure of this length is a microsleep.
    pub microsleep_us: u32,
    /// A closure of this length is sleep.
    pub sleep_us: u32,
    /// A closure of this length is an unresponsive driver.
    pub unresponsive_us: u32,
    /// Drowsy from this P80 over 60 s, 0.01..1.
    pub drowsy_p80_60: f32,
    /// Drowsy from this P80 over 180 s, 0.01..1.
    pub drowsy_p80_180: f32,
    /// Awake again below this share of both, 0.1..1.
    pub awake_share: f32,
    /// Least share of a window that must be known for a P80 to decide, 0.05..1.
    pub min_known: f32,
    /// The mouth opens for a yawn above this `jawOpen`, 0.05..0.95.
    pub yawn_above: f32,
    /// It shuts below this one, which is smaller.
    pub yawn_below: f32,
    /// Shortest yawn.
    pub yawn_us: u32,
    /// A mouth that is open for longer does not yawn.
    pub yawn_max_us: u32,
    /// Drop of the head's pitch within a second that begins a nod \[deg\], 5..60.
    pub nod_deg: f32,
    /// The head is up again within this time.
    pub nod_us: u32,
    /// Eyes look down when their gaze is lowered from the road by this \[deg\], 10..60.
    pub look_down_deg: f32,
    /// A look down of this length is reported.
    pub look_down_us: u32,
    /// Direction of the road in the camera frame, as the yaw of a face that looks there \[deg\].
    pub forward_yaw_deg: f32,
    /// As its pitch \[deg\].
    pub forward_pitch_deg: f32,
    /// How far the natural pose may lie from there in yaw \[deg\], 0..50; 0 does not learn it.
    pub natural_yaw_deg: f32,
    /// As for yaw, in pitch \[deg\], 0..30.
    pub natural_pitch_deg: f32,
    /// A zone is left when the direction is farther outside than this \[deg\], 0..15, and a quarter
    /// of its standard deviation.
    pub zone_margin_deg: f32,
    /// What zones are met by.
    pub zones_by: ZonesBy,
    /// How much farther eyes have turned in the head than a gaze says, for zones, 1..2: what
    /// networks find falls short. What it is above 1 counts three times below the head.
    pub gaze_gain: f32,
    /// Whose face is the driver's; another one is no face that is observed.
    pub place: Place,
    /// The driver's place for [`Place::Given`]: midway between the eyes, camera frame \[mm\].
    pub place_mm: [f32; 3],
    /// How far from the place the driver's face may be \[mm\], 100..1000.
    pub place_radius_mm: f32,
    /// A glance away from the road of this length is long.
    pub long_glance_us: u32,
    /// Time away from the road within 30 s that is too long; at most 30 s.
    pub cumulative_us: u32,
    /// Time on the road that ends a glance.
    pub return_us: u32,
    /// Time on the road that clears the time away.
    pub clear_us: u32,
    /// Eyes that are unknown for this long are reported.
    pub degraded_us: u32,
}

/// A setting of a monitor that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MonitorConfigError {
    /// A time, or the order of the times of a closure or a yawn.
    Time,
    /// A threshold, or the order of two.
    Threshold,
    /// An angle, or the driver's place.
    Angle,
    /// More than [`super::MAX_ZONES`] zones, or numbers that are no zone.
    Zone,
}

impl core::fmt::Display for MonitorConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            MonitorConfigError::Time => "a time of the monitor is out of range or out of order",
            MonitorConfigError::Threshold => "a threshold of the monitor is out of range",
            MonitorConfigError::Angle => "an angle or place of the monitor is out of range",
            MonitorConfigError::Zone => "more than 8 zones, or one whose numbers are no zone",
        })
    }
}

impl core::error::Error for MonitorConfigError {}

/// Length of the window of [`MonitorConfig::cumulative_us`] \[µs\]: that of Euro NCAP, as
/// [`super::Preset`] has it.
pub(super) const CUMULATIVE_WINDOW_US: u32 = 30_000_000;

impl MonitorConfig {
    /// Whether every setting is in its range.
    pub fn check(&self) -> Result<(), MonitorConfigError> {
        if !self.has_times() {
            return Err(MonitorConfigError::Time);
        }
        if !self.has_thresholds() {
            return Err(MonitorConfigError::Threshold);
        }
        if !self.has_angles() {
            return Err(MonitorConfigError::Angle);
        }
        Ok(())
    }

    fn has_times(&self) -> bool {
        (100_000..=2_000_000).contains(&self.gap_us)
            && self.blink_us < self.long_closure_us
            && self.long_closure_us < self.microsleep_us
            && self.microsleep_us < self.sleep_us
            && self.sleep_us < self.unresponsive_us
            && self.yawn_us < self.yawn_max_us
            && self.nod_us >= 1_000_000
            && self.look_down_us > 0
            && self.long_glance_us > 0
            && (1..=CUMULATIVE_WINDOW_US).contains(&self.cumulative_us)
            && self.return_us <= self.clear_us
            && self.degraded_us > 0
    }

    /// No comparison holds for a NaN.
    fn has_thresholds(&self) -> bool {
        let shares = [self.drowsy_p80_60, self.drowsy_p80_180];
        (0.0..=1.0).contains(&self.min_confidence)
            && self.closed_below >= 0.05
            && self.closed_below < self.open_above
            && self.open_above <= 0.95
            && shares.iter().all(|share| (0.01..=1.0).contains(share))
            && (0.1..=1.0).contains(&self.awake_share)
            && (0.05..=1.0).contains(&self.min_known)
            && self.yawn_below >= 0.0
            && self.yawn_below < self.yawn_above
            && (0.05..=0.95).contains(&self.yawn_above)
    }

    fn has_angles(&self) -> bool {
        (10.0..=90.0).contains(&self.eye_yaw_deg)
            && (10.0..=90.0).contains(&self.eye_pitch_deg)
            && (5.0..=60.0).contains(&self.nod_deg)
            && (10.0..=60.0).contains(&self.look_down_deg)
            && self.forward_yaw_deg.abs() <= 90.0
            && self.forward_pitch_deg.abs() <= 60.0
            && (0.0..=50.0).contains(&self.natural_yaw_deg)
            && (0.0..=30.0).contains(&self.natural_pitch_deg)
            && (0.0..=15.0).contains(&self.zone_margin_deg)
            && (1.0..=2.0).contains(&self.gaze_gain)
            && (100.0..=1000.0).contains(&self.place_radius_mm)
            && self.place_mm.iter().all(|v| v.abs() <= FARTHEST_MM)
    }
}
