//! Boston University's head tracking videos (La Cascia, Sclaroff, Athitsos 2000; the thesis' BUFT).
//!
//! Layout: `NAME.avi` and `NAME.dat` in any folders. A row of `NAME.dat` has seven numbers: time,
//! position x, y, z \[in\], then roll, yaw, pitch \[deg\] of a magnetic sensor. The first row is of
//! no frame; row n + 1 is that of frame n.
//!
//! *Absolute* errors are those of the angles relative to the camera. *Relative* ones are those of
//! the rotation since the first frame that was tracked: the sensor's zero is not the camera's axis.

use super::convention::{angles, of_boston, relative, rotation};
use super::predictions::{Media, Predictions, beside, files, name_below};
use super::report::Report;
use super::text::Text;
use anyhow::{Result, ensure};
use glam::Mat3;
use posewise_metrics::pose::PoseErrors;
use std::path::Path;

/// The rotation of each frame.
pub fn parse(text: &Text) -> Result<Vec<Mat3>> {
    let row = |(line, numbers)| -> Result<Mat3> {
        let [.., roll, yaw, pitch] = text.numbers::<7>(line, numbers)?;
        Ok(of_boston([roll, yaw, pitch]))
    };
    text.lines().map(row).skip(1).collect()
}

/// Compares all clips.
pub fn run(data: &Path, predictions: &Predictions<'_>) -> Result<Report> {
    let truths = files(data, &[".dat"])?;
    ensure!(!truths.is_empty(), "no .dat files in {}", data.display());
    let mut clips = Vec::new();
    for path in &truths {
        let truth = parse(&Text::read(path)?)?;
        let name = name_below(data, path);
        let media = Media::Video(beside(path, &["avi", "mp4", "y4m"]));
        let found = predictions.of(&name, &media, truth.len())?;
        let found: Vec<Option<[f64; 3]>> = found.iter().map(|t| Some(t.as_ref()?.angles)).collect();
        clips.push((name, compare(&truth, &found)));
    }
    let mut report = Report::default();
    for (k, title) in ["Absolute", "Relative to the first frame"]
        .iter()
        .enumerate()
    {
        report.line(&format!("{title}\n"));
        report.pose_head();
        let mut all = PoseErrors::default();
        for (name, errors) in &clips {
            report.pose(name, &errors[k]);
            all.extend(&errors[k]);
        }
        report.pose("all", &all);
        report.line("");
    }
    Ok(report)
}

/// Absolute and relative errors of a clip.
fn compare(truth: &[Mat3], found: &[Option<[f64; 3]>]) -> [PoseErrors; 2] {
    let mut errors = [PoseErrors::default(), PoseErrors::default()];
    let mut first = None;
    for (truth, found) in truth.iter().zip(found) {
        let turned = found.map(rotation);
        errors[0].push(angles(truth), *found);
        let (first_truth, first_found) = match (first, turned) {
            (Some(first), _) => first,
            (None, Some(turned)) => *first.insert((*truth, turned)),
            (None, None) => (*truth, Mat3::IDENTITY),
        };
        let since = turned.map(|now| relative(&first_found, &now));
        errors[1].push(relative(&first_truth, truth), since);
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_offset_is_no_relative_error() {
        let truth: Vec<Mat3> = (0..5)
            .map(|k| rotation([4.0 * f64::from(k), 0.0, 0.0]))
            .collect();
        let found = |k: usize| (k != 2).then_some([4.0 * k as f64 + 7.0, 0.0, 0.0]);
        let found: Vec<_> = (0..5).map(found).collect();
        let [absolute, relative] = compare(&truth, &found);
        assert_eq!(absolute.success(), Some(0.8));
        assert!((absolute.mean().unwrap()[0] - 7.0).abs() < 1e-3);
        assert!(relative.mean_angle().unwrap() < 1e-3);
    }
}
