//! Reads a camera's calibration as OpenCV and ROS write it: YAML or JSON with the camera matrix,
//! the coefficients of the lens and the size of the pictures.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use posewise::{Distortion, Intrinsics};
use yaml_rust2::{Yaml, YamlLoader};

use crate::bounded;

/// Names of the camera matrix: OpenCV's samples of today and of before, and what scripts use.
const MATRIX: [&str; 4] = ["camera_matrix", "Camera_Matrix", "cameraMatrix", "K"];
/// Names of the coefficients, likewise.
const COEFFICIENTS: [&str; 5] = [
    "distortion_coefficients",
    "Distortion_Coefficients",
    "distCoeffs",
    "dist_coeffs",
    "D",
];
/// Names of the pictures' width and height, likewise.
const WIDTH: [&str; 2] = ["image_width", "image_Width"];
const HEIGHT: [&str; 2] = ["image_height", "image_Height"];
/// Names of Kannala–Brandt in ROS' `distortion_model`.
const FISHEYE_NAMES: [&str; 2] = ["equidistant", "fisheye"];

/// How far width and height may be scaled differently.
const ASPECT_TOLERANCE: f32 = 0.01;

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    camera: Intrinsics,
    /// Size of the pictures that it is for \[px\].
    size: Option<[i32; 2]>,
}

impl Calibration {
    /// Largest file \[MB\].
    pub const MOST_MB: u64 = 1;

    /// Reads a file. `fisheye` says that the coefficients are Kannala–Brandt's.
    pub fn read(path: &Path, fisheye: bool) -> Result<Self> {
        let text = bounded::read_text("calibration", path, Self::MOST_MB)?;
        Self::parse(&text, fisheye).with_context(|| format!("--calibration {}", path.display()))
    }

    fn parse(text: &str, fisheye: bool) -> Result<Self> {
        // OpenCV starts with `%YAML:1.0`, which is no YAML.
        let text = match text.strip_prefix("%YAML") {
            Some(rest) => rest.split_once('\n').map_or("", |(_, rest)| rest),
            None => text,
        };
        let documents = YamlLoader::load_from_str(text).context("neither YAML nor JSON")?;
        let file = documents.first().context("the file is empty")?;
        let matrix = find(file, &MATRIX).context("no camera_matrix")?;
        let &[fx, skew, cx, zero, fy, cy, ..] = &numbers(matrix)[..] else {
            bail!("camera_matrix must have 3×3 numbers");
        };
        ensure!(
            skew == 0.0 && zero == 0.0,
            "a camera_matrix with skew is not supported"
        );
        let is_fisheye = fisheye
            || file["fisheye_model"].as_i64() == Some(1)
            || (file["distortion_model"].as_str())
                .is_some_and(|name| FISHEYE_NAMES.contains(&name));
        let coefficients = find(file, &COEFFICIENTS).map_or(Vec::new(), numbers);
        let distortion = match is_fisheye {
            true => kannala_brandt(&coefficients)?,
            false => brown_conrady(&coefficients)?,
        };
        let side = |names: &[&str]| find(file, names).and_then(Yaml::as_i64);
        let camera = Intrinsics::new(fx, fy, cx, cy).with_distortion(distortion);
        ensure!(
            camera.is_valid(),
            "focal lengths must be 1 to 1000000 px and their ratio 0.1 to 10, the principal point \
             within 100000 px of 0"
        );
        ensure!(
            distortion.is_valid(),
            "a distortion coefficient is out of range, or the picture turns back within 1° of the \
             axis"
        );
        Ok(Calibration {
            camera,
            size: match (side(&WIDTH), side(&HEIGHT)) {
                (Some(w @ 1..=0xFFFF), Some(h @ 1..=0xFFFF)) => Some([w as i32, h as i32]),
                _ => None,
            },
        })
    }

    /// The camera for frames of this size \[px\]: scaled, where the calibration is for another one.
    pub fn camera(&self, width: i32, height: i32) -> Result<Intrinsics> {
        let Some([own_width, own_height]) = self.size else {
            return Ok(self.camera);
        };
        let scale = width as f32 / own_width as f32;
        let other = height as f32 / own_height as f32;
        ensure!(
            (scale / other - 1.0).abs() <= ASPECT_TOLERANCE,
            "--calibration is for pictures of {own_width}×{own_height} px, not {width}×{height}"
        );
        let Intrinsics { fx, fy, cx, cy, .. } = self.camera;
        // Pixel centres are at whole numbers, edges half a pixel away.
        let moved = |c: f32| (c + 0.5) * scale - 0.5;
        Ok(
            Intrinsics::new(fx * scale, fy * scale, moved(cx), moved(cy))
                .with_distortion(self.camera.distortion),
        )
    }
}

fn find<'y>(file: &'y Yaml, names: &[&str]) -> Option<&'y Yaml> {
    let found = names.iter().map(|name| &file[*name]);
    found.into_iter().find(|value| !value.is_badvalue())
}

/// All numbers of a matrix: `data` of OpenCV's, or lists in lists. NaN stands for what is none.
fn numbers(value: &Yaml) -> Vec<f32> {
    match value {
        Yaml::Hash(_) => numbers(&value["data"]),
        Yaml::Array(values) => values.iter().flat_map(numbers).collect(),
        Yaml::Integer(number) => vec![*number as f32],
        _ => vec![value.as_f64().map_or(f32::NAN, |number| number as f32)],
    }
}

/// k1, k2, p1, p2 and k3, as far as they are there. The further ones of OpenCV must be 0.
fn brown_conrady(coefficients: &[f32]) -> Result<Distortion> {
    let at = |i: usize| coefficients.get(i).copied().unwrap_or(0.0);
    ensure!(
        coefficients.iter().skip(5).all(|k| *k == 0.0),
        "of the distortion coefficients only k1, k2, p1, p2 and k3 are supported"
    );
    if coefficients.iter().all(|k| *k == 0.0) {
        return Ok(Distortion::None);
    }
    Ok(Distortion::BrownConrady {
        k1: at(0),
        k2: at(1),
        p1: at(2),
        p2: at(3),
        k3: at(4),
    })
}

fn kannala_brandt(coefficients: &[f32]) -> Result<Distortion> {
    let &[k1, k2, k3, k4] = coefficients else {
        bail!("a fisheye has four distortion coefficients");
    };
    Ok(Distortion::KannalaBrandt { k1, k2, k3, k4 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `cv::FileStorage` writes it.
    const OPENCV: &str = "%YAML:1.0
---
calibration_time: \"Thu Nov 26 10:00:00 2026\"
image_width: 640
image_height: 480
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3591573396163199e+02, 0., 3.4228315473308373e+02, 0.,
       5.3591573396163199e+02, 2.3557082909788173e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.6637260909660682e-01, -3.8588898922304653e-02,
       1.7831947042852964e-03, -2.8122100441115472e-04,
       2.3839153080878486e-01 ]
";

    #[test]
    fn opencv_s_yaml_is_read() {
        let calibration = Calibration::parse(OPENCV, false).unwrap();
        let expected = Distortion::BrownConrady {
            k1: -0.266_372_62,
            k2: -0.038_588_9,
            p1: 0.001_783_194_7,
            p2: -0.000_281_221,
            k3: 0.238_391_53,
        };
        let camera = Intrinsics::new(535.915_7, 535.915_7, 342.283_15, 235.570_83);
        let camera = camera.with_distortion(expected);
        assert_eq!(calibration.size, Some([640, 480]));
        assert_eq!(calibration.camera(640, 480).unwrap(), camera);
        let half = calibration.camera(320, 240).unwrap();
        assert_eq!((half.fx, half.distortion), (camera.fx / 2.0, expected));
        assert!((half.cx - 170.891_58).abs() < 1e-3);
        assert!(calibration.camera(640, 360).is_err());
    }

    #[test]
    fn fisheyes_in_json_are_read() {
        let json = r#"{"K": [[300, 0, 319.5], [0, 301.5, 239.5], [0, 0, 1]],
            "D": [[0.1], [-0.02], [0.003], [0]]}"#;
        let calibration = Calibration::parse(json, true).unwrap();
        let expected = Distortion::KannalaBrandt {
            k1: 0.1,
            k2: -0.02,
            k3: 0.003,
            k4: 0.0,
        };
        let camera = Intrinsics::new(300.0, 301.5, 319.5, 239.5).with_distortion(expected);
        assert_eq!(calibration.camera(99, 7).unwrap(), camera);
        // ROS says it by name.
        let ros = json.replace("\"D\"", "\"distortion_model\": \"equidistant\", \"D\"");
        assert_eq!(Calibration::parse(&ros, false).unwrap(), calibration);
    }

    #[test]
    fn other_files_are_refused() {
        for (text, word) in [
            ("", "empty"),
            ("{", "neither"),
            ("a: 1", "no camera_matrix"),
            ("K: [1, 2]", "3×3"),
            ("K: [9, 1, 0, 0, 9, 0, 0, 0, 1]", "skew"),
            ("K: [0, 0, 0, 0, 9, 0, 0, 0, 1]", "focal"),
            ("K: [nothing, 0, 0, 0, 9, 0, 0, 0, 1]", "focal"),
            (
                "K: [9, 0, 0, 0, 9, 0, 0, 0, 1]\nD: [0, 0, 0, 0, 0, 1]",
                "k3",
            ),
            ("K: [9, 0, 0, 0, 9, 0, 0, 0, 1]\nD: [.nan]", "out of range"),
            (
                "K: [9, 0, 0, 0, 9, 0, 0, 0, 1]\nD: [-20000]",
                "out of range",
            ),
            ("K: [9, 0, 0, 0, 9, 0, 0, 0, 1]\nfisheye_model: 1", "four"),
        ] {
            let error = Calibration::parse(text, false).unwrap_err();
            assert!(format!("{error:#}").contains(word), "{text}: {error:#}");
        }
    }
}
