//! Figures: what `eval` and `bench` print and write. They have the same names in both.

use anyhow::{Context, Result};
use posewise_cli::output::create;
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

/// Most columns of a table, and their longest name.
const COLUMNS: usize = 12;
const LONGEST_NAME: usize = 12;
/// Longer lists are in the JSON only.
const LONGEST_LIST: usize = 6;

/// Prints figures, and writes them as JSON if there is a file for them.
pub fn show(figures: &Value, json: Option<&Path>) -> Result<()> {
    posewise_cli::output::print(&text(figures))?;
    json.map_or(Ok(()), |path| write_json(path, figures))
}

/// Writes figures.
pub fn write_json(path: &Path, value: &Value) -> Result<()> {
    let mut out = create(path)?;
    serde_json::to_writer_pretty(&mut out, value)
        .map_err(std::io::Error::from)
        .and_then(|()| writeln!(out))
        .and_then(|()| out.flush())
        .with_context(|| format!("cannot write {}", path.display()))
}

/// For people: single figures a line each; then those of each group, side by side where they fit.
fn text(figures: &Value) -> String {
    let mut out = String::new();
    match members(figures) {
        Some(members) => group(&mut out, "", &members),
        None => section(&mut out, "", figures),
    }
    out
}

fn section(out: &mut String, title: &str, figures: &Value) {
    lines(out, &leaves(figures));
    for (name, child) in children(figures) {
        let title = format!("{title}{name}");
        if let Some(members) = members(child) {
            out.push('\n');
            group(out, &title, &members);
        } else if has_groups(child) {
            let _ = writeln!(out, "\n{title}");
            section(out, &format!("{title}: "), child);
        }
    }
}

fn group(out: &mut String, title: &str, members: &[(String, &Value)]) {
    let fits = |(name, _): &(String, &Value)| name.chars().count() <= LONGEST_NAME;
    if members.len() <= COLUMNS && members.iter().all(fits) {
        table(out, title, members);
    } else {
        for (name, member) in members {
            let _ = writeln!(out, "{title}: {name}");
            lines(out, &leaves(member));
        }
    }
}

fn lines(out: &mut String, figures: &[(String, String)]) {
    let width = figures.iter().map(|(name, _)| name.chars().count()).max();
    for (name, figure) in figures {
        // Writing to a String cannot fail, here and elsewhere.
        let _ = writeln!(out, "{name:<width$}  {figure}", width = width.unwrap_or(0));
    }
}

/// A column for each member.
fn table(out: &mut String, title: &str, members: &[(String, &Value)]) {
    let columns: Vec<Vec<(String, String)>> = members.iter().map(|(_, m)| leaves(m)).collect();
    let mut names: Vec<&String> = Vec::new();
    for (name, _) in columns.iter().flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let titles = names.iter().map(|name| name.chars().count());
    let first = titles.chain([title.chars().count()]).max().unwrap_or(0);
    let mut row = |first_cell: &str, cells: &mut dyn Iterator<Item = &str>| {
        let _ = write!(out, "{first_cell:<first$}");
        cells.for_each(|cell| {
            let _ = write!(out, "{cell:>width$}", width = LONGEST_NAME + 1);
        });
        out.push('\n');
    };
    row(title, &mut members.iter().map(|(name, _)| name.as_str()));
    for name in names {
        row(name, &mut columns.iter().map(|column| cell(column, name)));
    }
}

/// A figure of a column by its name.
fn cell<'c>(column: &'c [(String, String)], name: &str) -> &'c str {
    let found = column.iter().find(|(other, _)| other == name);
    found.map_or("–", |(_, figure)| figure)
}

/// Names and values of an object; those of a list have numbers, or the names that they say.
fn children(value: &Value) -> Vec<(String, &Value)> {
    let named = |(at, item): (usize, &'_ Value)| {
        let name = ["name", "clip"].iter().find_map(|key| item[key].as_str());
        name.map_or_else(|| at.to_string(), str::to_owned)
    };
    match value {
        Value::Object(map) => map.iter().map(|(name, v)| (name.clone(), v)).collect(),
        Value::Array(list) => (list.iter().enumerate())
            .map(|(at, v)| (named((at, v)), v))
            .collect(),
        _ => Vec::new(),
    }
}

/// The members of a group: objects that have figures of the same names.
fn members(value: &Value) -> Option<Vec<(String, &Value)>> {
    let members = children(value);
    let (_, first) = members.first()?;
    let is_alike = |member: &Value| match (first, member) {
        (Value::Object(first), Value::Object(member)) => {
            member.keys().any(|name| first.contains_key(name))
        }
        _ => false,
    };
    let is_group = (members.iter()).all(|(_, m)| is_alike(m) && !has_groups(m));
    is_group.then_some(members)
}

fn has_groups(value: &Value) -> bool {
    let mut children = children(value).into_iter();
    children.any(|(_, child)| members(child).is_some() || has_groups(child))
}

/// All figures but those of groups, with the names of the objects that they are in.
fn leaves(value: &Value) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for (name, child) in children(value) {
        if members(child).is_some() || has_groups(child) {
            continue;
        }
        if child.is_object() {
            let below = leaves(child).into_iter();
            out.extend(below.map(|(below, figure)| (format!("{name}.{below}"), figure)));
        } else {
            out.extend(shown(child).map(|figure| (name, figure)));
        }
    }
    out
}

/// Writes a CSV, whose columns are the names of the rows' values.
pub fn write_rows(path: &Path, rows: impl IntoIterator<Item = impl Serialize>) -> Result<()> {
    let mut out = csv::Writer::from_writer(create(path)?);
    let context = || format!("cannot write {}", path.display());
    for row in rows {
        out.serialize(row).with_context(context)?;
    }
    out.flush().with_context(context)
}

/// Four digits of a fraction, all of a whole number; `None` of a long list.
fn shown(value: &Value) -> Option<String> {
    Some(match value {
        Value::Null => "–".into(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or(f64::NAN);
            let decimals = match number == 0.0 {
                true => 0,
                false => (3.0 - number.abs().log10().floor()).clamp(0.0, 6.0) as usize,
            };
            format!("{number:.decimals$}")
        }
        Value::Array(list) if list.len() > LONGEST_LIST => return None,
        Value::Array(list) => list.iter().filter_map(shown).collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn figures_for_people() {
        let band = |error: f64| json!({"count": 3, "error": error, "all": [1, 2, 3, 4, 5, 6, 7]});
        let figures = json!({
            "found": 0.912_345,
            "worst": null,
            "size": [640, 480],
            "closures": {"truth": 12},
            "bands": {"0-45": band(12.345_6), "45-90": {"count": 4}},
            "clips": [{"clip": "a/long/name.csv", "count": 2}],
        });
        let expected = "\
found           0.9123
worst           –
size            640 480
closures.truth  12

bands         0-45        45-90
count            3            4
error        12.35            –

clips: a/long/name.csv
clip   a/long/name.csv
count  2
";
        assert_eq!(text(&figures), expected);
    }
}
