//! Constants and structs of the driver monitor, in the order in which the header shows them. As for
//! `types`, the comments are written for the C reader.

/// Most memory of a monitor \[bytes\].
pub const POSEWISE_MONITOR_SIZE: u32 = 12 * 1024;
/// Bytes of what posewise_monitor_save() writes.
pub const POSEWISE_MONITOR_RECORD_SIZE: u32 = 64;
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

/// By the gaze where it is known, else by the head.
pub const POSEWISE_MONITOR_BY_GAZE: u32 = 0;
/// By the head, and by a gaze that looks down.
pub const POSEWISE_MONITOR_BY_HEAD: u32 = 1;
/// Of a state: the zone is unknown.
pub const POSEWISE_MONITOR_BY_NONE: u32 = 2;

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
/// The face is not at the driver's place.
pub const POSEWISE_MONITOR_REASON_ELSEWHERE: u32 = 5;

/// That where most of the first minute is a face.
pub const POSEWISE_MONITOR_PLACE_LEARNT: u32 = 0;
/// That at place_mm.
pub const POSEWISE_MONITOR_PLACE_GIVEN: u32 = 1;
/// Every face is the driver's.
pub const POSEWISE_MONITOR_PLACE_ANY: u32 = 2;

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
/// The eyes look down for look_down_us.
pub const POSEWISE_MONITOR_EVENT_LOOK_DOWN: u32 = 19;
/// That look ended.
pub const POSEWISE_MONITOR_EVENT_LOOK_DOWN_END: u32 = 20;

/// Settings of a driver monitor. A NULL pointer to this struct selects all defaults; without
/// POSEWISE_EXACT 0 in a field selects that of the preset, of which the comments have the general
/// one. Times are at most 71 minutes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_config {
    /// sizeof(posewise_monitor_config).
    pub struct_size: u32,
    /// POSEWISE_EXACT and POSEWISE_MONITOR_FIXED_POSE, or 0. With the latter, forward_yaw_deg and
    /// forward_pitch_deg are the road, and no natural pose is learnt.
    pub flags: u32,
    /// The default of every other field, and the zones \[POSEWISE_MONITOR_PRESET_*\].
    pub preset: u32,
    /// How long an observation counts when no other follows, and how long what goes on survives
    /// unknown time \[us, 100000..2000000, default 300000\], the gap that arbiters of driver
    /// monitors bridge.
    pub gap_us: u32,
    /// Least confidence of a face that is observed \[0..1, default 0.5\], chosen.
    pub min_confidence: f32,
    /// Largest yaw and pitch from the line of sight at which eyes and mouth are known \[deg,
    /// 10..90, default 50 and 40\], chosen: beyond, lids are seen too much from the side.
    pub eye_yaw_deg: f32,
    pub eye_pitch_deg: f32,
    /// Eyes close below the first openness and open above the second \[0.05..0.95, default 0.35 and
    /// 0.45\], chosen on rendered clips.
    pub closed_below: f32,
    pub open_above: f32,
    /// Shorter closures are no events \[us, default 50000\], chosen: a blink takes 100 to 400 ms.
    pub blink_us: u32,
    /// A longer closure is no blink \[us, default 500000\], as in studies of blinks.
    pub long_closure_us: u32,
    /// Closures of these lengths are a microsleep, sleep, an unresponsive driver \[us, default
    /// 1000000 and 3000000 and 6000000\]: Euro NCAP 2026.
    pub microsleep_us: u32,
    pub sleep_us: u32,
    pub unresponsive_us: u32,
    /// Drowsy from these P80 over 60 and 180 s \[0.01..1, default 0.15 and 0.12\]: Wierwille 1994
    /// and NSTSCE 25-UI-177; NHTSA and VTTI, DOT HS 811 117.
    pub drowsy_p80_60: f32,
    pub drowsy_p80_180: f32,
    /// Awake below this share of both \[0.1..1, default 0.5\]: Wierwille 1994, 7.5 and 15 %.
    pub awake_share: f32,
    /// Least known share of a window that decides \[0.05..1, default 0.5\], chosen.
    pub min_known: f32,
    /// The mouth is open for a yawn above the first jaw_open and shut below the second \[0..0.95,
    /// default 0.5 and 0.35\]: studies of mouth ratios have 0.5 to 0.6; chosen.
    pub yawn_above: f32,
    pub yawn_below: f32,
    /// Shortest and longest yawn \[us, default 1500000 and 12000000\], from studies of yawns.
    pub yawn_us: u32,
    pub yawn_max_us: u32,
    /// A nod is a drop of the pitch by this much within a second \[deg, 5..60, default 12\], and a
    /// return within nod_us, with closed eyes; from studies.
    pub nod_deg: f32,
    /// Longest nod \[us, default 3000000\], at least a second; from studies.
    pub nod_us: u32,
    /// Direction of the road: yaw of a face that looks there, in the camera frame \[deg, -90..90,
    /// default 0\].
    pub forward_yaw_deg: f32,
    /// Pitch of it, likewise \[deg, -60..60, default 0\].
    pub forward_pitch_deg: f32,
    /// How far the driver's natural pose may be from there in yaw \[deg, 0..50, default 45\], for
    /// cameras up to 40 degrees off the driver's axis.
    pub natural_yaw_deg: f32,
    /// The same in pitch \[deg, 0..30, default 25\].
    pub natural_pitch_deg: f32,
    /// A zone is left this far outside of it, and by a quarter of the standard deviation of a gaze
    /// farther \[deg, 0..15, default 3\], chosen: the error of a pose.
    pub zone_margin_deg: f32,
    /// A glance away of this length is long \[us, default 3000000\]: Euro NCAP 2026, 3 to 4 s.
    pub long_glance_us: u32,
    /// So much of the last 30 s away is too much \[us, 0..30000000, default 10000000\]: Euro NCAP
    /// 2026.
    pub cumulative_us: u32,
    /// Time on the road that ends a glance \[us, default 300000\], as gap_us.
    pub return_us: u32,
    /// Time on the road that clears the time away \[us, default 2000000\]: Euro NCAP 2026.
    pub clear_us: u32,
    /// Eyes that are unknown for this long are reported \[us, default 10000000\]: Euro NCAP 2026.
    pub degraded_us: u32,
    /// The eyes look down when their gaze is lowered by this much from the direction of the road
    /// \[deg, 10..60, default 18\], chosen: below the windscreen.
    pub look_down_deg: f32,
    /// A look down of this length is reported \[us, default 500000\], chosen.
    pub look_down_us: u32,
    /// What zones are met by \[POSEWISE_MONITOR_BY_*\]. _GAZE: the gaze where it is known, and the
    /// head where it is not, whose turn from the road then counts 1.5 times. _HEAD: the head as it
    /// is turned, and the gaze only while the eyes look down. _NONE is no setting.
    pub zones_by: u32,
    /// How much farther eyes have turned in the head than the gaze says, for zones \[1..2, default
    /// 1.3\], chosen on rendered clips: what the networks find falls short. What it is above 1
    /// counts three times for eyes that look lower than the head. 1 for exact gazes.
    pub gaze_gain: f32,
    /// Whose face is the driver's \[POSEWISE_MONITOR_PLACE_*\]; another one is unknown, as no face
    /// is.
    pub place: u32,
    /// The driver's place for POSEWISE_MONITOR_PLACE_GIVEN: midway between the eyes, camera frame
    /// \[mm, -20000..20000, default 0\].
    pub place_mm: [f32; 3],
    /// How far from the place the driver's face may be \[mm, 100..1000, default 300\], chosen: half
    /// way to the seat beside.
    pub place_radius_mm: f32,
}

/// A zone of a driver monitor. Where zones overlap, the first one counts. This struct never grows,
/// so the layout of arrays stays the same.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_zone {
    /// Its shape \[POSEWISE_MONITOR_ZONE_ANGLES, _BOX, _PLANE\].
    pub kind: u32,
    /// 0 or POSEWISE_MONITOR_ZONE_ROAD. What is not the road is away from it.
    pub flags: u32,
    /// Time of a stay that does not count as away \[us\]; 0xFFFFFFFF: none of it does.
    pub grace_us: u32,
    /// As the kind says, the rest 0 \[by kind\]. Angles are those from the direction of the road,
    /// within -180..180: yaw > 0 to the image right, pitch > 0 up. Boxes, along the axes, and
    /// planes, the parallelogram centre +- u +- v, are in the camera frame, within -20000..20000
    /// mm. Each min is below its max. The cross product of u and v is at least 100 mm2, and at
    /// least 0.1 |u| |v|: they are at least 5.74 degrees from parallel.
    pub numbers: [f32; 9],
}

/// What a driver monitor sees of one frame, from posewise_monitor_observe() or from elsewhere.
/// Numbers that are not finite are unknown.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_observation {
    /// sizeof(posewise_monitor_observation).
    pub struct_size: u32,
    /// As in posewise_result \[POSEWISE_SEARCHING, _TRACKING, _COASTING\]. Only POSEWISE_TRACKING
    /// is a face that is observed.
    pub state: u32,
    /// As in posewise_result \[0..1\].
    pub confidence: f32,
    /// As in posewise_result \[deg\].
    pub yaw_deg: f32,
    pub pitch_deg: f32,
    /// As in posewise_result \[mm\].
    pub translation_mm: [f32; 3],
    /// As in posewise_result \[deg\].
    pub rotation_sigma_deg: [f32; 3],
    /// Distance of the lids in that of open ones that look where these do, of the person's left and
    /// right eye \[0..1 or -1\]: 0 shut, 1 open, -1 unknown; posewise_monitor_observe() computes it
    /// from posewise_result.eye_open and what the gaze says of the eyes.
    pub eye_open: [f32; 2],
    /// The animation weight jawOpen \[0..1 or -1\]; -1: unknown, because the mouth is hidden.
    pub jaw_open: f32,
    /// As in posewise_result \[0 or 1\]. 1: the natural pose is learnt, and angles from the road
    /// count, relative to the line of sight, which hardly depends on the focal length; not with
    /// POSEWISE_MONITOR_FIXED_POSE.
    pub camera_assumed: u32,
    /// Unit gaze of both eyes in the camera frame \[-1..1\]; zeros where it is unknown.
    pub gaze: [f32; 3],
    /// Whether lids that are as good as shut may follow a lowered gaze \[0 or 1\]: a closure of
    /// such time alone is no longer than a blink, and PERCLOS leaves it out.
    pub may_look_down: u32,
    /// Standard deviation of the gaze about each axis that is perpendicular to it \[deg\]; 0: not
    /// known. A gaze with more than 15 is unknown.
    pub gaze_sigma_deg: f32,
}

/// Measures of eye closure over a window of whole seconds. This struct never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_perclos {
    /// Shares of the known time with eyes closed by at least 70 and 80 % \[0..1\].
    pub p70: f32,
    pub p80: f32,
    /// Mean square of the closure over the known time \[0..1\].
    pub em: f32,
    /// Share of the window in which the eyes were known \[0..1\].
    pub known: f32,
    /// Closures that ended in the window, blinks too.
    pub closures: u32,
    /// Their mean length \[us\].
    pub mean_closure_us: u32,
}

/// What a driver monitor knows after an observation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_monitor_state {
    /// sizeof(posewise_monitor_state), set by the caller.
    pub struct_size: u32,
    /// What the eyes are \[POSEWISE_MONITOR_EYES_*\].
    pub eyes: u32,
    /// Timestamp of the last observation \[us\]; 0 before the first.
    pub timestamp_us: i64,
    /// Why the eyes are unknown, _NONE where they are known \[POSEWISE_MONITOR_REASON_*\].
    pub eyes_reason: u32,
    /// Both eyes, relative to this person's open ones \[0..1 or -1\]: 0 shut, 1 open, -1 unknown.
    pub openness: f32,
    /// Known closed time of the closure that goes on \[us\].
    pub closure_us: u32,
    /// Blinks, yawns and nods so far.
    pub blinks: u32,
    pub yawns: u32,
    pub nods: u32,
    /// Known time for which the mouth is open as in a yawn \[us\].
    pub mouth_open_us: u32,
    /// Index of the zone; POSEWISE_MONITOR_ZONE_OUTSIDE or POSEWISE_MONITOR_ZONE_UNKNOWN.
    pub zone: u32,
    /// Time there \[us\].
    pub zone_us: u32,
    /// Known time away from the road, less the grace of zones, in this glance \[us\].
    pub away_us: u32,
    /// The same in the last 30 s \[us\]: the current quarter of a second and the 119 before.
    pub away_30_us: u32,
    /// Whether natural_deg is final \[0 or 1\], after a minute of known pose. Before the first 10 s
    /// of it, the zone is unknown.
    pub natural_is_final: u32,
    /// Yaw and pitch of the face from the direction of the road \[deg\]; 0 for an unknown zone.
    pub from_road_deg: [f32; 2],
    /// The natural pose: yaw and pitch from forward_yaw_deg and forward_pitch_deg \[deg\].
    pub natural_deg: [f32; 2],
    /// posewise_monitor_observation.eye_open of this person's open left and right eye \[0..1\]; 1
    /// until it is final.
    pub open_eye: [f32; 2],
    /// Whether open_eye is final \[0 or 1\], after half a minute of known eyes while alert.
    pub open_eye_is_final: u32,
    /// How drowsy the driver is \[POSEWISE_MONITOR_DROWSINESS_*\].
    pub drowsiness: u32,
    /// Whether the eyes have been unknown for degraded_us \[0 or 1\].
    pub degraded: u32,
    /// Known time for which the eyes have looked down \[us\]; 0 while they do not.
    pub look_down_us: u32,
    /// Known time in each zone so far \[us\].
    pub zones_us: [i64; 8],
    /// Measures over the last 60 and 180 whole seconds since the first observation. They change
    /// once a second.
    pub perclos_60: posewise_monitor_perclos,
    pub perclos_180: posewise_monitor_perclos,
    /// What the zone is known by \[POSEWISE_MONITOR_BY_*\].
    pub zone_by: u32,
    /// Whether natural_gaze_deg is final \[0 or 1\], after a minute of known gaze. Before the first
    /// 10 s of it, zones are met by the head.
    pub natural_gaze_is_final: u32,
    /// Yaw and pitch of the gaze from the direction of the road, with gaze_gain \[deg\]; 0 where it
    /// is unknown.
    pub gaze_from_road_deg: [f32; 2],
    /// The gaze that is on the road: yaw and pitch from forward_yaw_deg and forward_pitch_deg
    /// \[deg\].
    pub natural_gaze_deg: [f32; 2],
    /// The driver's place, midway between the eyes, camera frame \[mm\]; zeros where it is not
    /// known.
    pub place_mm: [f32; 3],
    /// Whether it is held, whoever is seen elsewhere \[0 or 1\]: given, or learnt for a minute.
    pub place_is_final: u32,
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
    /// What happened \[POSEWISE_MONITOR_EVENT_*\].
    pub kind: u32,
    /// Zone of a glance, else POSEWISE_MONITOR_ZONE_UNKNOWN.
    pub zone: u32,
    /// 0 or POSEWISE_MONITOR_CUT: it could no longer be seen, and took at least duration_us.
    pub flags: u32,
    /// As the kind says, else 0 \[by kind\].
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
