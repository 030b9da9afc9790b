//! The columns that `track --monitor` adds at the end of the CSV. [`COLUMNS`] is the only list, as
//! for the tracker's.

use posewise::monitor::{MonitorState, Perclos, UnknownReason, ZoneState, ZonesBy};

use crate::value::{Cell, num};

/// One column.
pub struct Column {
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: fn(&MonitorState) -> Cell,
}

const fn column(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: fn(&MonitorState) -> Cell,
) -> Column {
    Column {
        name,
        unit,
        meaning,
        value,
    }
}

fn count(value: u32) -> Cell {
    Cell::Number(f64::from(value), 0)
}

/// The measures of a window.
macro_rules! window {
    ($window:ident, $seconds:literal) => {
        [
            column(
                concat!("perclos_p70_", $seconds),
                "0..1",
                concat!("P70 over the last ", $seconds, " s"),
                |s| num(s.$window.p70, 4),
            ),
            column(
                concat!("perclos_p80_", $seconds),
                "0..1",
                concat!("P80 over the last ", $seconds, " s"),
                |s| num(s.$window.p80, 4),
            ),
            column(
                concat!("perclos_em_", $seconds),
                "0..1",
                concat!("mean square closure over the last ", $seconds, " s"),
                |s| num(s.$window.em, 4),
            ),
            column(
                concat!("perclos_known_", $seconds),
                "0..1",
                "known share of that time",
                |s| num(s.$window.known, 4),
            ),
            column(
                concat!("closures_", $seconds),
                "",
                "closures that ended in it, blinks too",
                |s| count(closures(&s.$window)),
            ),
            column(
                concat!("mean_closure_us_", $seconds),
                "µs",
                "their mean length",
                |s| count(s.$window.mean_closure_us.unwrap_or(0)),
            ),
        ]
    };
}

fn closures(window: &Perclos) -> u32 {
    window.closures
}

/// Groups of columns, in order.
pub const COLUMNS: [&[Column]; 4] = [
    &[
        column("eyes", "word", "`unknown`, `open` or `closed`", |s| {
            Cell::Word(s.eyes.name())
        }),
        column(
            "eyes_reason",
            "word",
            "`none`, or: `no-face`, `low-confidence`, `turned`, `hidden`, `elsewhere`",
            |s| Cell::Word(UnknownReason::name_of(s.eyes.reason())),
        ),
        column(
            "openness",
            "0..1, −1",
            "of both eyes, relative to this person's open ones; −1 unknown",
            |s| num(s.openness.unwrap_or(-1.0), 3),
        ),
        column(
            "closure_us",
            "µs",
            "length of the closure that goes on",
            |s| count(s.closure_us),
        ),
    ],
    &window!(perclos_60, 60),
    &window!(perclos_180, 180),
    &[
        column("blinks", "", "blinks so far", |s| count(s.blinks)),
        column("yawns", "", "yawns so far", |s| count(s.yawns)),
        column("nods", "", "nods so far", |s| count(s.nods)),
        column(
            "mouth_open_us",
            "µs",
            "time of a mouth that is wide open",
            |s| count(s.mouth_open_us),
        ),
        column(
            "look_down_us",
            "µs",
            "time for which the eyes have looked down",
            |s| count(s.look_down_us),
        ),
        column(
            "zone",
            "",
            "index of the zone; −1 unknown, −2 outside of all",
            |s| Cell::Number(zone_number(s.zone), 0),
        ),
        column("zone_us", "µs", "time in it", |s| count(s.zone_us)),
        column(
            "away_us",
            "µs",
            "time away from the road in this glance",
            |s| count(s.away_us),
        ),
        column(
            "away_30_us",
            "µs",
            "time away from the road in the last 30 s",
            |s| count(s.away_30_us),
        ),
        column(
            "road_yaw_deg",
            "deg",
            "yaw from the direction of the road",
            |s| num(s.from_road_deg.unwrap_or_default()[0], 2),
        ),
        column(
            "road_pitch_deg",
            "deg",
            "pitch from the direction of the road",
            |s| num(s.from_road_deg.unwrap_or_default()[1], 2),
        ),
        column(
            "drowsiness",
            "word",
            "`unknown`, `awake`, `questionable` or `drowsy`",
            |s| Cell::Word(s.drowsiness.name()),
        ),
        column(
            "degraded",
            "0 or 1",
            "1: the eyes have long been unknown",
            |s| Cell::Number(f64::from(s.degraded), 0),
        ),
        column(
            "zone_by",
            "word",
            "what the zone is known by: `none`, `gaze` or `head`",
            |s| Cell::Word(ZonesBy::name_of(s.zone_by)),
        ),
        column(
            "road_gaze_yaw_deg",
            "deg",
            "yaw of the gaze from the direction of the road",
            |s| num(s.gaze_from_road_deg.unwrap_or_default()[0], 2),
        ),
        column(
            "road_gaze_pitch_deg",
            "deg",
            "pitch of the gaze from the direction of the road",
            |s| num(s.gaze_from_road_deg.unwrap_or_default()[1], 2),
        ),
    ],
];

fn all() -> impl Iterator<Item = &'static Column> {
    COLUMNS.into_iter().flatten()
}

/// Their names.
pub fn names() -> Vec<String> {
    all().map(|column| column.name.to_string()).collect()
}

/// Their values.
pub fn values(state: &MonitorState) -> Vec<String> {
    all().map(|column| (column.value)(state).text()).collect()
}

/// The columns as a Markdown table.
pub fn documentation() -> String {
    let mut out = String::from("| column | unit | meaning |\n|---|---|---|\n");
    for column in all() {
        out += &format!(
            "| `{}` | {} | {} |\n",
            column.name, column.unit, column.meaning
        );
    }
    out
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
        let table = documentation();
        assert!(
            docs.contains(&table),
            "docs/driver-monitor.md must contain:\n{table}"
        );
        assert!(table.lines().all(|line| line.chars().count() <= 100));
    }
}
