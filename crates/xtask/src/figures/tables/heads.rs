//! Tables of real heads that are turned.

use std::fmt::Write as _;

use anyhow::{Context, Result};

use super::table::{Model, Row, by_model, table};

/// Where the figures of the profiles among the photographs are.
pub const PROFILES: &str = "/profiles/kinds/profile";
/// Where the figures of heads with labelled angles are: the camera left unknown, and told.
const CAMERAS: [&str; 2] = ["/angles/unknown", "/angles/told"];
/// Yaw relative to the line of sight, and along the camera's axes.
const ANGLES: [&str; 2] = ["facing", "axis"];
/// Header of these angles for both cameras, each with its error.
const ANGLE_HEADER: [&str; 8] = ["facing", "err", "axis", "err", "told", "err", "axis", "err"];
const PITCH_BANDS: [(&str, &str); 3] = [("0-15", "to 15°"), ("15-30", "30°"), ("30-60", "60°")];

fn found_cells(model: &Model, pointer: &str) -> Result<Row> {
    let at = |key: &str| model.at(&format!("{pointer}/{key}"));
    Ok(vec![
        at("count")?.count(),
        at("found")?.percent(1),
        at("at_once")?.percent(1),
    ])
}

pub fn profiles(models: &[Model]) -> Result<String> {
    let kinds = [
        ("frontal", "/profiles/kinds/frontal"),
        ("profile", PROFILES),
    ];
    let rows = by_model(models, &kinds, |model, pointer| {
        let mut cells = found_cells(model, pointer)?;
        for part in ["inner", "jaw"] {
            cells.push(model.at(&format!("{pointer}/{part}"))?.percent(2));
        }
        Ok(cells)
    })?;
    let header = "pictures,model,count,found %,at once %,inner %,jaw %";
    Ok(table(&header.split(',').collect::<Vec<_>>(), &rows))
}

pub fn profile_yaw(models: &[Model]) -> Result<String> {
    let bands = [
        ("to 30°", "/profiles/yaw_bands/0-30"),
        ("30° to 60°", "/profiles/yaw_bands/30-60"),
        ("60° to 75°", "/profiles/yaw_bands/60-75"),
        ("from 75°", "/profiles/yaw_bands/75-"),
    ];
    let rows = by_model(models, &bands, |model, pointer| {
        let at = |key: &str| model.at(&format!("{pointer}/{key}"));
        let mut cells = found_cells(model, pointer)?;
        cells.extend([at("inner")?.percent(2), at("jaw")?.percent(2)]);
        for key in ["geometric_deg", "facing_deg", "difference_deg"] {
            cells.push(at(key)?.fixed(1));
        }
        Ok(cells)
    })?;
    let header = "\\|yaw\\|,model,count,found %,at once %,inner %,jaw %,geometric,facing,apart";
    Ok(table(&header.split(',').collect::<Vec<_>>(), &rows))
}

/// Medians and errors of an angle for both cameras; `of` is where the label is within a camera.
fn angle_cells(model: &Model, of: &str) -> Result<Row> {
    let mut cells = vec![];
    for camera in CAMERAS {
        for angle in ANGLES {
            for key in ["median", "error"] {
                cells.push(model.at(&format!("{camera}/{of}/{angle}/{key}"))?.fixed(1));
            }
        }
    }
    Ok(cells)
}

/// Rows by label and model.
fn labels(models: &[Model], block: &str) -> Result<Vec<Row>> {
    let first = models.first().context("no models")?;
    let mut rows = vec![];
    for label in first.keys(&format!("{}/{block}/labels", CAMERAS[0]))? {
        let of = format!("{block}/labels/{label}");
        let title = label + "°";
        let items = [(title.as_str(), of.as_str())];
        rows.extend(by_model(models, &items, |model, of| {
            let mut cells = found_cells(model, &format!("{}/{of}", CAMERAS[0]))?;
            cells.extend(angle_cells(model, of)?);
            Ok(cells)
        })?);
    }
    Ok(rows)
}

fn label_table(first: &str, rows: &[Row]) -> String {
    let mut header = vec![first, "model", "count", "found", "at once"];
    header.extend(ANGLE_HEADER);
    table(&header, rows)
}

pub fn angles(models: &[Model]) -> Result<String> {
    let mut out = String::new();
    for (band, title) in PITCH_BANDS {
        let rows = labels(models, &format!("yaw_by_pitch/{band}"))?;
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "\\|pitch\\| {title}:\n\n{}\n",
            label_table("\\|yaw\\|", &rows)
        );
    }
    Ok(out.trim_end().to_string() + "\n")
}

pub fn slopes(models: &[Model]) -> Result<String> {
    let blocks = PITCH_BANDS.map(|(band, title)| {
        let title = format!("yaw, \\|pitch\\| {title}");
        (title, format!("yaw_by_pitch/{band}"))
    });
    let mut items: Vec<(&str, &str)> = blocks.iter().map(|(a, b)| (&**a, &**b)).collect();
    items.push(("pitch", "pitch"));
    let rows = by_model(models, &items, |model, block| {
        let mut cells = vec![];
        for camera in CAMERAS {
            for angle in ANGLES {
                let slope = format!("{camera}/{block}/slope/{angle}");
                cells.push(model.at(&slope)?.fixed(2));
            }
        }
        Ok(cells)
    })?;
    let header = [
        "slope of",
        "model",
        "facing",
        "axis",
        "told: facing",
        "axis",
    ];
    Ok(table(&header, &rows))
}

pub fn pitch(models: &[Model]) -> Result<String> {
    Ok(label_table("pitch", &labels(models, "pitch")?))
}

/// Medians of the yaw relative to the line of sight at labels of 30°, 60° and 90°.
pub fn medians(model: &Model) -> Result<String> {
    let median = |label: &str| {
        let of = format!("yaw_by_pitch/0-15/labels/{label}/facing/median");
        Ok(model.at(&format!("{}/{of}", CAMERAS[0]))?.fixed(0) + "°")
    };
    let medians = ["30", "60", "90"].map(median).into_iter();
    Ok(medians.collect::<Result<Vec<_>>>()?.join(", "))
}
