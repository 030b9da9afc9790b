//! Tables of the search, and of time and memory.

use anyhow::{Context, Result};

use super::super::value::Figure;
use super::table::{Model, by_model, figures, side_by_side, table};

pub fn recovery(models: &[Model]) -> Result<String> {
    let items = [
        (
            "half of them mirrored",
            "/lost_and_found/recovery/half_mirrored",
        ),
        ("as they are", "/lost_and_found/recovery/not_mirrored"),
        (
            "new tracker each time",
            "/lost_and_found/recovery/first_seen",
        ),
    ];
    let rows = by_model(models, &items, |model, pointer| {
        let at = |key: &str| model.at(&format!("{pointer}/{key}"));
        Ok(vec![
            at("median_frames")?.count(),
            at("worst_frames")?.count(),
            at("never")?.count(),
            model.of(pointer, ["false_tracks", "faceless_frames"])?,
        ])
    })?;
    let header = [
        "pieces",
        "model",
        "median",
        "worst",
        "never",
        "faceless frames tracked",
    ];
    Ok(table(&header, &rows))
}

const FIRST_SEARCH: &str = "\
found within 90 frames = /first_lock found of searches
frames until tracked, median = /first_lock/median_frames 0
frames until tracked, worst = /first_lock/worst_frames 0";

pub fn first_search(models: &[Model]) -> Result<String> {
    figures(models, "first searches", FIRST_SEARCH)
}

/// A table with a row per case: its name, its frames, and the tracked ones of each model.
fn tracked_table(case: &str, models: &[Model], rows: &[Vec<String>]) -> String {
    let tracked = models
        .iter()
        .map(|model| format!("{}: tracked", model.name));
    let header: Vec<String> = [case.into(), "frames".into()]
        .into_iter()
        .chain(tracked)
        .collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    table(&header, rows)
}

pub fn fast(models: &[Model]) -> Result<String> {
    let first = models.first().context("no models")?;
    let mut rows = vec![];
    for item in first.list("/fast_motion")? {
        let pointer = |key: &str| format!("{item}/{key}");
        let mut row = vec![
            first.at(&pointer("every"))?.count(),
            first.at(&pointer("frames"))?.count(),
        ];
        for model in models {
            row.push(model.at(&pointer("tracked"))?.count());
        }
        rows.push(row);
    }
    Ok(tracked_table("every n-th frame", models, &rows))
}

pub fn faceless(models: &[Model]) -> Result<String> {
    let first = models.first().context("no models")?;
    let mut rows = vec![];
    for item in first.list("/lost_and_found/faceless")? {
        let options = first.word(&format!("{item}/options"))?;
        let pointer = |key: &str| format!("{item}/result/{key}");
        let mut row = vec![
            if options.is_empty() {
                "none".into()
            } else {
                format!("`{options}`")
            },
            first.at(&pointer("frames"))?.count(),
        ];
        for model in models {
            row.push(model.at(&pointer("tracked"))?.count());
        }
        rows.push(row);
    }
    Ok(tracked_table("further options", models, &rows))
}

pub fn departure(models: &[Model]) -> Result<String> {
    let sum = |m: &Model, key: &str| -> Result<Figure> {
        let ways = m.list("/lost_and_found/departure")?;
        let counts = ways.iter().map(|way| m.at(&format!("{way}/{key}")));
        let sum = counts.reduce(|a, b| Ok(a?.plus(b?)));
        sum.context("no ways")?
    };
    let of = |m: &Model, tracked: &str, frames: &str| -> Result<String> {
        let (tracked, frames) = (sum(m, tracked)?, sum(m, frames)?);
        Ok(format!("{} of {}", tracked.count(), frames.count()))
    };
    side_by_side(
        models,
        "frames tracked, all sixteen ways",
        &[
            ("while nobody is there", &|m| {
                of(m, "absent_tracked", "absent_frames")
            }),
            ("while nine tenths of the landmarks are in view", &|m| {
                of(m, "present_tracked", "present_frames")
            }),
        ],
    )
}

pub fn cost(models: &[Model]) -> Result<String> {
    let ms = |m: &Model, key: &str| -> Result<String> {
        Ok(m.at(&format!("/bench/{key}"))?.over(1e6, 2) + " ms")
    };
    let bytes = |m: &Model, key: &str| -> Result<String> {
        Ok(m.at(&format!("/bench/{key}"))?.count() + " bytes")
    };
    side_by_side(
        models,
        "cost",
        &[
            ("a tracking step, median", &|m| ms(m, "tracking/median_ns")),
            ("a searching step, median", &|m| {
                ms(m, "searching/median_ns")
            }),
            ("the worst-case step", &|m| ms(m, "worst_ns")),
            ("processor", &|m| m.word("/processor")),
            ("kernel", &|m| m.word("/bench/kernel")),
            ("model", &|m| bytes(m, "model_bytes")),
            ("model: CRC-32", &|m| m.word("/model/crc32")),
            ("tracker memory", &|m| bytes(m, "tracker_bytes")),
            ("stack of the steps", &|m| bytes(m, "peak_stack_bytes")),
        ],
    )
}
