//! 300-W (Sagonas et al. 2013): `NAME.pts` beside each picture, in any folders. The coordinates of
//! the files count from 1.

use super::predictions::{Media, Predictions, beside, files, name_below};
use super::pts::parse68;
use super::report::{Nme, Report};
use super::text::Text;
use anyhow::{Result, ensure};
use posewise_metrics::jitter::Shape;
use posewise_metrics::landmarks::{INNER, eye_centres, nme_percent, outer_corners};
use std::path::Path;

/// Endings of pictures.
pub const PICTURES: [&str; 4] = ["png", "jpg", "jpeg", "JPG"];

/// Largest NME of the curves by the distance of the outer eye corners, and by that of the pupils
/// \[%\], as papers have them.
const LIMITS: [f64; 2] = [8.0, 10.0];

/// The labels from 0.
pub fn parse(text: &Text) -> Result<Shape> {
    Ok(parse68(text)?.map(|[x, y]| [x - 1.0, y - 1.0]))
}

/// Compares all pictures.
pub fn run(data: &Path, predictions: &Predictions<'_>) -> Result<Report> {
    let labels = files(data, &[".pts"])?;
    ensure!(!labels.is_empty(), "no .pts files in {}", data.display());
    let mut sums: [[Nme; 2]; 2] = Default::default();
    for path in &labels {
        let label = parse(&Text::read(path)?)?;
        let media = Media::Still(beside(path, &PICTURES));
        let found = predictions.of(&name_below(data, path), &media, 1)?;
        let found = found[0].as_ref().map(|t| t.points);
        let units = [outer_corners(&label), eye_centres(&label)];
        for (by_unit, unit) in sums.iter_mut().zip(units) {
            let unit = unit.max(f64::MIN_POSITIVE);
            for (sum, from) in by_unit.iter_mut().zip([0, INNER]) {
                let pairs = |found| label.into_iter().zip(found).skip(from);
                sum.push(found.map(|found| nme_percent(pairs(found), unit)));
            }
        }
    }
    let mut report = Report::default();
    let units = ["outer eye corners", "pupils"];
    for ((by_unit, unit), limit) in sums.iter().zip(units).zip(LIMITS) {
        report.line(&format!("By the distance of the {unit}\n"));
        Nme::head(&mut report, limit);
        by_unit[0].row(&mut report, &format!("68 points, {unit}"), limit);
        by_unit[1].row(&mut report, &format!("51 points, {unit}"), limit);
        report.line("");
    }
    Ok(report)
}
