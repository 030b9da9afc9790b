//! What JavaScript and Python have in common: how they call lists, types and flags of C.

use super::table::{Field, Struct, Table, word};

/// The list of the words of a kind, and the type of which it holds all values.
pub fn words_type(kind: &str) -> (&'static str, &'static str) {
    match kind {
        "STATE" => ("STATES", "State"),
        "LOSS" => ("LOSSES", "Loss"),
        "EVENT" => ("EVENTS", "EventKind"),
        "EYE" => ("EYES", "EyeStatus"),
        "TERMS" => ("TERMS", "Terms"),
        "GAZE" => ("GAZES", "GazeSetting"),
        "MONITOR_PRESET" => ("PRESETS", "Preset"),
        "MONITOR_EYES" => ("EYE_STATES", "EyeState"),
        "MONITOR_REASON" => ("REASONS", "UnknownReason"),
        "MONITOR_DROWSINESS" => ("DROWSINESS", "Drowsiness"),
        "MONITOR_EVENT" => ("MONITOR_EVENTS", "MonitorEventKind"),
        "MONITOR_ZONE" => ("ZONE_KINDS", "ZoneKind"),
        _ => ("LENSES", "LensModel"),
    }
}

/// Numbers that both have, and their names in C.
pub const NUMBERS: [(&str, &str); 6] = [
    ("ABI", "ABI"),
    ("LANDMARKS", "LANDMARKS"),
    ("ANIMATIONS", "ANIMATIONS"),
    ("EYE_LOOKS", "EYE_LOOKS"),
    ("UNREAD_EVENTS", "EVENTS"),
    ("UNREAD_MONITOR_EVENTS", "MONITOR_EVENTS"),
];

/// What a field that is the index of a zone may be else: numbers and words.
pub fn no_zones(table: &Table) -> Vec<(i64, String)> {
    let others = table.with_prefix("MONITOR_ZONE_");
    let is_other = |name: &str| ["OUTSIDE", "UNKNOWN"].contains(&name);
    let others = others.into_iter().filter(|(name, _)| is_other(name));
    others.map(|(name, value)| (value, word(name))).collect()
}

/// Whether a field is the index of a zone, or a word of [`no_zones`].
pub fn is_zone(field: &Field) -> bool {
    field.name == "zone"
}

/// The name of a struct's type, as Rust has it.
pub fn type_name(item: &str) -> String {
    let name = match item {
        "monitor_zone" | "monitor_observation" | "monitor_perclos" => &item["monitor_".len()..],
        _ => item,
    };
    let parts = name.split('_');
    parts
        .map(|part| part[..1].to_uppercase() + &part[1..])
        .collect()
}

/// The one flag that `flags` of a struct is, and what it means.
pub fn flag_of(item: &Struct, field: &Field) -> Option<(&'static str, String)> {
    if field.name != "flags" {
        return None;
    }
    let name = match &*item.name {
        "monitor_config" => "fixed_pose",
        "monitor_event" => "is_cut",
        "monitor_zone" => "is_road",
        _ => return None,
    };
    let meaning = field.comment.split_once([':', '.'])?.1.trim();
    let meaning = match name {
        "is_road" => format!("Whether it is the road. {meaning}"),
        _ => format!("Whether {meaning}"),
    };
    Some((name, meaning))
}
