//! Comments as users of other languages read them: `"tracking"` for `POSEWISE_TRACKING`.

use super::facts::Facts;
use super::table::{Table, WORDS, word};

/// Names of structs, functions and constants that are no words, and what they are called elsewhere.
const NAMES: [(&str, &str); 8] = [
    ("posewise_result", "Result"),
    ("posewise_config", "the settings"),
    ("posewise_monitor_observation", "Observation"),
    ("posewise_monitor_observe", "Tracker.observation"),
    ("posewise_monitor_events", "Monitor.events"),
    ("POSEWISE_MONITOR_FIXED_POSE", "fixed_pose"),
    ("POSEWISE_MONITOR_ZONE_OUTSIDE", "\"outside\""),
    ("POSEWISE_MONITOR_ZONE_UNKNOWN", "\"unknown\""),
];

/// A comment in which constants that are words are their words, and functions have no prefix.
pub fn spoken(comment: &str, table: &Table) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_*".contains(c);
    let mut out = String::new();
    let comment = whole_names(comment);
    let mut rest = &*comment;
    while let Some(at) = rest.to_lowercase().find("posewise_") {
        let (before, from) = rest.split_at(at);
        let end = from.find(|c| !is_name(c)).unwrap_or(from.len());
        out += before;
        out += &name(&from[..end], table);
        rest = &from[end..];
    }
    out + rest
}

/// A comment with `_TRACKING` after a constant of the same family as `POSEWISE_TRACKING`.
fn whole_names(comment: &str) -> String {
    let values = Facts::of(comment, 0).map_or(Vec::new(), |facts| facts.values);
    let Some(first) = values.first() else {
        return comment.to_owned();
    };
    let family = match values.len() {
        1 => Some(&**first),
        _ => first.rsplit_once('_').map(|(family, _)| family),
    };
    let prefix = family.map_or("POSEWISE_".to_owned(), |of| format!("POSEWISE_{of}_"));
    let words = comment.split(' ').map(|word| match word.strip_prefix('_') {
        Some(rest) => prefix.clone() + rest,
        None => word.to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// What one name of the header is called elsewhere.
fn name(name: &str, table: &Table) -> String {
    if let Some((_, other)) = NAMES.iter().find(|(known, _)| *known == name) {
        return (*other).to_owned();
    }
    if let Some(function) = name.strip_prefix("posewise_") {
        return function.to_owned();
    }
    let constant = name.trim_start_matches("POSEWISE_");
    let family = constant.trim_end_matches("_*");
    if WORDS.contains(&family)
        && let Ok(words) = table.words(family)
    {
        return format!("\"{}\"", words.join("\", \""));
    }
    let kind = WORDS.into_iter().find_map(|kind| {
        let found = match kind {
            "STATE" => constant,
            _ => constant.strip_prefix(kind)?.strip_prefix('_')?,
        };
        let words = table.words(kind).ok()?;
        words.contains(&word(found)).then(|| word(found))
    });
    kind.map_or(name.to_owned(), |word| format!("\"{word}\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_words() {
        let table = Table::read().expect("src/ffi is read");
        let states = spoken("[POSEWISE_SEARCHING, _TRACKING]", &table);
        assert_eq!(states, "[\"searching\", \"tracking\"]");
        let text = "POSEWISE_EYE_KNOWN while POSEWISE_TRACKING; see posewise_smoothed().";
        let expected = "\"known\" while \"tracking\"; see smoothed().";
        assert_eq!(spoken(text, &table), expected);
        assert_eq!(
            spoken("[POSEWISE_LENS_*]", &table),
            "[\"pinhole\", \"brown\", \"fisheye\"]"
        );
        assert_eq!(
            spoken("by POSEWISE_EYE_LOOK_* [0..1]", &table),
            "by POSEWISE_EYE_LOOK_* [0..1]"
        );
        let text = "Unknown, _NONE (posewise_smoothed) [POSEWISE_MONITOR_REASON_*]";
        let expected = "Unknown, \"none\" (smoothed) [\"none\", \"no-face\", \"low-confidence\", \
                        \"turned\", \"hidden\", \"elsewhere\"]";
        assert_eq!(spoken(text, &table), expected);
        assert_eq!(
            spoken("[POSEWISE_MONITOR_ZONE_ANGLES, _BOX]", &table),
            "[\"angles\", \"box\"]"
        );
    }
}
