//! Tables of labelled photographs.

use anyhow::{Context, Result};

use super::table::{Model, Row, by_model, side_by_side, table, word};

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

pub fn photographs(models: &[Model]) -> Result<String> {
    let bands = [
        ("all", "/photographs"),
        ("frontal", "/photographs/yaw_bands/frontal"),
        ("turned", "/photographs/yaw_bands/turned"),
        ("far turned", "/photographs/yaw_bands/far_turned"),
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

pub fn parts(models: &[Model]) -> Result<String> {
    let names = ["jaw", "brows", "nose", "eyes", "mouth"];
    let mut rows = vec![];
    for model in models {
        let mut row = vec![model.name.clone()];
        for name in names {
            row.push(model.at(&format!("/photographs/parts/{name}"))?.percent(2));
        }
        rows.push(row);
    }
    let mut header = vec!["model"];
    header.extend(names);
    Ok(table(&header, &rows))
}

pub fn calibration(models: &[Model]) -> Result<String> {
    side_by_side(
        models,
        "expected calibration error",
        &[
            ("of the landmarks", &|m| {
                Ok(m.at("/photographs/calibration_landmarks")?.fixed(3))
            }),
            ("of the face", &|m| {
                Ok(m.at("/photographs/calibration_face")?.fixed(3))
            }),
        ],
    )
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
    for (index, item) in first.list("/photographs_poor")?.iter().enumerate() {
        let options = format!("`{}`", word(item, "options")?);
        let pointer = format!("/photographs_poor/{index}/result");
        rows.extend(by_model(models, &[(&options, &pointer)], landmark_cells)?);
    }
    let mut header = vec!["options", "model"];
    header.extend(LANDMARK_HEADER);
    Ok(table(&header, &rows))
}
