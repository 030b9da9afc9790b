//! Single figures as text, and the JSON that holds them.

use anyhow::{Context, Result};
use serde_json::Value;

/// The CRC-32 in the header of a model, as `posewise model info` prints it.
pub fn checksum(model: &[u8]) -> Result<String> {
    let bytes = model.get(16..20).and_then(|bytes| bytes.first_chunk());
    let crc = u32::from_le_bytes(*bytes.context("the model has no header")?);
    Ok(format!("{crc:08x}"))
}

/// A figure of one model: a number, or nothing where there was none to measure.
#[derive(Clone, Copy)]
pub struct Figure(Option<f64>);

impl Figure {
    /// A number; anything else is nothing.
    pub fn of(value: &Value) -> Self {
        Figure(value.as_f64())
    }

    /// The sum of two counts.
    pub fn plus(self, other: Figure) -> Figure {
        Figure(self.0.zip(other.0).map(|(a, b)| a + b))
    }

    /// With this number of decimals.
    pub fn fixed(self, decimals: usize) -> String {
        self.0
            .map_or("–".into(), |number| format!("{number:.decimals$}"))
    }

    /// A share as a percentage.
    pub fn percent(self, decimals: usize) -> String {
        Figure(self.0.map(|share| 100.0 * share)).fixed(decimals)
    }

    /// In millions or other multiples of a unit.
    pub fn over(self, unit: f64, decimals: usize) -> String {
        Figure(self.0.map(|number| number / unit)).fixed(decimals)
    }

    /// A whole number.
    pub fn count(self) -> String {
        self.fixed(0)
    }

    /// The quotient of two counts as a share.
    pub fn share_of(self, all: Figure) -> Figure {
        Figure(self.0.zip(all.0).map(|(part, all)| part / all))
    }
}

/// JSON with a line for each object and list in which everything is plain.
pub fn lines(value: &Value) -> String {
    let mut out = String::new();
    write(value, 0, &mut out);
    out + "\n"
}

fn write(value: &Value, depth: usize, out: &mut String) {
    let is_plain = |value: &Value| !value.is_object() && !value.is_array();
    let (marks, items): (_, Vec<(String, &Value)>) = match value {
        Value::Object(map) if !map.values().all(is_plain) => {
            let named = |(key, value)| (format!("{}: ", Value::from(String::clone(key))), value);
            (["{", "}"], map.iter().map(named).collect())
        }
        Value::Array(list) if !list.iter().all(is_plain) => (
            ["[", "]"],
            list.iter().map(|v| (String::new(), v)).collect(),
        ),
        record => {
            *out += &record.to_string();
            return;
        }
    };
    *out += marks[0];
    for (at, (name, value)) in items.into_iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        *out += &format!("{comma}\n{}{name}", " ".repeat(depth + 1));
        write(value, depth + 1, out);
    }
    *out += &format!("\n{}{}", " ".repeat(depth), marks[1]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_record_is_a_line() {
        let value = json!({"a": {"x": 1, "y": "w"}, "b": [[1, 2], {"z": {}}], "c": null});
        let text = "{\n \"a\": {\"x\":1,\"y\":\"w\"},\n \"b\": [\n  [1,2],\n  \
                    {\n   \"z\": {}\n  }\n ],\n \"c\": null\n}\n";
        assert_eq!(lines(&value), text);
        assert_eq!(serde_json::from_str::<Value>(text).unwrap(), value);
    }
}
