//! What is known of the camera's focal length, and what the command says of it.

use std::fmt;

use anyhow::Result;
use posewise::Intrinsics;

use crate::calibration::Calibration;
use crate::cli::TrackerArgs;

/// The camera as the options give it.
pub enum Lens {
    /// No option: what a picture's file says, else 60° across.
    Unknown,
    /// A focal length \[px\].
    Focal(f32),
    /// A horizontal field of view \[deg\].
    FieldOfView(f32),
    /// With distortion.
    Calibration(Box<Calibration>),
}

impl Lens {
    /// That of the options.
    pub fn new(args: &TrackerArgs) -> Result<Lens> {
        Ok(match (&args.calibration, args.focal, args.fov) {
            (Some(path), ..) => Lens::Calibration(Box::new(Calibration::read(path, args.fisheye)?)),
            (None, Some(focal), _) => Lens::Focal(focal),
            (None, None, Some(fov)) => Lens::FieldOfView(fov),
            (None, None, None) => Lens::Unknown,
        })
    }

    /// The camera of frames of this size; `file_px` is the focal length that their file says.
    /// `None` where nothing is known of it.
    pub fn camera(
        &self,
        (width, height): (i32, i32),
        file_px: Option<f32>,
    ) -> Result<Option<Intrinsics>> {
        let focal = match self {
            Lens::Calibration(calibration) => return calibration.camera(width, height).map(Some),
            Lens::Focal(focal) => Some(*focal),
            Lens::FieldOfView(fov) => Some(width as f32 / 2.0 / (fov.to_radians() / 2.0).tan()),
            Lens::Unknown => file_px,
        };
        Ok(focal.map(|focal| {
            let mut camera = Intrinsics::of_frame(width, height);
            (camera.fx, camera.fy) = (focal, focal);
            camera
        }))
    }
}

/// How many frames had which focal length, in words.
#[derive(Default)]
pub struct LensNote {
    /// Frames whose focal length was assumed, was read from the file, and was given.
    counts: [u64; 3],
    /// Fields of view that the files said \[deg\].
    range_deg: Option<[f32; 2]>,
}

impl LensNote {
    /// One more frame; `file_px` as for [`Lens::camera`].
    pub fn add(&mut self, lens: &TrackerArgs, width: f32, file_px: Option<f32>) {
        let is_given = lens.focal.is_some() || lens.fov.is_some() || lens.calibration.is_some();
        let kind = match (is_given, file_px) {
            (true, _) => 2,
            (false, Some(focal)) => {
                let fov = 2.0 * (width / 2.0 / focal).atan().to_degrees();
                let [low, high] = self.range_deg.unwrap_or([fov; 2]);
                self.range_deg = Some([low.min(fov), high.max(fov)]);
                1
            }
            (false, None) => 0,
        };
        self.counts[kind] += 1;
    }
}

impl fmt::Display for LensNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [assumed, read, given] = self.counts;
        let total = assumed + read + given;
        if let Some([low, high]) = self.range_deg {
            match high - low < 0.5 {
                true => write!(f, "{high:.0}° across by EXIF")?,
                false => write!(f, "{low:.0} to {high:.0}° across by EXIF")?,
            }
        }
        match (assumed, read, given) {
            (0, _, 0) => Ok(()),
            (0, ..) => write!(f, "as given"),
            (_, 0, _) => write!(
                f,
                "unknown: 60° across assumed; take the facing angles, or give --fov or --focal"
            ),
            _ => write!(
                f,
                "; unknown in {assumed} of {total} frames: 60° assumed there"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_of_view_is_that_across_the_frame() {
        let camera = Lens::FieldOfView(90.0)
            .camera((640, 480), None)
            .unwrap()
            .unwrap();
        assert!((camera.fx - 320.0).abs() < 1e-3);
        assert!(Lens::Unknown.camera((640, 480), None).unwrap().is_none());
        let read = Lens::Unknown
            .camera((640, 480), Some(700.0))
            .unwrap()
            .unwrap();
        assert_eq!((read.fx, read.cx), (700.0, 319.5));
    }

    #[test]
    fn the_note_says_what_is_assumed() {
        let (mut note, options) = (LensNote::default(), TrackerArgs::default());
        note.add(&options, 640.0, None);
        assert!(note.to_string().starts_with("unknown: 60° across assumed"));
        note.add(&options, 640.0, Some(320.0));
        let text = note.to_string();
        assert_eq!(
            text,
            "90° across by EXIF; unknown in 1 of 2 frames: 60° assumed there"
        );
        let given = TrackerArgs {
            fov: Some(50.0),
            ..TrackerArgs::default()
        };
        let mut note = LensNote::default();
        note.add(&given, 640.0, Some(320.0));
        assert_eq!(note.to_string(), "as given");
    }
}
