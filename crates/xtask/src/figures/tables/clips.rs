//! Tables of clips: pose, eyes, jitter.

use std::fmt::Write as _;

use anyhow::{Context, Result};

use super::table::{Model, by_model, figures, table};

const CLIPS: &str = "\
frames that count = /clips/pose/counted 0
frames tracked, % = /clips/pose/p_s 2%
mean angle error, \\|yaw\\| to 45° = /clips/pose/yaw_bands/0-45/e_m_deg 2°
mean angle error, \\|yaw\\| above 45° = /clips/pose/yaw_bands/45-90/e_m_deg 2°
error of yaw = /clips/pose/e_yaw_deg 2°
error of pitch = /clips/pose/e_pitch_deg 2°
error of roll = /clips/pose/e_roll_deg 2°
error of position = /clips/pose/translation_mm 1 mm
visible inner landmarks, % = /clips/pose/landmarks 2%
`visibility`: area under the ROC = /clips/pose/visibility_auc 3
frames with an angle error above 30° = /clips/pose/wrong 0
sign flips of yaw beyond 60° = /clips/pose/sign_flips 0
half covered: frames = /clips/pose/covered/counted 0
half covered: tracked, % = /clips/pose/covered/p_s 2%
half covered: mean angle error = /clips/pose/covered/e_m_deg 2°
ten minutes: mean angle error, first minute = /drift/e_m_deg_first 3°
ten minutes: mean angle error, last minute = /drift/e_m_deg_last 3°";

pub fn clips(models: &[Model]) -> Result<String> {
    figures(models, "all twelve clips", CLIPS)
}

pub fn clip_by_clip(models: &[Model]) -> Result<String> {
    let mut out = String::new();
    for model in models {
        let mut rows = vec![];
        for name in model.keys("/clips/pose/clips")? {
            let at = |key: &str| model.at(&format!("/clips/pose/clips/{name}{key}"));
            rows.push(vec![
                name.trim_end_matches(".csv").to_string(),
                at("/counted")?.count(),
                at("/p_s")?.percent(2),
                at("/e_yaw_deg")?.fixed(2),
                at("/e_pitch_deg")?.fixed(2),
                at("/e_roll_deg")?.fixed(2),
                at("/landmarks")?.percent(2),
                at("/visibility_auc")?.fixed(3),
            ]);
        }
        let header = ["clip", "frames", "tracked %", "yaw °", "pitch °", "roll °"];
        let header: Vec<_> = header.into_iter().chain(["landmarks %", "ROC"]).collect();
        let _ = write!(out, "Model {}:\n\n{}\n", model.name, table(&header, &rows));
    }
    Ok(out.trim_end().to_string() + "\n")
}

const EYES: &str = "\
frames within ±45° of yaw = /clips/eyes/frames 0
of them with a known eye = /clips/eyes/known 0
`eye_open` with the true blink weight = /clips/eyes/eye_open 3
`eye_open` with the true aspect ratio = /clips/eyes/eye_open_ear 3
aspect ratio of the landmarks with the true one = /clips/eyes/ear 3
closures of 200 ms and more = /clips/eyes/closures 0
of them missed = /clips/eyes/missed 0
closures invented = /clips/eyes/invented 0";

pub fn eyes(models: &[Model]) -> Result<String> {
    figures(models, "all twelve clips", EYES)
}

const REAL_EYES: &str = "\
found, of the open ones = /real_eyes/open found of looked_at
found, of the shut ones = /real_eyes/closed found of looked_at
median gap of the lids, open = /real_eyes/open/median_gap 3
median gap of the lids, shut = /real_eyes/closed/median_gap 3
area under the ROC of the gap = /real_eyes/gap_auc 3
network: area under the ROC = /real_eyes/network/auc 4
network: right, % = /real_eyes/network/right 1%
near-infrared: area under the ROC = /real_eyes/near_infrared/auc 4
near-infrared: right, % = /real_eyes/near_infrared/right 1%";

pub fn real_eyes(models: &[Model]) -> Result<String> {
    figures(models, "single eyes", REAL_EYES)
}

pub fn stills(models: &[Model]) -> Result<String> {
    let first = models.first().context("no models")?;
    let mut rows = vec![];
    for still in first.list("/stills")? {
        let pointer = |key: &str| format!("{still}/{key}");
        let mut row = vec![
            format!("to {}°", first.at(&pointer("to_deg"))?.count()),
            first.at(&pointer("stills"))?.count(),
        ];
        for model in models {
            let (all, found) = (model.at(&pointer("stills"))?, model.at(&pointer("found"))?);
            row.push(found.share_of(all).percent(1));
        }
        rows.push(row);
    }
    let mut header = vec!["true \\|yaw\\|".to_string(), "stills".to_string()];
    header.extend(
        models
            .iter()
            .map(|model| format!("{}: found %", model.name)),
    );
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    Ok(table(&header, &rows))
}

pub fn webcams(models: &[Model]) -> Result<String> {
    let items = [("webcam-a", "/webcams/0"), ("webcam-b", "/webcams/1")];
    let rows = by_model(models, &items, |model, pointer| {
        let at = |key: &str| model.at(&format!("{pointer}/{key}"));
        Ok(vec![
            model.of(pointer, ["tracked", "frames"])?,
            at("raw/jitter_px")?.fixed(2),
            at("raw/picture_px")?.fixed(2),
            at("raw/rest_px")?.fixed(2),
            at("smoothed/jitter_px")?.fixed(2),
        ])
    })?;
    let header = [
        "clip", "model", "tracked", "raw", "picture", "rest", "smoothed",
    ];
    Ok(table(&header, &rows))
}

pub fn smoothed(models: &[Model]) -> Result<String> {
    let mut rows = vec![];
    for model in models {
        for item in model.list("/smoothed_clips")? {
            let name = model.word(&format!("{item}/clip"))?;
            let raw = format!("/clips/pose/clips/{name}.csv");
            let smoothed = format!("{item}/result");
            let at = |pointer: &str, key: &str| model.at(&format!("{pointer}/{key}"));
            rows.push(vec![
                name,
                model.name.clone(),
                at(&raw, "e_m_deg")?.fixed(2),
                at(&smoothed, "e_m_deg")?.fixed(2),
                at(&raw, "landmarks")?.percent(2),
                at(&smoothed, "landmarks")?.percent(2),
            ]);
        }
    }
    let header = [
        "clip",
        "model",
        "raw °",
        "smoothed °",
        "raw landmarks %",
        "smoothed %",
    ];
    Ok(table(&header, &rows))
}
