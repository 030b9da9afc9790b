//! Pointing'04 (Gourier, Hall, Crowley 2004): people who look at marks on a wall, one picture a
//! mark. `labels.csv` has the columns `image`, `identity`, `series`, `pitch_deg`, `yaw_deg`; there,
//! yaw > 0 turns the face to the image left. Roll has no label and is taken as 0.
//!
//! A tracker needs a sequence. A series gives four: from the frontal picture to the profile on
//! either side, and up and down. Each picture is shown [`SHOWN`] times, as if the head rested
//! there, and the last result counts. Errors are those of the rotation since the frontal picture,
//! which itself does not count: where people hold their heads straight ahead differs.

use super::convention::{relative, rotation};
use super::predictions::{Media, Predictions};
use super::report::{Report, cell};
use crate::table::Table;
use anyhow::{Result, ensure};
use posewise_metrics::pose::PoseErrors;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Times that a picture is shown. Its neighbours are 15° away, three standard deviations of the
/// motion that the comparators expect between frames.
const SHOWN: usize = 5;
/// Mean angle error beyond which a head is lost \[deg\].
const LOST_DEG: f64 = 20.0;

/// What pictures show.
const SUBSETS: [&str; 3] = ["yaw to 45°", "yaw from 60°", "pitch"];

/// Pictures of one series in one direction, the frontal one first: yaw and pitch as posewise has
/// them \[deg\].
struct Sweep {
    name: String,
    pictures: Vec<(PathBuf, [f64; 2])>,
}

fn subset([yaw, _]: [f64; 2]) -> usize {
    match yaw.abs() {
        0.0 => 2,
        to_45 if to_45 <= 45.0 => 0,
        _ => 1,
    }
}

/// The sweeps of all series.
fn sweeps(data: &Path) -> Result<Vec<Sweep>> {
    let path = data.join("labels.csv");
    let table = Table::read(&path)?;
    let [image, identity, series] = ["image", "identity", "series"].map(|n| table.column(n));
    let (image, identity, series) = (image?, identity?, series?);
    let (yaw, pitch) = (table.column("yaw_deg")?, table.column("pitch_deg")?);
    let mut people: BTreeMap<String, Vec<(PathBuf, [f64; 2])>> = BTreeMap::new();
    for row in 0..table.len() {
        let name = format!("{}-{}", table.text(row, identity), table.text(row, series));
        let angles = [-table.number(row, yaw)?, table.number(row, pitch)?];
        let picture = data.join(table.text(row, image));
        people.entry(name).or_default().push((picture, angles));
    }
    let mut all = Vec::new();
    for (name, pictures) in people {
        let directions = [
            ("left", 0, -1.0),
            ("right", 0, 1.0),
            ("up", 1, 1.0),
            ("down", 1, -1.0),
        ];
        for (direction, axis, sign) in directions {
            let along = |angles: &[f64; 2]| sign * angles[axis];
            let is_on = |a: &[f64; 2]| a[1 - axis] == 0.0 && along(a) >= 0.0;
            let on = pictures.iter().filter(|(_, angles)| is_on(angles));
            let mut on: Vec<_> = on.cloned().collect();
            on.sort_by(|a, b| along(&a.1).total_cmp(&along(&b.1)));
            let has_start = on.first().is_some_and(|(_, angles)| *angles == [0.0; 2]);
            ensure!(
                has_start,
                "{}: no frontal picture of {name}",
                path.display()
            );
            all.push(Sweep {
                name: format!("{name}/{direction}"),
                pictures: on,
            });
        }
    }
    Ok(all)
}

/// Errors of one system by subset.
fn errors(sweeps: &[Sweep], system: &Predictions<'_>) -> Result<[PoseErrors; 3]> {
    let mut errors: [PoseErrors; 3] = Default::default();
    for sweep in sweeps {
        let shown = |(path, _): &(PathBuf, _)| std::iter::repeat_n(path.clone(), SHOWN);
        let frames: Vec<PathBuf> = sweep.pictures.iter().flat_map(shown).collect();
        let count = frames.len();
        let found = system.of(&sweep.name, &Media::Frames(frames), count)?;
        let last = found.chunks(SHOWN).map(|times| times.last()?.as_ref());
        let turned: Vec<_> = last.map(|t| t.map(|t| rotation(t.angles))).collect();
        for ((_, [yaw, pitch]), now) in sweep.pictures.iter().zip(&turned).skip(1) {
            let since = turned[0]
                .zip(*now)
                .map(|(first, now)| relative(&first, &now));
            errors[subset([*yaw, *pitch])].push([*yaw, *pitch, 0.0], since);
        }
    }
    Ok(errors)
}

/// One table of all systems.
pub fn run(data: &Path, systems: &[Predictions<'_>]) -> Result<Report> {
    let sweeps = sweeps(data)?;
    ensure!(!sweeps.is_empty(), "no pictures in {}", data.display());
    let mut report = Report::default();
    let titles = [
        "method",
        "pictures",
        "n",
        "P_s %",
        "within 20° %",
        "E_yaw °",
        "E_pitch °",
    ];
    report.head(&[&titles[..], &["E_roll °", "E_m °"]].concat());
    for system in systems {
        for (name, errors) in SUBSETS.iter().zip(errors(&sweeps, system)?) {
            let near = errors
                .per_frame()
                .iter()
                .filter(|e| **e <= LOST_DEG)
                .count();
            let axis = |i: usize| cell(errors.mean().map(|e| e[i]));
            report.row(&[
                system.name().into(),
                name.to_string(),
                errors.len().to_string(),
                cell(errors.success().map(|s| 100.0 * s)),
                cell(Some(100.0 * near as f64 / errors.len().max(1) as f64)),
                axis(0),
                axis(1),
                axis(2),
                cell(errors.mean_angle()),
            ]);
        }
    }
    Ok(report)
}
