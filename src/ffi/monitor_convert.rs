//! Conversion between C values of the driver monitor and the crate's types.

use super::convert::or_default;
use super::memory;
use super::monitor_types::*;
use super::types::*;
use crate::monitor::{
    Drowsiness, EyeState, MonitorConfig, MonitorConfigError, MonitorEvent, MonitorEventKind,
    MonitorState, Observation, Perclos, Place, Preset, UnknownReason, Zone, ZoneShape, ZoneState,
    ZonesBy,
};
use crate::track::State;

const _: () = {
    use crate::monitor::{MAX_ZONES, MONITOR_EVENTS, MONITOR_RECORD_BYTES};
    assert!(POSEWISE_MONITOR_RECORD_SIZE as usize == MONITOR_RECORD_BYTES);
    assert!(POSEWISE_MONITOR_ZONES as usize == MAX_ZONES);
    assert!(POSEWISE_MONITOR_EVENTS as usize == MONITOR_EVENTS);
    assert!(MonitorEventKind::ALL.len() == POSEWISE_MONITOR_EVENT_LOOK_DOWN_END as usize + 1);
};

/// The preset of a number.
pub(super) fn preset_from(preset: u32) -> Result<Preset, posewise_status> {
    let known = Preset::ALL.get(preset as usize);
    known.copied().ok_or(POSEWISE_E_MONITOR_CONFIG)
}

/// Checked settings and their preset; the preset's value where a field is 0 and not exact.
///
/// # Safety
/// As at the head of memory.rs.
pub(super) unsafe fn monitor_config_from(
    config: *const posewise_monitor_config,
) -> Result<(MonitorConfig, Preset), posewise_status> {
    if config.is_null() {
        let preset = Preset::default();
        return Ok((preset.config(), preset));
    }
    // SAFETY: the caller's contract.
    let given = unsafe { memory::read_struct(config)? };
    if given.flags & !(POSEWISE_EXACT | POSEWISE_MONITOR_FIXED_POSE) != 0 {
        return Err(POSEWISE_E_FLAGS);
    }
    let preset = preset_from(given.preset)?;
    let mut config = settings(&given, &preset.config());
    config.zones_by = zones_by_from(given.zones_by)?;
    config.place = place_from(given.place)?;
    config.place_mm = given.place_mm;
    if given.flags & POSEWISE_MONITOR_FIXED_POSE != 0 {
        (config.natural_yaw_deg, config.natural_pitch_deg) = (0.0, 0.0);
    }
    config.check().map_err(monitor_config_error)?;
    Ok((config, preset))
}

fn zones_by_from(by: u32) -> Result<ZonesBy, posewise_status> {
    match by {
        POSEWISE_MONITOR_BY_GAZE => Ok(ZonesBy::Gaze),
        POSEWISE_MONITOR_BY_HEAD => Ok(ZonesBy::Head),
        _ => Err(POSEWISE_E_MONITOR_CONFIG),
    }
}

fn zones_by_to(by: Option<ZonesBy>) -> u32 {
    match by {
        Some(ZonesBy::Gaze) => POSEWISE_MONITOR_BY_GAZE,
        Some(ZonesBy::Head) => POSEWISE_MONITOR_BY_HEAD,
        None => POSEWISE_MONITOR_BY_NONE,
    }
}

fn place_from(place: u32) -> Result<Place, posewise_status> {
    match place {
        POSEWISE_MONITOR_PLACE_LEARNT => Ok(Place::Learnt),
        POSEWISE_MONITOR_PLACE_GIVEN => Ok(Place::Given),
        POSEWISE_MONITOR_PLACE_ANY => Ok(Place::Any),
        _ => Err(POSEWISE_E_MONITOR_CONFIG),
    }
}

fn place_to(place: Place) -> u32 {
    match place {
        Place::Learnt => POSEWISE_MONITOR_PLACE_LEARNT,
        Place::Given => POSEWISE_MONITOR_PLACE_GIVEN,
        Place::Any => POSEWISE_MONITOR_PLACE_ANY,
    }
}

/// Every setting that is a number, or its default.
fn settings(given: &posewise_monitor_config, default: &MonitorConfig) -> MonitorConfig {
    let or = |value: f32, default| or_default(value, default, given.flags);
    let or_us = |value: u32, default| or_default(value, default, given.flags);
    let mut config = *default;
    macro_rules! take {
        ($or:ident: $($field:ident)+) => {
            $(config.$field = $or(given.$field, default.$field);)+
        };
    }
    take!(or: min_confidence eye_yaw_deg eye_pitch_deg closed_below open_above drowsy_p80_60
        drowsy_p80_180 awake_share min_known yawn_above yawn_below nod_deg forward_yaw_deg
        forward_pitch_deg natural_yaw_deg natural_pitch_deg zone_margin_deg look_down_deg
        place_radius_mm gaze_gain);
    take!(or_us: gap_us blink_us long_closure_us microsleep_us sleep_us unresponsive_us yawn_us
        yawn_max_us nod_us long_glance_us cumulative_us return_us clear_us degraded_us
        look_down_us);
    config
}

/// Settings as their C struct, exact, with `struct_size` 0.
pub(super) fn monitor_config_to(preset: u32, config: &MonitorConfig) -> posewise_monitor_config {
    let mut to = posewise_monitor_config {
        flags: POSEWISE_EXACT,
        preset,
        zones_by: zones_by_to(Some(config.zones_by)),
        place: place_to(config.place),
        place_mm: config.place_mm,
        ..Default::default()
    };
    macro_rules! give {
        ($($field:ident)+) => {
            $(to.$field = config.$field;)+
        };
    }
    give!(min_confidence eye_yaw_deg eye_pitch_deg closed_below open_above drowsy_p80_60
        drowsy_p80_180 awake_share min_known yawn_above yawn_below nod_deg forward_yaw_deg
        forward_pitch_deg natural_yaw_deg natural_pitch_deg zone_margin_deg gap_us blink_us
        long_closure_us microsleep_us sleep_us unresponsive_us yawn_us yawn_max_us nod_us
        long_glance_us cumulative_us return_us clear_us degraded_us look_down_deg
        look_down_us place_radius_mm gaze_gain);
    to
}

/// The status of settings that are out of range.
pub(super) fn monitor_config_error(error: MonitorConfigError) -> posewise_status {
    match error {
        MonitorConfigError::Zone => POSEWISE_E_MONITOR_ZONES,
        MonitorConfigError::Time | MonitorConfigError::Threshold | MonitorConfigError::Angle => {
            POSEWISE_E_MONITOR_CONFIG
        }
    }
}

/// The zone that a C struct describes; the monitor checks its numbers.
pub(super) fn zone_from(given: &posewise_monitor_zone) -> Result<Zone, posewise_status> {
    let shape = match (given.kind, given.numbers) {
        (POSEWISE_MONITOR_ZONE_ANGLES, [a, b, c, d, 0.0, 0.0, 0.0, 0.0, 0.0]) => {
            ZoneShape::Angles {
                yaw_deg: [a, b],
                pitch_deg: [c, d],
            }
        }
        (POSEWISE_MONITOR_ZONE_BOX, [a, b, c, d, e, f, 0.0, 0.0, 0.0]) => ZoneShape::Box {
            min_mm: [a, b, c],
            max_mm: [d, e, f],
        },
        (POSEWISE_MONITOR_ZONE_PLANE, [a, b, c, d, e, f, g, h, i]) => ZoneShape::Plane {
            centre_mm: [a, b, c],
            half_u_mm: [d, e, f],
            half_v_mm: [g, h, i],
        },
        _ => return Err(POSEWISE_E_MONITOR_ZONES),
    };
    let zone = Zone::new(shape).with_grace(given.grace_us);
    match given.flags {
        0 => Ok(zone),
        POSEWISE_MONITOR_ZONE_ROAD => Ok(zone.as_road()),
        _ => Err(POSEWISE_E_FLAGS),
    }
}

/// What a C struct observes.
pub(super) fn observation_from(given: &posewise_monitor_observation) -> Observation {
    let mut seen = Observation::NONE;
    seen.state = match given.state {
        POSEWISE_TRACKING => State::Tracking,
        POSEWISE_COASTING => State::Coasting,
        _ => State::Searching,
    };
    seen.confidence = given.confidence;
    (seen.yaw_deg, seen.pitch_deg) = (given.yaw_deg, given.pitch_deg);
    seen.translation_mm = given.translation_mm;
    seen.rotation_sigma_deg = given.rotation_sigma_deg;
    // What is out of range is unknown.
    let share = |value: f32| (value >= 0.0).then_some(value);
    (seen.eye_open, seen.jaw_open) = (given.eye_open.map(share), share(given.jaw_open));
    seen.camera_assumed = given.camera_assumed != 0;
    seen.gaze_sigma_deg = given.gaze_sigma_deg;
    seen.gaze = (given.gaze != [0.0; 3]).then_some(given.gaze);
    seen.may_look_down = given.may_look_down != 0;
    seen
}

/// An observation as its C struct, with `struct_size` 0.
pub(super) fn observation_to(seen: &Observation) -> posewise_monitor_observation {
    posewise_monitor_observation {
        struct_size: 0, // write_struct() keeps the caller's
        state: match seen.state {
            State::Searching => POSEWISE_SEARCHING,
            State::Tracking => POSEWISE_TRACKING,
            State::Coasting => POSEWISE_COASTING,
        },
        confidence: seen.confidence,
        yaw_deg: seen.yaw_deg,
        pitch_deg: seen.pitch_deg,
        translation_mm: seen.translation_mm,
        rotation_sigma_deg: seen.rotation_sigma_deg,
        eye_open: seen.eye_open.map(|open| open.unwrap_or(-1.0)),
        jaw_open: seen.jaw_open.unwrap_or(-1.0),
        camera_assumed: u32::from(seen.camera_assumed),
        gaze: seen.gaze.unwrap_or_default(),
        may_look_down: u32::from(seen.may_look_down),
        gaze_sigma_deg: seen.gaze_sigma_deg,
    }
}

fn zone_to(zone: ZoneState) -> u32 {
    match zone {
        ZoneState::In(index) => u32::from(index),
        ZoneState::Outside => POSEWISE_MONITOR_ZONE_OUTSIDE,
        ZoneState::Unknown => POSEWISE_MONITOR_ZONE_UNKNOWN,
    }
}

fn perclos_to(measures: &Perclos) -> posewise_monitor_perclos {
    posewise_monitor_perclos {
        p70: measures.p70,
        p80: measures.p80,
        em: measures.em,
        known: measures.known,
        closures: measures.closures,
        mean_closure_us: measures.mean_closure_us.unwrap_or(0),
    }
}

/// A state as its C struct, with `struct_size` 0.
pub(super) fn monitor_state_to(state: &MonitorState) -> posewise_monitor_state {
    posewise_monitor_state {
        struct_size: 0, // write_struct() keeps the caller's
        eyes: match state.eyes {
            EyeState::Unknown(_) => POSEWISE_MONITOR_EYES_UNKNOWN,
            EyeState::Open => POSEWISE_MONITOR_EYES_OPEN,
            EyeState::Closed => POSEWISE_MONITOR_EYES_CLOSED,
        },
        timestamp_us: state.timestamp_us,
        eyes_reason: match state.eyes.reason() {
            None => POSEWISE_MONITOR_REASON_NONE,
            Some(UnknownReason::NoFace) => POSEWISE_MONITOR_REASON_NO_FACE,
            Some(UnknownReason::LowConfidence) => POSEWISE_MONITOR_REASON_LOW_CONFIDENCE,
            Some(UnknownReason::Turned) => POSEWISE_MONITOR_REASON_TURNED,
            Some(UnknownReason::Hidden) => POSEWISE_MONITOR_REASON_HIDDEN,
            Some(UnknownReason::Elsewhere) => POSEWISE_MONITOR_REASON_ELSEWHERE,
        },
        openness: state.openness.unwrap_or(-1.0),
        closure_us: state.closure_us,
        blinks: state.blinks,
        yawns: state.yawns,
        nods: state.nods,
        mouth_open_us: state.mouth_open_us,
        zone: zone_to(state.zone),
        zone_us: state.zone_us,
        away_us: state.away_us,
        away_30_us: state.away_30_us,
        natural_is_final: u32::from(state.natural_is_final),
        from_road_deg: state.from_road_deg.unwrap_or_default(),
        natural_deg: state.natural_deg,
        open_eye: state.open_eye,
        open_eye_is_final: u32::from(state.open_eye_is_final),
        drowsiness: match state.drowsiness {
            Drowsiness::Unknown => POSEWISE_MONITOR_DROWSINESS_UNKNOWN,
            Drowsiness::Awake => POSEWISE_MONITOR_DROWSINESS_AWAKE,
            Drowsiness::Questionable => POSEWISE_MONITOR_DROWSINESS_QUESTIONABLE,
            Drowsiness::Drowsy => POSEWISE_MONITOR_DROWSINESS_DROWSY,
        },
        degraded: u32::from(state.degraded),
        look_down_us: state.look_down_us,
        zones_us: state.zones_us.map(|us| us as i64),
        perclos_60: perclos_to(&state.perclos_60),
        perclos_180: perclos_to(&state.perclos_180),
        zone_by: zones_by_to(state.zone_by),
        natural_gaze_is_final: u32::from(state.natural_gaze_is_final),
        gaze_from_road_deg: state.gaze_from_road_deg.unwrap_or_default(),
        natural_gaze_deg: state.natural_gaze_deg,
        place_mm: state.place_mm.unwrap_or_default(),
        place_is_final: u32::from(state.place_is_final),
    }
}

/// An event as its C struct.
pub(super) fn monitor_event_to(event: &MonitorEvent) -> posewise_monitor_event {
    posewise_monitor_event {
        timestamp_us: event.timestamp_us,
        start_us: event.start_us,
        duration_us: event.duration_us,
        // The kinds are in the order of the header, as a test compares.
        kind: event.kind as u32,
        zone: event.zone.map_or(POSEWISE_MONITOR_ZONE_UNKNOWN, u32::from),
        flags: if event.is_cut {
            POSEWISE_MONITOR_CUT
        } else {
            0
        },
        value: event.value,
        reserved: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_and_presets_are_those_of_the_header() {
        use MonitorEventKind as Kind;
        let kinds = [
            (Kind::Blink, POSEWISE_MONITOR_EVENT_BLINK),
            (Kind::LongClosure, POSEWISE_MONITOR_EVENT_LONG_CLOSURE),
            (Kind::Microsleep, POSEWISE_MONITOR_EVENT_MICROSLEEP),
            (Kind::Sleep, POSEWISE_MONITOR_EVENT_SLEEP),
            (Kind::Unresponsive, POSEWISE_MONITOR_EVENT_UNRESPONSIVE),
            (Kind::ClosureEnd, POSEWISE_MONITOR_EVENT_CLOSURE_END),
            (Kind::Yawn, POSEWISE_MONITOR_EVENT_YAWN),
            (Kind::YawnEnd, POSEWISE_MONITOR_EVENT_YAWN_END),
            (Kind::Nod, POSEWISE_MONITOR_EVENT_NOD),
            (Kind::Glance, POSEWISE_MONITOR_EVENT_GLANCE),
            (Kind::LongGlance, POSEWISE_MONITOR_EVENT_LONG_GLANCE),
            (
                Kind::CumulativeGlance,
                POSEWISE_MONITOR_EVENT_CUMULATIVE_GLANCE,
            ),
            (Kind::Drowsy, POSEWISE_MONITOR_EVENT_DROWSY),
            (Kind::DrowsyEnd, POSEWISE_MONITOR_EVENT_DROWSY_END),
            (Kind::Degraded, POSEWISE_MONITOR_EVENT_DEGRADED),
            (Kind::Restored, POSEWISE_MONITOR_EVENT_RESTORED),
            (Kind::OpenEyeLearnt, POSEWISE_MONITOR_EVENT_OPEN_EYE_LEARNT),
            (Kind::NaturalLearnt, POSEWISE_MONITOR_EVENT_NATURAL_LEARNT),
            (Kind::ClockBack, POSEWISE_MONITOR_EVENT_CLOCK_BACK),
            (Kind::LookDown, POSEWISE_MONITOR_EVENT_LOOK_DOWN),
            (Kind::LookDownEnd, POSEWISE_MONITOR_EVENT_LOOK_DOWN_END),
        ];
        assert_eq!(kinds.map(|(kind, _)| kind), Kind::ALL);
        for (kind, number) in kinds {
            assert_eq!(kind as u32, number, "{kind:?}");
        }
        let presets = [
            (Preset::General, POSEWISE_MONITOR_PRESET_GENERAL),
            (Preset::EuroNcap, POSEWISE_MONITOR_PRESET_EURO_NCAP),
            (Preset::EuAddwFast, POSEWISE_MONITOR_PRESET_EU_ADDW_FAST),
            (Preset::EuAddwSlow, POSEWISE_MONITOR_PRESET_EU_ADDW_SLOW),
            (Preset::EuDdaw, POSEWISE_MONITOR_PRESET_EU_DDAW),
        ];
        for (preset, number) in presets {
            assert_eq!(preset_from(number), Ok(preset));
            // Every field survives the way to C and back.
            let config = preset.config();
            let back = settings(
                &monitor_config_to(number, &config),
                &MonitorConfig::default(),
            );
            assert_eq!(back, config);
            let by = zones_by_to(Some(config.zones_by));
            assert_eq!(zones_by_from(by), Ok(config.zones_by));
            assert_eq!(place_from(place_to(config.place)), Ok(config.place));
        }
        assert!(preset_from(5).is_err());
    }
}
