//! CFP, celebrities in frontal and profile views (Sengupta et al. 2016), with the half that is seen
//! marked: `dev.csv` as of `posewise-lab eval profiles`, its pictures in `dev`.
//!
//! The pictures of a person are of different days. So a tracker of the thesis starts from
//! posewise's landmarks of the same picture and sees it again, as if the head rested: the error
//! says what it makes of that start. Errors are over the distance from chin to brow.

use super::predictions::{Media, Predictions};
use super::report::{Report, cell};
use crate::eval::{profile_errors, profile_labels};
use anyhow::{Result, ensure};
use posewise_metrics::mean;
use std::path::Path;

/// One table of all systems.
pub fn run(data: &Path, systems: &[Predictions<'_>]) -> Result<Report> {
    let labels = profile_labels(&data.join("dev.csv"))?;
    ensure!(!labels.is_empty(), "no pictures in {}", data.display());
    let mut report = Report::default();
    report.head(&["method", "pictures", "n", "found %", "inner %", "jaw %"]);
    for system in systems {
        let mut found = Vec::new();
        for label in &labels {
            let media = Media::Still(data.join("dev").join(&label.image));
            let name = label
                .image
                .rsplit_once('.')
                .map_or(&*label.image, |(name, _)| name);
            let tracked = system.of(name, &media, 1)?.remove(0);
            let errors = tracked.and_then(|t| profile_errors(&label.marked, label.unit, &t.points));
            found.push((label.is_profile, errors));
        }
        for (name, is_profile) in [("frontal", false), ("profile", true)] {
            let of: Vec<_> = found
                .iter()
                .filter(|(kind, _)| *kind == is_profile)
                .collect();
            let errors: Vec<[f64; 2]> = of.iter().filter_map(|(_, errors)| *errors).collect();
            let part = |k: usize| mean(&errors.iter().map(|e| 100.0 * e[k]).collect::<Vec<_>>());
            let share = 100.0 * errors.len() as f64 / of.len().max(1) as f64;
            report.row(&[
                system.name().into(),
                name.into(),
                of.len().to_string(),
                cell(Some(share)),
                cell(part(0)),
                cell(part(1)),
            ]);
        }
    }
    Ok(report)
}
