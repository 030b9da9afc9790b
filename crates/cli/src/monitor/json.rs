//! State, events and zones as the page of `posewise view` reads them: `MonitorState`,
//! `MonitorEvent` and `Zone` of `web/layout.js` and `web/monitor.js`.

use posewise::monitor::{
    MonitorEvent, MonitorState, Perclos, UnknownReason, Zone, ZoneShape, ZoneState, ZonesBy,
};
use serde_json::{Value, json};

use crate::value::{number, numbers};

fn perclos(window: &Perclos) -> Value {
    json!({
        "p70": number(window.p70),
        "p80": number(window.p80),
        "em": number(window.em),
        "known": number(window.known),
        "closures": window.closures,
        "meanClosureUs": window.mean_closure_us.unwrap_or(0),
    })
}

fn zone(zone: ZoneState) -> Value {
    match zone {
        ZoneState::In(index) => index.into(),
        ZoneState::Outside => "outside".into(),
        ZoneState::Unknown => "unknown".into(),
    }
}

/// `MonitorState`.
pub fn state(s: &MonitorState) -> Value {
    json!({
        "timestampUs": s.timestamp_us,
        "eyes": s.eyes.name(),
        "eyesReason": UnknownReason::name_of(s.eyes.reason()),
        "openness": number(s.openness.unwrap_or(-1.0)),
        "closureUs": s.closure_us,
        "blinks": s.blinks,
        "yawns": s.yawns,
        "nods": s.nods,
        "mouthOpenUs": s.mouth_open_us,
        "lookDownUs": s.look_down_us,
        "zone": zone(s.zone),
        "zoneBy": ZonesBy::name_of(s.zone_by),
        "zoneUs": s.zone_us,
        "awayUs": s.away_us,
        "away30Us": s.away_30_us,
        "fromRoadDeg": numbers(&s.from_road_deg.unwrap_or_default()),
        "gazeFromRoadDeg": numbers(&s.gaze_from_road_deg.unwrap_or_default()),
        "naturalIsFinal": s.natural_is_final,
        "naturalGazeIsFinal": s.natural_gaze_is_final,
        "openEyeIsFinal": s.open_eye_is_final,
        "placeIsFinal": s.place_is_final,
        "drowsiness": s.drowsiness.name(),
        "degraded": s.degraded,
        "perclos60": perclos(&s.perclos_60),
        "perclos180": perclos(&s.perclos_180),
    })
}

/// `MonitorEvent`.
pub fn event(e: &MonitorEvent) -> Value {
    json!({
        "timestampUs": e.timestamp_us,
        "startUs": e.start_us,
        "durationUs": e.duration_us,
        "kind": e.kind.name(),
        "zone": e.zone.map_or(zone(ZoneState::Unknown), Value::from),
        "isCut": e.is_cut,
        "value": number(e.value),
    })
}

/// `Zone`s. What is no range of angles has none: a plan does not show it.
pub fn zones(zones: &[Zone]) -> Value {
    let of = |zone: &Zone| {
        let (yaw, pitch) = match zone.shape {
            ZoneShape::Angles { yaw_deg, pitch_deg } => (numbers(&yaw_deg), numbers(&pitch_deg)),
            _ => (json!([]), json!([])),
        };
        json!({ "yawDeg": yaw, "pitchDeg": pitch, "isRoad": zone.is_road })
    };
    zones.iter().map(of).collect()
}
