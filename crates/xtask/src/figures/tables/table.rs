//! Markdown tables of the figures of all models.

use std::fmt::Write as _;

use anyhow::{Context, Result};

pub use super::model::Model;

/// The cells of one row.
pub type Row = Vec<String>;
/// The text of one figure of a model.
pub type Text<'a> = &'a dyn Fn(&Model) -> Result<String>;

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

/// One row per model and item: `row(model)` gives the cells after the item's and the model's name.
pub fn by_model(
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
pub fn side_by_side(models: &[Model], first: &str, rows: &[(&str, Text<'_>)]) -> Result<String> {
    let mut cells = vec![];
    for (title, figure) in rows {
        let mut row = vec![title.to_string()];
        for model in models {
            row.push(figure(model)?);
        }
        cells.push(row);
    }
    Ok(columns(models, first, &cells))
}

/// The same, a line for each row: `title = pointer decimals unit`, where the unit `%` makes a
/// percentage of a share, or `title = pointer part of all`.
pub fn figures(models: &[Model], first: &str, lines: &str) -> Result<String> {
    let parts = |line| {
        let (title, figure) = str::split_once(line, " = ")?;
        let (pointer, shown) = figure.split_once(' ')?;
        Some((title, pointer, shown))
    };
    let mut cells = vec![];
    for line in lines.lines() {
        let (title, pointer, shown) = parts(line).with_context(|| line.to_owned())?;
        let mut row = vec![title.to_string()];
        for model in models {
            let (decimals, unit) = shown.split_at(1);
            row.push(match (shown.split_once(" of "), unit) {
                (Some((part, all)), _) => model.of(pointer, [part, all])?,
                (None, "%") => model.at(pointer)?.percent(decimals.parse()?),
                (None, unit) => model.at(pointer)?.fixed(decimals.parse()?) + unit,
            });
        }
        cells.push(row);
    }
    Ok(columns(models, first, &cells))
}

/// A table with a column for each model.
fn columns(models: &[Model], first: &str, cells: &[Row]) -> String {
    let mut header = vec![first];
    header.extend(models.iter().map(|model| model.name.as_str()));
    table(&header, cells)
}

/// Writes one table of all models.
pub type Render = fn(&[Model]) -> Result<String>;

/// A template with its tables.
pub fn fill(template: &str, tables: &[(&str, Render)], models: &[Model]) -> Result<String> {
    let mut page = template.to_string();
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
