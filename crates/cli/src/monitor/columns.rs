//! The columns that `track --monitor` adds at the end of the CSV. [`COLUMNS`] is the only list, as
//! for the tracker's.

use posewise::{MonitorState, UnknownReason, ZoneState};

use crate::columns::Names::One;
use crate::columns::{Cell, Column, columns, num};

fn count(value: u32) -> Cell {
    Cell::Number(f64::from(value), 0)
}

columns! {
    /// Every column, in order.
    pub const COLUMNS: fn(&MonitorState, usize) -> Cell = |state, i|;
    One("eyes"), "word", "`unknown`, `open` or `closed`" => Cell::Word(state.eyes.name());
    One("eyes_reason"),
        "word", "why unknown: `none`, `no-face`, `low-confidence`, `turned`, `hidden`"
        => Cell::Word(UnknownReason::name_of(state.eyes_reason));
    One("openness"), "0..1, −1", "of both eyes, relative to this person's open ones; −1 unknown"
        => num(state.openness, 3);
    One("closure_us"), "µs", "length of the closure that goes on" => count(state.closure_us);
    One("perclos_p70_60"), "0..1", "P70 over the last 60 s" => num(state.perclos_60.p70, 4);
    One("perclos_p80_60"), "0..1", "P80 over the last 60 s" => num(state.perclos_60.p80, 4);
    One("perclos_em_60"), "0..1", "mean square closure over the last 60 s"
        => num(state.perclos_60.em, 4);
    One("perclos_known_60"), "0..1", "known share of that time" => num(state.perclos_60.known, 4);
    One("closures_60"), "", "closures that ended in it, blinks too"
        => count(state.perclos_60.closures);
    One("mean_closure_us_60"), "µs", "their mean length" => count(state.perclos_60.mean_closure_us);
    One("perclos_p70_180"), "0..1", "P70 over the last 180 s" => num(state.perclos_180.p70, 4);
    One("perclos_p80_180"), "0..1", "P80 over the last 180 s" => num(state.perclos_180.p80, 4);
    One("perclos_em_180"), "0..1", "mean square closure over the last 180 s"
        => num(state.perclos_180.em, 4);
    One("perclos_known_180"), "0..1", "known share of that time" => num(state.perclos_180.known, 4);
    One("closures_180"), "", "closures that ended in it, blinks too"
        => count(state.perclos_180.closures);
    One("mean_closure_us_180"), "µs", "their mean length"
        => count(state.perclos_180.mean_closure_us);
    One("blinks"), "", "blinks so far" => count(state.blinks);
    One("yawns"), "", "yawns so far" => count(state.yawns);
    One("nods"), "", "nods so far" => count(state.nods);
    One("mouth_open_us"), "µs", "time of a mouth that is wide open" => count(state.mouth_open_us);
    One("zone"), "", "index of the zone; −1 unknown, −2 outside of all"
        => Cell::Number(zone_number(state.zone), 0);
    One("zone_us"), "µs", "time in it" => count(state.zone_us);
    One("away_us"), "µs", "time away from the road in this glance" => count(state.away_us);
    One("away_30_us"), "µs", "time away from the road in the last 30 s" => count(state.away_30_us);
    One("road_yaw_deg"), "deg", "yaw from the direction of the road"
        => num(state.from_road_deg[0], 2);
    One("road_pitch_deg"), "deg", "pitch from the direction of the road"
        => num(state.from_road_deg[1], 2);
    One("drowsiness"), "word", "`unknown`, `awake`, `questionable` or `drowsy`"
        => Cell::Word(state.drowsiness.name());
    One("degraded"), "0 or 1", "1: the eyes have long been unknown"
        => Cell::Number(f64::from(state.degraded), 0);
}

/// Their values.
pub fn values(state: &MonitorState) -> Vec<String> {
    let values = COLUMNS.iter().map(|column| (column.value)(state, 0).text());
    values.collect()
}

/// The zone's index; −1 unknown, −2 outside of all.
pub fn zone_number(zone: ZoneState) -> f64 {
    match zone {
        ZoneState::In(index) => f64::from(index),
        ZoneState::Unknown => -1.0,
        ZoneState::Outside => -2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn docs_list_the_columns() {
        let docs = include_str!("../../../../docs/driver-monitor.md");
        let table = crate::columns::table(COLUMNS);
        assert!(
            docs.contains(&table),
            "docs/driver-monitor.md must contain:\n{table}"
        );
        assert!(table.lines().all(|line| line.chars().count() <= 100));
    }
}
