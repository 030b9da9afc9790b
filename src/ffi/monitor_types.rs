//! Constants and structs of the driver monitor, in the order in which the header shows them. As for
//! `types`, the comments are written for the C reader.

use super::types::assert_no_padding;

/// Most memory of a monitor \[bytes\].
pub const POSEWISE_MONITOR_SIZE: u32 = 8 * 1024;
/// Unread events that a monitor keeps.
pub const POSEWISE_MONITOR_EVENTS: u32 = 24;
/// Most zones of a monitor.
pub const POSEWISE_MONITOR_ZONES: u32 = 8;
/// Flag: the road is where the settings say.
pub const POSEWISE_MONITOR_FIXED_POSE: u32 = 1;
/// Flag of an event: it ended unseen.
pub const POSEWISE_MONITOR_CUT: u32 = 1;

/// Euro NCAP's times, P80 of Wierwille 1994.
pub const POSEWISE_MONITOR_PRESET_GENERAL: u32 = 0;
/// Euro NCAP 2026, driver state monitoring.
pub const POSEWISE_MONITOR_PRESET_EURO_NCAP: u32 = 1;
/// Reg. (EU) 2023/2590 above 50 km/h: 3.5 s.
pub const POSEWISE_MONITOR_PRESET_EU_ADDW_FAST: u32 = 2;
/// Reg. (EU) 2023/2590, 20..50 km/h: 6 s.
pub const POSEWISE_MONITOR_PRESET_EU_ADDW_SLOW: u32 = 3;
/// Reg. (EU) 2021/1341; P80 of DOT HS 811 117.
pub const POSEWISE_MONITOR_PRESET_EU_DDAW: u32 = 4;

/// yaw min, max, pitch min, max \[deg\].
pub const POSEWISE_MONITOR_ZONE_ANGLES: u32 = 0;
/// min x, y, z, max x, y, z \[mm\].
pub const POSEWISE_MONITOR_ZONE_BOX: u32 = 1;
/// Centre, half side u, half side v \[mm\].
pub const POSEWISE_MONITOR_ZONE_PLANE: u32 = 2;
/// Of a state: the direction meets no zone.
pub const POSEWISE_MONITOR_ZONE_OUTSIDE: u32 = 254;
/// Of a state: the direction is unknown.
pub const POSEWISE_MONITOR_ZONE_UNKNOWN: u32 = 255;
/// Flag of a zone: it is the road.
pub const POSEWISE_MONITOR_ZONE_ROAD: u32 = 1;

/// Neither open nor closed.
pub const POSEWISE_MONITOR_EYES_UNKNOWN: u32 = 0;
/// The eyes are open.
pub const POSEWISE_MONITOR_EYES_OPEN: u32 = 1;
/// The eyes are closed.
pub const POSEWISE_MONITOR_EYES_CLOSED: u32 = 2;

/// None: the eyes are known.
pub const POSEWISE_MONITOR_REASON_NONE: u32 = 0;
/// No face is tracked.
pub const POSEWISE_MONITOR_REASON_NO_FACE: u32 = 1;
/// Confidence or pose is too uncertain.
pub const POSEWISE_MONITOR_REASON_LOW_CONFIDENCE: u32 = 2;
/// The head is turned away from the camera.
pub const POSEWISE_MONITOR_REASON_TURNED: u32 = 3;
/// Both eyes are hidden, or move too fast.
pub const POSEWISE_MONITOR_REASON_HIDDEN: u32 = 4;

/// Too little is known.
pub const POSEWISE_MONITOR_DROWSINESS_UNKNOWN: u32 = 0;
/// P80 is below awake_share of its limits.
pub const POSEWISE_MONITOR_DROWSINESS_AWAKE: u32 = 1;
/// Between awake and drowsy.
pub const POSEWISE_MONITOR_DROWSINESS_QUESTIONABLE: u32 = 2;
/// P80 reached drowsy_p80_60 or _180.
pub const POSEWISE_MONITOR_DROWSINESS_DROWSY: u32 = 3;

/// A closure up to long_closure_us ended.
pub const POSEWISE_MONITOR_EVENT_BLINK: u32 = 0;
/// Eyes closed for more than long_closure_us.
pub const POSEWISE_MONITOR_EVENT_LONG_CLOSURE: u32 = 1;
/// Eyes closed for microsleep_us.
pub const POSEWISE_MONITOR_EVENT_MICROSLEEP: u32 = 2;
/// Eyes closed for sleep_us.
pub const POSEWISE_MONITOR_EVENT_SLEEP: u32 = 3;
/// Eyes closed for unresponsive_us.
pub const POSEWISE_MONITOR_EVENT_UNRESPONSIVE: u32 = 4;
/// Eyes open after more than long_closure_us.
pub const POSEWISE_MONITOR_EVENT_CLOSURE_END: u32 = 5;
/// The mouth is open for yawn_us.
pub const POSEWISE_MONITOR_EVENT_YAWN: u32 = 6;
/// That yawn ended.
pub const POSEWISE_MONITOR_EVENT_YAWN_END: u32 = 7;
/// Head down and up, eyes closed; value: deg.
pub const POSEWISE_MONITOR_EVENT_NOD: u32 = 8;
/// A glance away from the road ended.
pub const POSEWISE_MONITOR_EVENT_GLANCE: u32 = 9;
/// A glance away takes long_glance_us.
pub const POSEWISE_MONITOR_EVENT_LONG_GLANCE: u32 = 10;
/// cumulative_us of the last 30 s were away.
pub const POSEWISE_MONITOR_EVENT_CUMULATIVE_GLANCE: u32 = 11;
/// Drowsiness begins; value: P80 over 60 s.
pub const POSEWISE_MONITOR_EVENT_DROWSY: u32 = 12;
/// Drowsiness ends; value: P80 over 60 s.
pub const POSEWISE_MONITOR_EVENT_DROWSY_END: u32 = 13;
/// Eyes unknown for degraded_us.
pub const POSEWISE_MONITOR_EVENT_DEGRADED: u32 = 14;
/// Eyes are known again.
pub const POSEWISE_MONITOR_EVENT_RESTORED: u32 = 15;
/// open_eye is final; value: mean of both.
pub const POSEWISE_MONITOR_EVENT_OPEN_EYE_LEARNT: u32 = 16;
/// natural_deg is final; value: its yaw.
pub const POSEWISE_MONITOR_EVENT_NATURAL_LEARNT: u32 = 17;
/// A timestamp was before the last one.
pub const POSEWISE_MONITOR_EVENT_CLOCK_BACK: u32 = 18;

/// Settings of a driver monitor. A NULL pointer to this struct selects all defaults; 0 in a field
/// selects that of the preset, of which the comments have the general one. Times are at most 71
/// minutes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_config {
    /// sizeof(posewise_monitor_config).
    pub struct_size: u32,
    /// 0 or POSEWISE_MONITOR_FIXED_POSE: forward_yaw_deg and forward_pitch_deg are exact, and no
    /// natural pose is learnt.
    pub flags: u32,
    /// POSEWISE_MONITOR_PRESET_*: the default of every other field, and the zones.
    pub preset: u32,
    /// How long an observation counts when no other follows, and how long what goes on survives
    /// unknown time \[us\], 100000..2000000. Default 300000, the gap that arbiters of driver
    /// monitors bridge.
    pub gap_us: u32,
    /// Least confidence of a face that is observed, 0..1. Default 0.5, chosen.
    pub min_confidence: f32,
    /// Largest angles from the line of sight at which eyes and mouth are known \[deg\], 10..90.
    /// Defaults 50 and 40, chosen: beyond, lids are seen too much from the side.
    pub eye_yaw_deg: f32,
    pub eye_pitch_deg: f32,
    /// Eyes close below the first openness and open above the second, 0.05..0.95. Defaults 0.35 and
    /// 0.45, chosen on rendered clips.
    pub closed_below: f32,
    pub open_above: f32,
    /// Shorter closures are no events \[us\]. Default 50000, chosen: a blink takes 100 to 400 ms.
    pub blink_us: u32,
    /// A longer closure is no blink \[us\]. Default 500000, as in studies of blinks.
    pub long_closure_us: u32,
    /// Closures of these lengths are a microsleep, sleep, an unresponsive driver \[us\]. Defaults
    /// 1000000, 3000000, 6000000: Euro NCAP 2026.
    pub microsleep_us: u32,
    pub sleep_us: u32,
    pub unresponsive_us: u32,
    /// Drowsy from these P80 over 60 and 180 s, 0.01..1. Defaults 0.15 (Wierwille 1994; NSTSCE
    /// 25-UI-177) and 0.12 (NHTSA and VTTI, DOT HS 811 117).
    pub drowsy_p80_60: f32,
    pub drowsy_p80_180: f32,
    /// Awake below this share of both, 0.1..1. Default 0.5: Wierwille 1994, 7.5 and 15 %.
    pub awake_share: f32,
    /// Least known share of a window that decides, 0.05..1. Default 0.5, chosen.
    pub min_known: f32,
    /// The mouth is open for a yawn above the first jaw_open and shut below the second, up to
    /// 0.95. Defaults 0.5 (studies of mouth ratios have 0.5 to 0.6) and 0.35, chosen.
    pub yawn_above: f32,
    pub yawn_below: f32,
    /// Shortest and longest yawn \[us\]. Defaults 1500000 and 12000000, from studies of yawns.
    pub yawn_us: u32,
    pub yawn_max_us: u32,
    /// A nod is a drop of the pitch by nod_deg within a second, 5..60, and a return within nod_us,
    /// at least a second, with closed eyes. Defaults 12 \[deg\] and 3000000 \[us\], from studies.
    pub nod_deg: f32,
    pub nod_us: u32,
    /// Direction of the road: yaw (-90..90) and pitch (-60..60) of a face that looks there, in the
    /// camera frame \[deg\]. Default 0 and 0.
    pub forward_yaw_deg: f32,
    pub forward_pitch_deg: f32,
    /// How far the driver's natural pose may be from there \[deg\], up to 50 and 30. Defaults 45
    /// and 25, for cameras up to 40 degrees off the driver's axis.
    pub natural_yaw_deg: f32,
    pub natural_pitch_deg: f32,
    /// A zone is left this far outside of it \[deg\], up to 15. Default 3, chosen: the error of a
    /// pose.
    pub zone_margin_deg: f32,
    /// A glance away of this length is long \[us\]. Default 3000000: Euro NCAP 2026, 3 to 4 s.
    pub long_glance_us: u32,
    /// So much of the last 30 s away is too much \[us\], up to 30000000. Default 10000000: Euro
    /// NCAP 2026.
    pub cumulative_us: u32,
    /// Time on the road that ends a glance \[us\]. Default 300000, as gap_us.
    pub return_us: u32,
    /// Time on the road that clears the time away \[us\]. Default 2000000: Euro NCAP 2026.
    pub clear_us: u32,
    /// Eyes that are unknown for this long are reported \[us\]. Default 10000000: Euro NCAP 2026.
    pub degraded_us: u32,
}

/// A zone of a driver monitor. Where zones overlap, the first one counts. This struct never grows,
/// so the layout of arrays stays the same.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_zone {
    /// POSEWISE_MONITOR_ZONE_ANGLES, _BOX or _PLANE.
    pub kind: u32,
    /// 0 or POSEWISE_MONITOR_ZONE_ROAD. What is not the road is away from it.
    pub flags: u32,
    /// Time of a stay that does not count as away \[us\]; 0xFFFFFFFF: none of it does.
    pub grace_us: u32,
    /// As the kind says, the rest 0. Angles are those from the direction of the road, within
    /// -180..180: yaw > 0 to the image right, pitch > 0 up. Boxes, along the axes, and planes, the
    /// parallelogram centre +- u +- v, are in the camera frame, within -20000..20000 mm. Each min
    /// is below its max. The cross product of u and v is at least 100 mm2, and at least 0.1 |u|
    /// |v|: they are at least 5.74 degrees from parallel.
    pub numbers: [f32; 9],
}

/// What a driver monitor sees of one frame, from posewise_monitor_observe() or from elsewhere.
/// Numbers that are not finite are unknown.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_observation {
    /// sizeof(posewise_monitor_observation).
    pub struct_size: u32,
    /// As in posewise_result. Only POSEWISE_TRACKING is a face that is observed.
    pub state: u32,
    /// As in posewise_result.
    pub confidence: f32,
    /// As in posewise_result \[deg\].
    pub yaw_deg: f32,
    pub pitch_deg: f32,
    /// As in posewise_result \[mm\].
    pub translation_mm: [f32; 3],
    /// As in posewise_result \[deg\].
    pub rotation_sigma_deg: [f32; 3],
    /// Distance of the lids in that of open ones, of the person's left and right eye, 0 shut .. 1
    /// open, -1 unknown; posewise_monitor_observe() computes it from posewise_result.eye_open and
    /// what the gaze says of the eyes.
    pub eye_open: [f32; 2],
    /// The animation weight jawOpen, 0..1; -1: unknown, because the mouth is hidden.
    pub jaw_open: f32,
    /// As in posewise_result. 1: the natural pose is learnt, and angles from the road count,
    /// relative to the line of sight, which hardly depends on the focal length; not with
    /// POSEWISE_MONITOR_FIXED_POSE.
    pub camera_assumed: u32,
}

/// Measures of eye closure over a window of whole seconds. This struct never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_perclos {
    /// Shares of the known time with eyes closed by at least 70 and 80 %, 0..1.
    pub p70: f32,
    pub p80: f32,
    /// Mean square of the closure over the known time, 0..1.
    pub em: f32,
    /// Share of the window in which the eyes were known, 0..1.
    pub known: f32,
    /// Closures that ended in the window, blinks too, and their mean length \[us\].
    pub closures: u32,
    pub mean_closure_us: u32,
}

/// What a driver monitor knows after an observation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_state {
    /// sizeof(posewise_monitor_state), set by the caller.
    pub struct_size: u32,
    /// POSEWISE_MONITOR_EYES_*.
    pub eyes: u32,
    /// Timestamp of the last observation \[us\]; 0 before the first.
    pub timestamp_us: i64,
    /// POSEWISE_MONITOR_REASON_*: why the eyes are unknown, _NONE where they are known.
    pub eyes_reason: u32,
    /// Both eyes, relative to this person's open ones: 0 shut .. 1 open, -1 unknown.
    pub openness: f32,
    /// Known closed time of the closure that goes on \[us\].
    pub closure_us: u32,
    /// Blinks, yawns and nods so far.
    pub blinks: u32,
    pub yawns: u32,
    pub nods: u32,
    /// Known time for which the mouth is open as in a yawn \[us\].
    pub mouth_open_us: u32,
    /// Index of the zone, POSEWISE_MONITOR_ZONE_OUTSIDE or POSEWISE_MONITOR_ZONE_UNKNOWN.
    pub zone: u32,
    /// Time there \[us\].
    pub zone_us: u32,
    /// Known time away from the road, less the grace of zones, in this glance \[us\].
    pub away_us: u32,
    /// The same in the last 30 s \[us\]: the current quarter of a second and the 119 before.
    pub away_30_us: u32,
    /// 1: natural_deg is final, after a minute of known pose. Before the first 10 s of it, the zone
    /// is unknown.
    pub natural_is_final: u32,
    /// Yaw and pitch from the direction of the road \[deg\]; 0 for an unknown zone.
    pub from_road_deg: [f32; 2],
    /// The natural pose: yaw and pitch from forward_yaw_deg and forward_pitch_deg \[deg\].
    pub natural_deg: [f32; 2],
    /// posewise_monitor_observation.eye_open of this person's open left and right eye; 1 until it
    /// is final.
    pub open_eye: [f32; 2],
    /// 1: open_eye is final, after half a minute of known eyes while alert.
    pub open_eye_is_final: u32,
    /// POSEWISE_MONITOR_DROWSINESS_*.
    pub drowsiness: u32,
    /// 1: the eyes have been unknown for degraded_us.
    pub degraded: u32,
    /// 0. Keeps the struct free of padding.
    pub reserved: u32,
    /// Known time in each zone so far \[us\].
    pub zones_us: [i64; 8],
    /// Measures over the last 60 and 180 whole seconds since the first observation. They change
    /// once a second.
    pub perclos_60: posewise_monitor_perclos,
    pub perclos_180: posewise_monitor_perclos,
}

/// An event of posewise_monitor_events(). This struct never grows, so the layout of arrays stays
/// the same. Later libraries may have kinds that this header lacks.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_event {
    /// Timestamp of the observation at which it was noticed \[us\].
    pub timestamp_us: i64,
    /// Timestamp at which what it is about began \[us\]. If the clock was set back since: for what
    /// ends with that, in the time before, so it may be after timestamp_us; for what lasts on, the
    /// first timestamp after it.
    pub start_us: i64,
    /// Known duration of it so far \[us\], without what was unknown in between, and without the
    /// jump of a clock that was set back. At most 0xFFFFFFFF, 71 minutes.
    pub duration_us: u32,
    /// POSEWISE_MONITOR_EVENT_*.
    pub kind: u32,
    /// Zone of a glance, else POSEWISE_MONITOR_ZONE_UNKNOWN.
    pub zone: u32,
    /// 0 or POSEWISE_MONITOR_CUT: it could no longer be seen, and took at least duration_us.
    pub flags: u32,
    /// As the kind says, else 0.
    pub value: f32,
    /// 0. Keeps the struct free of padding.
    pub reserved: u32,
}

/// A driver monitor, opaque. It starts at the start of the caller's memory and holds no pointer: a
/// memcpy of posewise_monitor_memory_size() bytes to memory of the same alignment is a second,
/// independent monitor. No output of a call may lie in that memory.
pub struct posewise_monitor {
    _private: [u8; 0],
}

assert_no_padding!(posewise_monitor_config: struct_size: u32, flags: u32, preset: u32, gap_us: u32,
    min_confidence: f32, eye_yaw_deg: f32, eye_pitch_deg: f32, closed_below: f32, open_above: f32,
    blink_us: u32, long_closure_us: u32, microsleep_us: u32, sleep_us: u32, unresponsive_us: u32,
    drowsy_p80_60: f32, drowsy_p80_180: f32, awake_share: f32, min_known: f32, yawn_above: f32,
    yawn_below: f32, yawn_us: u32, yawn_max_us: u32, nod_deg: f32, nod_us: u32,
    forward_yaw_deg: f32, forward_pitch_deg: f32, natural_yaw_deg: f32, natural_pitch_deg: f32,
    zone_margin_deg: f32, long_glance_us: u32, cumulative_us: u32, return_us: u32, clear_us: u32,
    degraded_us: u32);
assert_no_padding!(posewise_monitor_zone: kind: u32, flags: u32, grace_us: u32, numbers: [f32; 9]);
assert_no_padding!(posewise_monitor_observation: struct_size: u32, state: u32, confidence: f32,
    yaw_deg: f32, pitch_deg: f32, translation_mm: [f32; 3], rotation_sigma_deg: [f32; 3],
    eye_open: [f32; 2], jaw_open: f32, camera_assumed: u32);
assert_no_padding!(posewise_monitor_perclos: p70: f32, p80: f32, em: f32, known: f32, closures: u32,
    mean_closure_us: u32);
assert_no_padding!(posewise_monitor_state: struct_size: u32, eyes: u32, timestamp_us: i64,
    eyes_reason: u32, openness: f32, closure_us: u32, blinks: u32, yawns: u32, nods: u32,
    mouth_open_us: u32, zone: u32, zone_us: u32, away_us: u32, away_30_us: u32,
    natural_is_final: u32, from_road_deg: [f32; 2], natural_deg: [f32; 2], open_eye: [f32; 2],
    open_eye_is_final: u32, drowsiness: u32, degraded: u32, reserved: u32, zones_us: [i64; 8],
    perclos_60: posewise_monitor_perclos, perclos_180: posewise_monitor_perclos);
assert_no_padding!(posewise_monitor_event: timestamp_us: i64, start_us: i64, duration_us: u32,
    kind: u32, zone: u32, flags: u32, value: f32, reserved: u32);
