//! Clips in folders by subject of the test, as the thesis' U3PT: `frontal`, `profile`,
//! `expression`, `occlusion`, or any other names. Each has `NAME.csv`, the truth as of
//! `posewise-lab eval pose`, beside `NAME.mp4`, `.y4m.gz` or `.y4m`.
//!
//! The robustness curve of a subset is the share of its frames whose mean error of the three angles
//! is at most τ, against τ. A frame that was not tracked is above each τ. Frames count whose face
//! is in the picture by at least half of its landmarks (column `in_frame`, if there is one).

use super::predictions::{Media, Predictions, beside, files, name_below};
use super::report::{Report, cell};
use crate::truth;
use anyhow::{Result, ensure};
use posewise_metrics::cumulative::ced;
use posewise_metrics::pose::PoseErrors;
use std::collections::BTreeMap;
use std::path::Path;

/// Error thresholds τ of the table \[deg\].
const THRESHOLDS: [f64; 6] = [2.0, 5.0, 10.0, 15.0, 20.0, 30.0];

/// Share of the landmarks in the picture from which on a frame counts.
const IN_FRAME: f64 = 0.5;

/// Compares the clips of all subsets.
pub fn run(data: &Path, predictions: &Predictions<'_>) -> Result<Report> {
    let truths = files(data, &[".csv"])?;
    ensure!(!truths.is_empty(), "no .csv files in {}", data.display());
    let mut subsets: BTreeMap<String, PoseErrors> = BTreeMap::new();
    for path in &truths {
        let truth = truth::read(path)?;
        let name = name_below(data, path);
        let media = Media::Video(beside(path, &["mp4", "y4m.gz", "y4m", "avi"]));
        let found = predictions.of(&name, &media, truth.len())?;
        let subset = name.rsplit_once('/').map_or("all", |(folder, _)| folder);
        let errors = subsets.entry(subset.into()).or_default();
        for (truth, found) in truth.iter().zip(&found) {
            if truth.in_frame >= IN_FRAME {
                errors.push(truth.angles, found.as_ref().map(|t| t.angles));
            }
        }
    }
    let mut report = Report::default();
    report.pose_head();
    for (name, errors) in &subsets {
        report.pose(name, errors);
    }
    report.line("\nRobustness: % of the frames with a mean angle error of at most τ\n");
    let titles = THRESHOLDS.map(|t| format!("{t}°"));
    report.head(&[&["subset"][..], &titles.each_ref().map(String::as_str)].concat());
    for (name, errors) in &subsets {
        let frames = errors.per_frame();
        let within = |limit: &f64| {
            let count = frames.iter().filter(|e| *e <= limit).count();
            cell(Some(100.0 * count as f64 / errors.len().max(1) as f64))
        };
        let cells = THRESHOLDS.iter().map(within);
        let row: Vec<String> = [name.clone()].into_iter().chain(cells).collect();
        report.row(&row);
        let curve = ced(&frames, errors.len(), THRESHOLDS[THRESHOLDS.len() - 1]);
        report.curves.push((name.clone(), curve));
    }
    Ok(report)
}
