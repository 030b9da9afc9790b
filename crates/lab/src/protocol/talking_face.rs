//! The Talking Face video (FGNET): `franck_00000.pts` beside `franck_00000.jpg`, frame by frame.
//!
//! Its 68 points are those of XM2VTS, not of 300-W. Twelve of them, and the wider list of *all*,
//! are at the same places in both. Which twelve the thesis took is not known to us; these are the
//! corners of eyes and mouth, the middles of the lips, tip, base and wings of the nose.

use super::ibug::PICTURES;
use super::predictions::{Media, Predictions, beside, files, name_below};
use super::pts::parse68;
use super::report::{Report, cell};
use super::text::Text;
use anyhow::{Result, ensure};
use posewise_metrics::jitter::Shape;
use posewise_metrics::landmarks::distance;
use posewise_metrics::mean;
use std::path::Path;

/// Which points the files have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Markup {
    /// XM2VTS, as the data set comes.
    Xm2vts,
    /// 300-W, for labels that were set again.
    Ibug,
}

/// XM2VTS point, and the same in 300-W. Source: stasm's conversion of its points to XM2VTS.
const TWELVE: [[usize; 2]; 12] = [
    [27, 36],
    [29, 39],
    [34, 42],
    [32, 45],
    [48, 48],
    [51, 51],
    [54, 54],
    [57, 57],
    [67, 30],
    [41, 33],
    [39, 31],
    [43, 35],
];

/// More such points: ends of the brows, the chin, the rest of the outer lips.
const FURTHER: [[usize; 2]; 13] = [
    [21, 17],
    [24, 21],
    [18, 22],
    [15, 26],
    [7, 8],
    [49, 49],
    [50, 50],
    [52, 52],
    [53, 53],
    [55, 55],
    [56, 56],
    [58, 58],
    [59, 59],
];

/// Root of the mean squared distance of these pairs of points \[px\].
fn rms(label: &Shape, found: &Shape, pairs: &[[usize; 2]]) -> f64 {
    let squares = pairs
        .iter()
        .map(|[a, b]| distance(label[*a], found[*b]).powi(2));
    (squares.sum::<f64>() / pairs.len() as f64).sqrt()
}

/// Compares the frames.
pub fn run(data: &Path, predictions: &Predictions<'_>, markup: Markup) -> Result<Report> {
    let labels = files(data, &[".pts"])?;
    ensure!(!labels.is_empty(), "no .pts files in {}", data.display());
    let pictures = labels.iter().map(|path| beside(path, &PICTURES)).collect();
    let first = name_below(data, &labels[0]);
    let name = first.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_');
    let found = predictions.of(name, &Media::Frames(pictures), labels.len())?;
    let (twelve, all): (Vec<_>, Vec<_>) = match markup {
        Markup::Xm2vts => (TWELVE.to_vec(), [&TWELVE[..], &FURTHER].concat()),
        Markup::Ibug => (
            TWELVE.map(|[_, p]| [p, p]).to_vec(),
            (0..68).map(|p| [p, p]).collect(),
        ),
    };
    let mut errors = [Vec::new(), Vec::new()];
    for (path, found) in labels.iter().zip(&found) {
        let label = parse68(&Text::read(path)?)?;
        if let Some(found) = found {
            errors[0].push(rms(&label, &found.points, &twelve));
            errors[1].push(rms(&label, &found.points, &all));
        }
    }
    let tracked = 100.0 * errors[0].len() as f64 / labels.len() as f64;
    let mut report = Report::default();
    report.head(&[
        "points",
        "frames",
        "tracked %",
        "mean RMS px",
        "worst RMS px",
    ]);
    for (points, errors) in [twelve, all].iter().zip(&errors) {
        let worst = errors.iter().copied().reduce(f64::max);
        report.row(&[
            points.len().to_string(),
            labels.len().to_string(),
            cell(Some(tracked)),
            cell(mean(errors)),
            cell(worst),
        ]);
    }
    Ok(report)
}
