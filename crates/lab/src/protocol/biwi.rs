//! BIWI Kinect head poses (Fanelli et al. 2013): folders `01` … `24` with `frame_00003_rgb.png` and
//! `frame_00003_pose.txt`, which has the rotation in three rows, then the position \[mm\].
//!
//! The rotation is relative to the depth camera, whose axes are nearly those of the colour camera;
//! as papers do, no correction is made. `--focal 517.7` is its colour camera's.

use super::convention::{biwi, rotation};
use super::predictions::{Media, Predictions, files, name_below};
use super::report::Report;
use super::text::Text;
use anyhow::{Result, ensure};
use glam::{Mat3, Vec3};
use posewise_metrics::pose::PoseErrors;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Largest deviation of RᵀR from the identity of a rotation that was written with six digits.
const ORTHONORMAL: f32 = 1e-2;

/// Ending of the files with poses.
const POSE: &str = "_pose.txt";

/// The rotation.
pub fn parse(text: &Text) -> Result<Mat3> {
    let mut rows = Vec::new();
    let mut last = 1;
    for (line, numbers) in text.lines() {
        rows.push(Vec3::from(
            text.numbers::<3>(line, numbers)?.map(|v| v as f32),
        ));
        last = line;
    }
    let [x, y, z, _] = rows[..] else {
        let count = rows.len();
        return Err(text.cut_off(format_args!("{count} rows in place of 4")));
    };
    let r = Mat3::from_cols(x, y, z).transpose();
    let off = r.transpose() * r - Mat3::IDENTITY;
    let is_rotation = off.abs_diff_eq(Mat3::ZERO, ORTHONORMAL) && r.determinant() > 0.0;
    ensure!(is_rotation, text.error(last, "no rotation"));
    Ok(r)
}

/// Compares all clips.
pub fn run(data: &Path, predictions: &Predictions) -> Result<Report> {
    let mut clips: BTreeMap<PathBuf, Vec<PathBuf>> = BTreeMap::new();
    for path in files(data, &[POSE])? {
        let folder = path.parent().unwrap_or(data).to_path_buf();
        clips.entry(folder).or_default().push(path);
    }
    ensure!(!clips.is_empty(), "no {POSE} files in {}", data.display());
    let mut report = Report::default();
    report.pose_head();
    let mut all = PoseErrors::default();
    for (folder, poses) in &clips {
        let picture = |path: &PathBuf| {
            let name = path.to_string_lossy();
            PathBuf::from(format!("{}_rgb.png", name.trim_end_matches(POSE)))
        };
        let name = name_below(data, folder);
        let media = Media::Frames(poses.iter().map(picture).collect());
        let found = predictions.of(&name, &media, poses.len())?;
        let mut errors = PoseErrors::default();
        for (path, found) in poses.iter().zip(&found) {
            let truth = biwi(&parse(&Text::read(path)?)?);
            let angles = found.as_ref().map(|t| biwi(&rotation(t.angles)));
            errors.push(truth, angles);
        }
        report.pose(&name, &errors);
        all.extend(&errors);
    }
    report.pose("all", &all);
    Ok(report)
}
