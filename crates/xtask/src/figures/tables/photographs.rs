//! Tables of labelled photographs.

use anyhow::{Context, Result};

use super::table::{Model, Render, Row, by_model, figures, fill, table};

const LANDMARK_HEADER: [&str; 5] = ["found %", "NME68 %", "median %", "NME51 %", "failures %"];

/// The figures of `eval landmarks` at a pointer.
fn landmark_cells(model: &Model, pointer: &str) -> Result<Row> {
    let at = |key: &str| model.at(&format!("{pointer}/{key}"));
    Ok(vec![
        at("found")?.percent(2),
        at("nme68_mean")?.percent(2),
        at("nme68_median")?.percent(2),
        at("nme51_mean")?.percent(2),
        at("failure")?.percent(2),
    ])
}

/// Where the figures of manual labels are.
const MANUAL: &str = "/photographs_manual";
const AUTOMATIC: &str = "/photographs";

/// Whether all models were measured on manual labels; figures of an earlier `measure` were not.
fn has_manual(models: &[Model]) -> bool {
    models.iter().all(|m| m.has(MANUAL))
}

/// Where the first figures of photographs are, and what they are.
pub fn first_set(models: &[Model]) -> (&'static str, &'static str) {
    match has_manual(models) {
        true => (MANUAL, "202 photographs with manual labels: faces found"),
        false => (AUTOMATIC, "511 photographs of 42 people: faces found"),
    }
}

/// The section of manual labels; nothing without their figures.
pub fn manual(models: &[Model]) -> Result<String> {
    if !has_manual(models) {
        return Ok(String::new());
    }
    let tables: [(&str, Render); 3] = [
        ("bands", |m| by_bands(m, MANUAL)),
        ("parts", |m| by_parts(m, MANUAL)),
        ("sizes", sizes),
    ];
    fill(include_str!("../manual.md"), &tables, models)
}

/// What to know about the labels.
pub fn labels(models: &[Model]) -> Result<String> {
    let text = match has_manual(models) {
        true => {
            "- Of the photographs, the first set has labels that people set. Those of the second \
             come from\n  an automatic annotator: their own error is 2 to 3 %, and their \
             convention is another.\n"
        }
        false => {
            "- The labels of the photographs come from an automatic annotator. Their own error is \
             2 to 3 %.\n"
        }
    };
    Ok(text.into())
}

/// What to know about the automatic labels beside manual ones.
pub fn automatic(models: &[Model]) -> Result<String> {
    let text = "These labels are automatic and follow another convention than the manual ones: the \
                same model has\nother errors here, and the figures of the two sets cannot be \
                compared.\n\n";
    Ok(match has_manual(models) {
        true => text.into(),
        false => String::new(),
    })
}

pub fn photographs(models: &[Model]) -> Result<String> {
    by_bands(models, AUTOMATIC)
}

pub fn parts(models: &[Model]) -> Result<String> {
    by_parts(models, AUTOMATIC)
}

fn by_bands(models: &[Model], set: &str) -> Result<String> {
    let band = |name: &str| format!("{set}/yaw_bands/{name}");
    let (frontal, turned, far) = (band("frontal"), band("turned"), band("far_turned"));
    let bands = [
        ("all", set),
        ("frontal", frontal.as_str()),
        ("turned", turned.as_str()),
        ("far turned", far.as_str()),
    ];
    let rows = by_model(models, &bands, |model, pointer| {
        let mut cells = vec![model.at(&format!("{pointer}/images"))?.count()];
        cells.extend(landmark_cells(model, pointer)?);
        Ok(cells)
    })?;
    let mut header = vec!["pictures", "model", "count"];
    header.extend(LANDMARK_HEADER);
    Ok(table(&header, &rows))
}

fn by_parts(models: &[Model], set: &str) -> Result<String> {
    let names = ["jaw", "brows", "nose", "eyes", "mouth"];
    let mut rows = vec![];
    for model in models {
        let mut row = vec![model.name.clone()];
        for name in names {
            row.push(model.at(&format!("{set}/parts/{name}"))?.percent(2));
        }
        rows.push(row);
    }
    let mut header = vec!["model"];
    header.extend(names);
    Ok(table(&header, &rows))
}

/// Errors over other sizes, and areas under the cumulative error distribution.
const SIZES: &str = "\
NME68 by box = /photographs_manual/nme68_box 2%
NME51 by box = /photographs_manual/nme51_box 2%
NME68 by eye centres = /photographs_manual/nme68_pupils 2%
NME51 by eye centres = /photographs_manual/nme51_pupils 2%
area to 8 %, 68 landmarks = /photographs_manual/auc68 2%
area to 8 %, 51 landmarks = /photographs_manual/auc51 2%
area to 10 %, 68 landmarks = /photographs_manual/auc68_to_10 2%
area to 10 %, 51 landmarks = /photographs_manual/auc51_to_10 2%";

fn sizes(models: &[Model]) -> Result<String> {
    figures(models, "in %", SIZES)
}

const CALIBRATION: &str = "\
of the landmarks = /photographs/calibration_landmarks 3
of the face = /photographs/calibration_face 3";

pub fn calibration(models: &[Model]) -> Result<String> {
    figures(models, "expected calibration error", CALIBRATION)
}

pub fn turned(models: &[Model]) -> Result<String> {
    let items = [
        ("`--roll 30`", "/photographs_turned/0/result"),
        ("`--roll 45`", "/photographs_turned/1/result"),
        ("`--roll -45`", "/photographs_turned/2/result"),
    ];
    let mut header = vec!["options", "model"];
    header.extend(LANDMARK_HEADER);
    Ok(table(&header, &by_model(models, &items, landmark_cells)?))
}

pub fn poor(models: &[Model]) -> Result<String> {
    let mut rows = vec![];
    let first = models.first().context("no models")?;
    for item in first.list("/photographs_poor")? {
        let options = format!("`{}`", first.word(&format!("{item}/options"))?);
        let pointer = format!("{item}/result");
        rows.extend(by_model(models, &[(&options, &pointer)], landmark_cells)?);
    }
    let mut header = vec!["options", "model"];
    header.extend(LANDMARK_HEADER);
    Ok(table(&header, &rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn manual_labels_come_first_once_they_are_measured() {
        let set = json!({"images": 202, "found": 0.965, "nme68_mean": 0.0465, "nme68_median": 0.04,
            "nme51_mean": 0.0372, "failure": 0.035, "auc68": 0.4, "auc51": 0.5,
            "auc68_to_10": 0.45, "auc51_to_10": 0.55, "nme68_box": 0.02, "nme51_box": 0.018,
            "nme68_pupils": 0.065, "nme51_pupils": 0.052,
            "parts": {"jaw": 0.1, "brows": 0.1, "nose": 0.1, "eyes": 0.1, "mouth": 0.1}});
        let mut manual_set = set.clone();
        manual_set["yaw_bands"] = json!({"frontal": set, "turned": set, "far_turned": set});
        let model = |figures| Model::new("default", figures);
        let without = [model(json!({}))];
        assert_eq!(
            manual(&without).unwrap() + &automatic(&without).unwrap(),
            ""
        );
        let with = [model(json!({"photographs_manual": manual_set}))];
        let text = manual(&with).unwrap();
        assert!(
            text.contains("| all | default | 202 | 96.50 | 4.65 |"),
            "{text}"
        );
        assert!(text.contains("| NME51 by eye centres | 5.20 |") && !text.contains("<!--"));
        assert!(
            labels(&with)
                .unwrap()
                .lines()
                .all(|line| line.chars().count() <= 100)
        );
    }
}
