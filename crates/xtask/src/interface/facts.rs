//! What a field's comment states in brackets, which is written so that a program can read it:
//! `[deg, -90..90, default 0]`.

use anyhow::{Context, Result, bail, ensure};

/// Units of fields.
const UNITS: [&str; 6] = ["px", "deg", "mm", "us", "Hz", "bytes"];

/// What a name ends with, and the unit that it promises.
const ENDINGS: [(&str, &str); 5] = [
    ("_us", "us"),
    ("_deg", "deg"),
    ("_mm", "mm"),
    ("_px", "px"),
    ("_hz", "Hz"),
];

/// The release in which fields came that do not say another.
const FIRST: &str = "0.1";

/// What the brackets of a field say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Unit, if it has one.
    pub unit: Option<String>,
    /// Least and largest value.
    pub range: Option<[String; 2]>,
    /// A value outside of the range, as -1 for what is unknown.
    pub or: Option<String>,
    /// The value that a setting has where it is 0.
    pub default: Option<String>,
    /// The constants that are its values, by their beginning without `POSEWISE_`, or the names of
    /// all of them.
    pub values: Vec<String>,
    /// Whether it is 0 or 1.
    pub is_flag: bool,
    /// Whether the unit depends on another field.
    pub is_by_kind: bool,
    /// The release that added the field.
    pub since: String,
}

impl Facts {
    /// Reads the facts of the `nth` field of a group from the comment of the group.
    ///
    /// # Errors
    /// If a fact is not of the grammar.
    pub fn of(comment: &str, nth: usize) -> Result<Facts> {
        let mut facts = Facts {
            since: FIRST.to_owned(),
            ..Facts::default()
        };
        let Some((_, rest)) = comment.split_once('[') else {
            return Ok(facts);
        };
        let (inside, rest) = rest.split_once(']').context("[ without ]")?;
        ensure!(!rest.contains('['), "facts twice: {comment}");
        for item in inside.split(", ") {
            facts.take(item, nth)?;
        }
        Ok(facts)
    }

    fn take(&mut self, item: &str, nth: usize) -> Result<()> {
        let of_group = |values: &str| {
            let found = values.split(" and ").nth(nth);
            let only = (!values.contains(" and ")).then_some(values);
            let value = found.or(only).map(str::to_owned);
            value.with_context(|| format!("no value for field {nth} in {values}"))
        };
        if UNITS.contains(&item) {
            self.unit = Some(item.to_owned());
        } else if let Some(values) = item.strip_prefix("default ") {
            self.default = Some(of_group(values)?);
        } else if let Some(release) = item.strip_prefix("since ") {
            self.since = release.to_owned();
        } else if item == "0 or 1" {
            self.is_flag = true;
        } else if item == "by kind" {
            self.is_by_kind = true;
        } else if let Some(values) = item.strip_prefix("POSEWISE_") {
            self.values = vec![values.trim_end_matches("_*").to_owned()];
        } else if let (Some(name), Some(first)) = (item.strip_prefix('_'), self.values.first()) {
            let family = first.rsplit_once('_').map_or("", |(family, _)| family);
            let name = [family, name].join("_");
            self.values.push(name.trim_start_matches('_').to_owned());
        } else if let Some((least, most)) = item.split_once("..") {
            let (most, or) = match most.split_once(" or ") {
                Some((most, or)) => (most, Some(or.to_owned())),
                None => (most, None),
            };
            (self.range, self.or) = (Some([least.to_owned(), most.to_owned()]), or);
            for number in [least, most] {
                ensure!(number.parse::<f64>().is_ok(), "no number: {number}");
            }
        } else {
            bail!("no unit, range, default, release or constants: {item}");
        }
        Ok(())
    }

    /// What they lack for a field of this name, which is a number unless it is `u32`.
    ///
    /// # Errors
    /// If the name promises another unit, or nothing says what a number is.
    pub fn check(&self, name: &str, is_u32: bool) -> Result<()> {
        let promised = ENDINGS.iter().find(|(ending, _)| name.ends_with(ending));
        if let Some((_, unit)) = promised {
            ensure!(
                self.unit.as_deref() == Some(unit),
                "{name}: no [{unit}] in its comment"
            );
        }
        let is_known = self.unit.is_some() || self.range.is_some() || self.is_by_kind;
        ensure!(
            is_u32 || is_known,
            "{name}: its comment has neither unit nor range"
        );
        Ok(())
    }

    /// The range as in the comment.
    pub fn range_text(&self) -> String {
        match (&self.range, &self.or) {
            (Some([least, most]), Some(or)) => format!("{least}..{most} or {or}"),
            (Some([least, most]), None) => format!("{least}..{most}"),
            _ if self.is_flag => "0 or 1".to_owned(),
            _ => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facts_are_read() {
        let comment = "Largest angles [deg, 10..90, default 50 and 40, since 0.2]: chosen.";
        let facts = Facts::of(comment, 1).expect("facts");
        let expected = Facts {
            unit: Some("deg".into()),
            range: Some(["10".into(), "90".into()]),
            default: Some("40".into()),
            since: "0.2".into(),
            ..Facts::default()
        };
        assert_eq!(facts, expected);
        let values = |text: &str| Facts::of(text, 0).expect("facts").values;
        assert_eq!(values("[POSEWISE_LOSS_*]"), ["LOSS"]);
        let states = values("[POSEWISE_SEARCHING, _TRACKING]");
        assert_eq!(states, ["SEARCHING", "TRACKING"]);
        let zones = values("[POSEWISE_MONITOR_ZONE_BOX, _PLANE]");
        assert_eq!(zones, ["MONITOR_ZONE_BOX", "MONITOR_ZONE_PLANE"]);
        assert_eq!(
            Facts::of("[0..1 or -1]", 0).expect("facts").range_text(),
            "0..1 or -1"
        );
    }

    #[test]
    fn what_is_not_of_the_grammar_is_refused() {
        for text in [
            "[furlong]",
            "[0..many]",
            "[px",
            "[px] [mm]",
            "[default 1 and 2]",
        ] {
            assert!(Facts::of(text, 2).is_err(), "{text}");
        }
        let facts = |text| Facts::of(text, 0).expect("facts");
        assert!(facts("Age [mm].").check("age_us", false).is_err());
        assert!(facts("A number.").check("number", false).is_err());
        assert!(facts("A count.").check("count", true).is_ok());
    }
}
