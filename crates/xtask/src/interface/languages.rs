//! What JavaScript and Python have in common: how they call lists, types and flags of C.

use super::table::{Field, Struct, Table, word};
use super::words::spoken;

/// Sentences with one of these are about C.
const OF_C: [&str; 4] = ["NULL", "struct", "header", "region of zeros"];

/// What a struct is, without what only C has.
pub fn docs(item: &Struct, table: &Table) -> String {
    let text = spoken(&item.comment, table);
    let is_of_c = |sentence: &&str| OF_C.iter().any(|word| sentence.contains(word));
    let sentences: Vec<&str> = text.split_inclusive(". ").filter(|s| !is_of_c(s)).collect();
    sentences.concat().trim_end().to_owned()
}

/// The list of the words of a kind, and the type of which it holds all values.
pub fn words_type(kind: &str) -> (&'static str, &'static str) {
    match kind {
        "STATE" => ("STATES", "State"),
        "LOSS" => ("LOSSES", "Loss"),
        "EVENT" => ("EVENTS", "EventKind"),
        "EYE" => ("EYES", "EyeStatus"),
        "TERMS" => ("TERMS", "Terms"),
        "GAZE" => ("GAZES", "GazeSetting"),
        "LIKENESS" => ("LIKENESSES", "Likeness"),
        "MONITOR_PRESET" => ("PRESETS", "Preset"),
        "MONITOR_EYES" => ("EYE_STATES", "EyeState"),
        "MONITOR_REASON" => ("REASONS", "UnknownReason"),
        "MONITOR_DROWSINESS" => ("DROWSINESS", "Drowsiness"),
        "MONITOR_EVENT" => ("MONITOR_EVENTS", "MonitorEventKind"),
        "MONITOR_BY" => ("ZONES_BY", "ZonesBy"),
        "MONITOR_PLACE" => ("PLACES", "Place"),
        "MONITOR_ZONE" => ("ZONE_KINDS", "ZoneKind"),
        "MESH_SPACE" => ("MESH_SPACES", "MeshSpace"),
        "MESH_LINE" => ("MESH_LINES", "MeshLine"),
        _ => ("LENSES", "LensModel"),
    }
}

/// Numbers that both have, and their names in C.
pub const NUMBERS: [(&str, &str); 10] = [
    ("ABI", "ABI"),
    ("LANDMARKS", "LANDMARKS"),
    ("ANIMATIONS", "ANIMATIONS"),
    ("EYE_LOOKS", "EYE_LOOKS"),
    ("MESH_VERTICES", "MESH_VERTICES"),
    ("MESH_NEUTRAL", "MESH_NEUTRAL"),
    ("UNREAD_EVENTS", "EVENTS"),
    ("UNREAD_MONITOR_EVENTS", "MONITOR_EVENTS"),
    ("IDENTITY_RECORD_SIZE", "IDENTITY_RECORD_SIZE"),
    ("MONITOR_RECORD_SIZE", "MONITOR_RECORD_SIZE"),
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

/// A flag that is a field of its own.
pub struct Flag {
    /// The name of the field.
    pub name: &'static str,
    /// What it means.
    pub comment: String,
    /// Its bit.
    pub bit: i64,
}

/// The flag of `flags` of a struct that users see. They do not see `POSEWISE_EXACT`, which both
/// languages set: what is not given is the default there, and 0 is 0.
pub fn flag_of(item: &Struct, field: &Field, table: &Table) -> Option<Flag> {
    if field.name != "flags" {
        return None;
    }
    let (name, constant, before) = match &*item.name {
        "monitor_config" => ("fixed_pose", "MONITOR_FIXED_POSE", "With the latter, "),
        "monitor_event" => ("is_cut", "MONITOR_CUT", ": "),
        "monitor_zone" => ("is_road", "MONITOR_ZONE_ROAD", ". "),
        _ => return None,
    };
    let meaning = field.comment.split_once(before)?.1;
    let start = match name {
        "is_road" => "Whether it is the road. ",
        _ => "Whether ",
    };
    Some(Flag {
        name,
        comment: start.to_owned() + meaning,
        bit: table.value(constant).ok()?,
    })
}
