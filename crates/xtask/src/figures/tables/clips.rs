//! Tables of clips: pose, eyes, jitter.

use std::fmt::Write as _;

use anyhow::{Context, Result};

use super::table::{Model, by_model, side_by_side, table};

pub fn clips(models: &[Model]) -> Result<String> {
    let angle = |m: &Model, band: &str| m.at(&format!("/clips/pose/yaw_bands/{band}/e_m_deg"));
    let pose = |m: &Model, key: &str| m.at(&format!("/clips/pose/{key}"));
    side_by_side(
        models,
        "all twelve clips",
        &[
            ("frames that count", &|m| Ok(pose(m, "counted")?.count())),
            ("frames tracked, %", &|m| Ok(pose(m, "p_s")?.percent(2))),
            ("mean angle error, \\|yaw\\| to 45°", &|m| {
                Ok(angle(m, "0-45")?.fixed(2) + "°")
            }),
            ("mean angle error, \\|yaw\\| above 45°", &|m| {
                Ok(angle(m, "45-90")?.fixed(2) + "°")
            }),
            (
                "error of yaw",
                &|m| Ok(pose(m, "e_yaw_deg")?.fixed(2) + "°"),
            ),
            ("error of pitch", &|m| {
                Ok(pose(m, "e_pitch_deg")?.fixed(2) + "°")
            }),
            ("error of roll", &|m| {
                Ok(pose(m, "e_roll_deg")?.fixed(2) + "°")
            }),
            ("error of position", &|m| {
                Ok(pose(m, "translation_mm")?.fixed(1) + " mm")
            }),
            ("visible inner landmarks, %", &|m| {
                Ok(pose(m, "landmarks")?.percent(2))
            }),
            ("`visibility`: area under the ROC", &|m| {
                Ok(pose(m, "visibility_auc")?.fixed(3))
            }),
            ("frames with an angle error above 30°", &|m| {
                Ok(pose(m, "wrong")?.count())
            }),
            ("sign flips of yaw beyond 60°", &|m| {
                Ok(pose(m, "sign_flips")?.count())
            }),
            ("half covered: frames", &|m| {
                Ok(pose(m, "covered/counted")?.count())
            }),
            ("half covered: tracked, %", &|m| {
                Ok(pose(m, "covered/p_s")?.percent(2))
            }),
            ("half covered: mean angle error", &|m| {
                Ok(pose(m, "covered/e_m_deg")?.fixed(2) + "°")
            }),
            ("ten minutes: mean angle error, first minute", &|m| {
                Ok(m.at("/drift/e_m_deg_first")?.fixed(3) + "°")
            }),
            ("ten minutes: mean angle error, last minute", &|m| {
                Ok(m.at("/drift/e_m_deg_last")?.fixed(3) + "°")
            }),
        ],
    )
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

pub fn eyes(models: &[Model]) -> Result<String> {
    let eyes = |m: &Model, key: &str| m.at(&format!("/clips/eyes/{key}"));
    side_by_side(
        models,
        "all twelve clips",
        &[
            ("frames within ±45° of yaw", &|m| {
                Ok(eyes(m, "frames")?.count())
            }),
            ("of them with a known eye", &|m| {
                Ok(eyes(m, "known")?.count())
            }),
            ("`eye_open` with the true blink weight", &|m| {
                Ok(eyes(m, "eye_open")?.fixed(3))
            }),
            ("`eye_open` with the true aspect ratio", &|m| {
                Ok(eyes(m, "eye_open_ear")?.fixed(3))
            }),
            ("aspect ratio of the landmarks with the true one", &|m| {
                Ok(eyes(m, "ear")?.fixed(3))
            }),
            ("closures of 200 ms and more", &|m| {
                Ok(eyes(m, "closures")?.count())
            }),
            ("of them missed", &|m| Ok(eyes(m, "missed")?.count())),
            ("closures invented", &|m| Ok(eyes(m, "invented")?.count())),
        ],
    )
}

pub fn real_eyes(models: &[Model]) -> Result<String> {
    let found = |m: &Model, kind: &str| -> Result<String> {
        let at = |key: &str| m.at(&format!("/real_eyes/{kind}/{key}"));
        Ok(format!(
            "{} of {}",
            at("found")?.count(),
            at("looked_at")?.count()
        ))
    };
    side_by_side(
        models,
        "single eyes",
        &[
            ("found, of the open ones", &|m| found(m, "open")),
            ("found, of the shut ones", &|m| found(m, "closed")),
            ("median gap of the lids, open", &|m| {
                Ok(m.at("/real_eyes/open/median_gap")?.fixed(3))
            }),
            ("median gap of the lids, shut", &|m| {
                Ok(m.at("/real_eyes/closed/median_gap")?.fixed(3))
            }),
            ("area under the ROC of the gap", &|m| {
                Ok(m.at("/real_eyes/gap_auc")?.fixed(3))
            }),
            ("network: area under the ROC", &|m| {
                Ok(m.at("/real_eyes/network/auc")?.fixed(4))
            }),
            ("network: right, %", &|m| {
                Ok(m.at("/real_eyes/network/right")?.percent(1))
            }),
            ("near-infrared: area under the ROC", &|m| {
                Ok(m.at("/real_eyes/near_infrared/auc")?.fixed(4))
            }),
            ("near-infrared: right, %", &|m| {
                Ok(m.at("/real_eyes/near_infrared/right")?.percent(1))
            }),
        ],
    )
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
            format!("{} of {}", at("tracked")?.count(), at("frames")?.count()),
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
