//! `posewise eval`: accuracy against labelled data. `*_metrics` are the formulas, without files;
//! `recovery`, `faceless` and `drift` make their clips in memory and show them to a tracker.

pub mod backgrounds;
pub mod camera;
pub mod drift;
pub mod eyes;
pub mod faceless;
pub mod jitter;
pub mod landmark_metrics;
pub mod landmarks;
pub mod pose;
pub mod pose_metrics;
pub mod recovery;
pub mod registration;
pub mod show;
pub mod table;
pub mod trust;
pub mod turned;

use std::path::PathBuf;

use anyhow::{Result, bail};

use crate::cli::ClipsArgs;

/// Each clip's truth and table.
fn clips_of(args: &ClipsArgs) -> Result<impl Iterator<Item = (&PathBuf, &PathBuf)>> {
    if args.truth.len() != args.csv.len() {
        bail!(
            "{} --truth files but {} --csv files: give one CSV per truth",
            args.truth.len(),
            args.csv.len()
        );
    }
    Ok(args.truth.iter().zip(&args.csv))
}

/// Mean of the values; `None` of none.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Median of the values (mean of the middle two when even); `None` of none.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let middle = sorted.get((n.max(1) - 1) / 2..n / 2 + 1)?;
    mean(middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_medians() {
        assert_eq!(mean(&[]), None);
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[3.0, 1.0]), Some(2.0));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
    }
}
