//! AFLW2000-3D (Zhu et al. 2016): `NAME.jpg` and `NAME.mat`, of which `Pose_Para` and `pt3d_68` are
//! read. 300W-LP has the same layout.
//!
//! Pose: mean absolute errors in the set's own angles. Faces with an angle beyond 99° are left out,
//! as papers do. Landmarks: NME by the root of the area of the labels' box, by |yaw|. The jaw of
//! these labels is that of the 3D face, and of posewise's landmarks that of the visible contour.

use super::convention::{aflw, of_aflw, rotation};
use super::ibug::PICTURES;
use super::landmarks::{INNER, Points, box_size, nme};
use super::mat;
use super::predictions::{Media, Predictions, beside, files, name_below};
use super::report::{Nme, Report};
use anyhow::{Context, Result, ensure};
use posewise_metrics::pose::PoseErrors;
use std::path::Path;

/// Largest angle that counts \[deg\].
const LARGEST_DEG: f64 = 99.0;

/// Bands of |yaw| \[deg\], as papers have them.
const BANDS: [(&str, f64, f64); 3] = [
    ("0 to 30°", 0.0, 30.0),
    ("30 to 60°", 30.0, 60.0),
    ("60 to 90°", 60.0, f64::INFINITY),
];

/// Largest NME of the curves \[%\].
const LIMIT: f64 = 10.0;

/// One face.
#[derive(Debug)]
pub struct Label {
    /// Yaw, pitch, roll in the set's convention \[deg\].
    angles: [f64; 3],
    points: Points,
}

/// Reads a `.mat` file.
pub fn parse(bytes: &[u8]) -> Result<Label> {
    let arrays = mat::parse(bytes)?;
    let get = |name: &str| arrays.get(name).with_context(|| format!("no array {name}"));
    let pose = &get("Pose_Para")?.values;
    let [pitch, yaw, roll] = *pose.first_chunk().context("Pose_Para is too short")?;
    let points = get("pt3d_68")?;
    ensure!(points.sizes == [3, 68], "pt3d_68 is not 3×68");
    let finite = pose.iter().chain(&points.values).all(|v| v.is_finite());
    ensure!(finite, "a number is not finite");
    Ok(Label {
        angles: aflw(&of_aflw([pitch, yaw, roll])),
        points: std::array::from_fn(|i| [0, 1].map(|k| points.values[3 * i + k])),
    })
}

/// Compares all pictures.
pub fn run(data: &Path, predictions: &Predictions) -> Result<Report> {
    let labels = files(data, &[".mat"])?;
    ensure!(!labels.is_empty(), "no .mat files in {}", data.display());
    let mut pose = PoseErrors::default();
    let mut all: [Nme; 2] = Default::default();
    let mut bands: [Nme; 3] = Default::default();
    for path in &labels {
        let shown = || path.display().to_string();
        let bytes = std::fs::read(path).with_context(shown)?;
        let label = parse(&bytes).with_context(shown)?;
        let media = Media::Still(beside(path, &PICTURES), None);
        let found = predictions.of(&name_below(data, path), &media, 1)?;
        let found = found[0].as_ref();
        if label.angles.iter().all(|a| a.abs() <= LARGEST_DEG) {
            pose.push(label.angles, found.map(|t| aflw(&rotation(t.angles))));
        }
        let unit = box_size(&label.points);
        let error = |from| found.map(|t| nme(&label.points, &t.points, from, unit));
        all[0].push(error(0));
        all[1].push(error(INNER));
        for (band, (_, from, to)) in bands.iter_mut().zip(BANDS) {
            if (from..to).contains(&label.angles[0].abs()) {
                band.push(error(0));
            }
        }
    }
    let mut report = Report::default();
    report.pose_head();
    report.pose("all", &pose);
    report.line("");
    Nme::head(&mut report, LIMIT);
    all[0].row(&mut report, "68 points", LIMIT);
    all[1].row(&mut report, "51 points", LIMIT);
    for (band, (name, ..)) in bands.iter().zip(BANDS) {
        band.row(&mut report, &format!("68 points, yaw {name}"), LIMIT);
    }
    Ok(report)
}
