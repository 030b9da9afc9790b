//! `cargo xtask history`: a line of figures for each version, in `docs/history.json`, and their
//! plot.
//!
//! The line of the current version is made of what is committed: the figures of the models, and
//! rows of docs/performance.md and docs/memory.md, which tests compare with what they measure.

use anyhow::{Context, Result};
use plotters::prelude::*;
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::process::Command;

use super::value::lines;
use super::{MODELS, documented, figures_of};
use crate::{output_of, root};

/// Keys of what a tracking step costs, and the kernels as docs/performance.md names them.
const KERNELS: [(&str, &str); 5] = [
    ("instructions_portable", "portable"),
    ("instructions_sse2", "SSE2"),
    ("instructions_avx2", "AVX2"),
    ("instructions_neon", "NEON"),
    ("instructions_dotprod", "NEON with dot product"),
];

/// Keys of what is known of a model, which its name follows, and where its figures have it.
const OF_MODELS: [(&str, &str); 3] = [
    ("found_", "/photographs_manual/found"),
    ("error_", "/photographs_manual/nme68_mean"),
    ("bytes_", "/bench/model_bytes"),
];

/// The key of the library's size, and the row of docs/memory.md.
const CODE: (&str, &str) = ("bytes_code", "code and constants without model, AArch64");

/// What the plot shows: a title, the unit, keys and names. The portable kernel, for machines
/// without one of their own, takes five times as many instructions as any other.
type Panel = (&'static str, f64, &'static [(&'static str, &'static str)]);
const PANELS: [Panel; 4] = [
    (
        "instructions of a tracking step, in millions",
        1e6,
        KERNELS.split_at(1).1,
    ),
    (
        "mean error of 68 landmarks, in % of the distance of the eyes",
        0.01,
        &[
            ("error_posewise", "posewise"),
            ("error_research", "research"),
        ],
    ),
    (
        "faces found in photographs, in %",
        0.01,
        &[
            ("found_posewise", "posewise"),
            ("found_research", "research"),
        ],
    ),
    (
        "size, in KiB",
        1024.0,
        &[
            ("bytes_code", "code on AArch64"),
            ("bytes_posewise", "model posewise"),
            ("bytes_research", "model research"),
        ],
    ),
];

type Line = Map<String, Value>;

fn file() -> PathBuf {
    root().join("docs/history.json")
}

/// The lines, the oldest first.
fn read() -> Result<Vec<Line>> {
    Ok(serde_json::from_str(&std::fs::read_to_string(file())?)?)
}

/// The line of the current version, with this date.
fn current(date: &str) -> Result<Line> {
    let mut line = Line::new();
    line.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    line.insert("date".into(), date.into());
    for (key, kernel) in KERNELS {
        let row = format!("a tracking step, {kernel}");
        line.insert(
            key.into(),
            (documented("docs/performance.md", &row)? as u64).into(),
        );
    }
    let (key, row) = CODE;
    line.insert(
        key.into(),
        (documented("docs/memory.md", row)? as u64).into(),
    );
    for model in MODELS {
        let figures: Value = serde_json::from_str(&std::fs::read_to_string(figures_of(model))?)?;
        for (key, place) in OF_MODELS {
            let figure = figures.pointer(place).context(place)?;
            line.insert(format!("{key}{model}"), figure.clone());
        }
    }
    Ok(line)
}

/// Appends the line of the current version, or writes it anew, with the date of the last commit.
pub fn write() -> Result<()> {
    let mut git = Command::new("git");
    git.args(["log", "-1", "--format=%cs"]).current_dir(root());
    let date = String::from_utf8(output_of(&mut git)?.stdout)?;
    let line = current(date.trim())?;
    let mut history = read()?;
    history.retain(|other| other["version"] != line["version"]);
    history.push(line);
    let history = history.into_iter().map(Value::Object).collect();
    Ok(std::fs::write(file(), lines(&Value::Array(history)))?)
}

/// All versions, as SVG.
pub fn plot() -> Result<String> {
    let mut svg = String::new();
    draw(&read()?, &mut svg).map_err(|error| anyhow::anyhow!("{error}"))?;
    Ok(svg)
}

fn draw(history: &[Line], svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let picture = SVGBackend::with_string(svg, (900, 640)).into_drawing_area();
    picture.fill(&WHITE)?;
    // The last one is inside.
    let versions = 0..history.len().saturating_sub(1);
    for (area, (title, unit, series)) in picture.split_evenly((2, 2)).iter().zip(PANELS) {
        let figures = |key: &str| -> Vec<(usize, f64)> {
            let figure = |line: &Line| line.get(key).and_then(Value::as_f64);
            let known = history.iter().enumerate();
            known
                .filter_map(|(at, line)| Some((at, figure(line)? / unit)))
                .collect()
        };
        let all = series.iter().flat_map(|(key, _)| figures(key));
        let top = all.map(|(_, figure)| figure).fold(0.0, f64::max);
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 16))
            .margin(12)
            .x_label_area_size(24)
            .y_label_area_size(44)
            .build_cartesian_2d(versions.clone().into_segmented(), 0.0..1.1 * top)?;
        let version = |at: &SegmentValue<usize>| match at {
            SegmentValue::CenterOf(at) => history
                .get(*at)
                .and_then(|line| line["version"].as_str())
                .unwrap_or_default()
                .to_owned(),
            _ => String::new(),
        };
        let mut mesh = chart.configure_mesh();
        mesh.disable_x_mesh().x_label_formatter(&version).draw()?;
        for (at, (key, name)) in series.iter().enumerate() {
            let colour = Palette99::pick(at).to_rgba();
            let points = figures(key)
                .into_iter()
                .map(|(at, figure)| (SegmentValue::CenterOf(at), figure));
            let drawn = LineSeries::new(points, colour.filled()).point_size(3);
            let drawn = chart.draw_series(drawn)?.label(*name);
            drawn.legend(move |(x, y)| Circle::new((x + 10, y), 3, colour.filled()));
        }
        let mut names = chart.configure_series_labels();
        let names = names.position(SeriesLabelPosition::LowerRight);
        names.background_style(WHITE).border_style(BLACK).draw()?;
    }
    picture.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_of_this_version_is_that_of_the_committed_figures() {
        let history = read().unwrap();
        let last = history.last().expect("a version");
        let date = last["date"].as_str().expect("a date");
        assert!(
            *last == current(date).unwrap(),
            "docs/history.json: run `cargo xtask history`"
        );
        let text = std::fs::read_to_string(file()).unwrap();
        let written = history.into_iter().map(Value::Object).collect();
        assert!(text == lines(&Value::Array(written)));
    }

    #[test]
    fn every_figure_of_the_plot_is_known() {
        let line = current("").unwrap();
        for (_, _, series) in PANELS {
            for (key, _) in series {
                assert!(line.contains_key(*key), "{key}");
            }
        }
        assert!(plot().unwrap().contains(env!("CARGO_PKG_VERSION")));
    }
}
