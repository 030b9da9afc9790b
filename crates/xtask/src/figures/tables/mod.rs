//! Writes the pages' Markdown from the figures of all models.

mod clips;
mod photographs;
mod search;

use std::fmt::Write as _;

use anyhow::{Context, Result};
use serde_json::Value;

use super::value::{Figure, at};

/// The figures of one model.
pub struct Model {
    /// The name of its file.
    pub name: String,
    /// What `measure` wrote.
    pub figures: Value,
}

impl Model {
    /// The figure at a JSON pointer.
    pub fn at(&self, pointer: &str) -> Result<Figure> {
        at(&self.figures, pointer).with_context(|| format!("model {}", self.name))
    }

    /// The list at a JSON pointer.
    fn list(&self, pointer: &str) -> Result<&Vec<Value>> {
        let list = self.figures.pointer(pointer).and_then(Value::as_array);
        list.with_context(|| format!("model {}: no list {pointer}", self.name))
    }
}

/// The cells of one row.
type Row = Vec<String>;
/// Writes one table of all models.
type Render = fn(&[Model]) -> Result<String>;
/// The text of one figure of a model.
type Text<'a> = &'a dyn Fn(&Model) -> Result<String>;

/// A Markdown table.
pub fn table(header: &[&str], rows: &[Row]) -> String {
    let mut out = format!(
        "| {} |\n|{}\n",
        header.join(" | "),
        "---|".repeat(header.len())
    );
    for row in rows {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {} |", row.join(" | "));
    }
    out
}

/// A word in a list of figures.
fn word(value: &Value, key: &str) -> Result<String> {
    let word = value[key].as_str();
    Ok(word.with_context(|| format!("no word {key}"))?.to_string())
}

/// `docs/accuracy.md`.
pub fn accuracy(models: &[Model]) -> Result<String> {
    let mut page = include_str!("../accuracy.md").to_string();
    let tables: [(&str, Render); 18] = [
        ("photographs", photographs::photographs),
        ("parts", photographs::parts),
        ("calibration", photographs::calibration),
        ("turned", photographs::turned),
        ("poor", photographs::poor),
        ("clips", clips::clips),
        ("clip-by-clip", clips::clip_by_clip),
        ("eyes", clips::eyes),
        ("real-eyes", clips::real_eyes),
        ("stills", clips::stills),
        ("webcams", clips::webcams),
        ("smoothed", clips::smoothed),
        ("recovery", search::recovery),
        ("first-search", search::first_search),
        ("fast", search::fast),
        ("faceless", search::faceless),
        ("departure", search::departure),
        ("cost", search::cost),
    ];
    for (name, render) in tables {
        let place = format!("<!-- table: {name} -->\n");
        anyhow::ensure!(
            page.contains(&place),
            "the template has no place for {name}"
        );
        page = page.replace(&place, &render(models)?);
    }
    Ok(page)
}

/// One row per model and item: `row(model)` gives the cells after the item's and the model's name.
fn by_model(
    models: &[Model],
    items: &[(&str, &str)],
    row: impl Fn(&Model, &str) -> Result<Row>,
) -> Result<Vec<Row>> {
    let mut rows = vec![];
    for (title, pointer) in items {
        for model in models {
            let mut cells = vec![title.to_string(), model.name.clone()];
            cells.extend(row(model, pointer)?);
            rows.push(cells);
        }
    }
    Ok(rows)
}

/// One row per figure and one column per model.
fn side_by_side(models: &[Model], first: &str, rows: &[(&str, Text<'_>)]) -> Result<String> {
    let mut header = vec![first];
    header.extend(models.iter().map(|model| model.name.as_str()));
    let mut cells = vec![];
    for (title, figure) in rows {
        let mut row = vec![title.to_string()];
        for model in models {
            row.push(figure(model)?);
        }
        cells.push(row);
    }
    Ok(table(&header, &cells))
}

/// The table of figures in `README.md`.
pub fn readme(models: &[Model]) -> Result<String> {
    let angle = |m: &Model| -> Result<String> {
        let band = |name: &str| m.at(&format!("/clips/pose/yaw_bands/{name}/e_m_deg"));
        Ok(format!(
            "{}°, {}°",
            band("0-45")?.fixed(1),
            band("45-90")?.fixed(1)
        ))
    };
    let recovery = |m: &Model| -> Result<String> {
        let at = |key: &str| m.at(&format!("/lost_and_found/recovery/not_mirrored/{key}"));
        Ok(format!(
            "{}, {}",
            at("median_frames")?.count(),
            at("worst_frames")?.count()
        ))
    };
    let faceless = |m: &Model| -> Result<String> {
        let at = |key: &str| m.at(&format!("/lost_and_found/faceless/0/result/{key}"));
        Ok(format!(
            "{} of {}",
            at("tracked")?.count(),
            at("frames")?.count()
        ))
    };
    side_by_side(
        models,
        "figure",
        &[
            ("511 photographs of 42 people: faces found", &|m| {
                Ok(m.at("/photographs/found")?.percent(1) + " %")
            }),
            (
                "… mean error of 68 landmarks, in % of the distance between the outer eye corners",
                &|m| Ok(m.at("/photographs/nme68_mean")?.percent(2)),
            ),
            ("12 rendered clips, 4,093 frames: tracked", &|m| {
                Ok(m.at("/clips/pose/p_s")?.percent(2) + " %")
            }),
            (
                "… mean error of yaw, pitch and roll, up to 45° of yaw and above",
                &angle,
            ),
            (
                "a lost face comes back: frames until it is tracked, median and worst",
                &recovery,
            ),
            (
                "pictures without people: frames with a tracked face",
                &faceless,
            ),
            ("a tracking step, one thread", &|m| {
                Ok(m.at("/bench/tracking/median_ns")?.over(1e6, 1) + " ms")
            }),
            ("size of the model", &|m| {
                Ok(m.at("/bench/model_bytes")?.over(1024.0, 0) + " KiB")
            }),
        ],
    )
}
