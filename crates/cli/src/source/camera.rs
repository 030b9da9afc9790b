//! A V4L2 camera (`/dev/videoN`), on Linux. Timestamps are the driver's.

use anyhow::{Result, bail};

use super::stream::Source;

/// Opens a camera.
#[cfg(not(target_os = "linux"))]
pub fn open(device: &str) -> Result<Box<dyn Source>> {
    bail!("{device}: cameras are read through V4L2, which only Linux has; pipe y4m in instead");
}

/// Opens a camera at a resolution near 640×480, in a format whose luma can be read in place, or
/// else in motion JPEG.
#[cfg(target_os = "linux")]
pub fn open(device: &str) -> Result<Box<dyn Source>> {
    Ok(Box::new(linux::CameraSource::open(device)?))
}

#[cfg(target_os = "linux")]
mod linux {
    use anyhow::{Context, Result, anyhow};
    use posewise::{FrameLayout, PixelFormat};
    use rscam::{Camera, Config, ResolutionInfo};

    use super::{Source, bail};
    use crate::picture::{Chroma, Picture};

    /// Formats in the order of preference: cheap luma first, compressed last.
    const FORMATS: [&[u8; 4]; 9] = [
        b"GREY", b"YUYV", b"UYVY", b"NV12", b"YU12", b"RGB3", b"BGR3", b"MJPG", b"JPEG",
    ];
    const WANTED: (u32, u32) = (640, 480);

    pub struct CameraSource {
        camera: Camera,
        device: String,
        fps: f64,
        last_us: i64,
    }

    impl CameraSource {
        pub fn open(device: &str) -> Result<Self> {
            let mut camera =
                Camera::new(device).with_context(|| format!("cannot open camera {device}"))?;
            let offered: Vec<[u8; 4]> = camera
                .formats()
                .filter_map(|f| f.ok().map(|f| f.format))
                .collect();
            let Some(format) = FORMATS.into_iter().find(|f| offered.contains(f)) else {
                bail!("{device} offers no picture format that posewise reads");
            };
            let resolution = nearest(camera.resolutions(format).ok());
            let mut started = Err(rscam::Error::BadInterval);
            let mut fps = 0;
            for rate in [30, 25, 15, 10, 60, 5] {
                fps = rate;
                started = camera.start(&Config {
                    interval: (1, rate),
                    resolution,
                    format,
                    nbuffers: 4,
                    ..Default::default()
                });
                if started.is_ok() {
                    break;
                }
            }
            started.map_err(|e| anyhow!("cannot start camera {device}: {e}"))?;
            Ok(CameraSource {
                camera,
                device: device.into(),
                fps: fps.into(),
                last_us: i64::MIN,
            })
        }
    }

    impl Source for CameraSource {
        fn next(&mut self) -> Result<Option<Picture>> {
            let frame = self
                .camera
                .capture()
                .with_context(|| format!("camera {} stopped", self.device))?;
            // Drivers without a clock of their own may repeat a time; the tracker refuses that.
            let time = (frame.get_timestamp() as i64).max(self.last_us.saturating_add(1));
            self.last_us = time;
            let mut picture = decode(&frame)?;
            picture.timestamp_us = time;
            Ok(Some(picture))
        }

        fn fps(&self) -> f64 {
            self.fps
        }

        fn is_live(&self) -> bool {
            true
        }
    }

    fn decode(frame: &rscam::Frame) -> Result<Picture> {
        if matches!(&frame.format, b"MJPG" | b"JPEG") {
            let image = image::load_from_memory_with_format(frame, image::ImageFormat::Jpeg)
                .context("the camera's JPEG frame is broken")?;
            return Ok(Picture::from_rgb(image.into_rgb8()));
        }
        let format = PixelFormat::from_fourcc(u32::from_le_bytes(frame.format))
            .ok_or_else(|| anyhow!("the camera changed its format"))?;
        let (width, height) = frame.resolution;
        let planar = matches!(format, PixelFormat::Nv12 | PixelFormat::Yu12);
        let rows = if planar { height * 3 / 2 } else { height };
        let chroma = match format {
            PixelFormat::Yu12 => Chroma::Planar { across: 2, down: 2 },
            _ => Chroma::None,
        };
        let mut layout = FrameLayout::new(format, width, height);
        // The driver's bytesperline is not passed through; it follows from the length.
        layout.stride = frame.len() as u32 / rows.max(1);
        Ok(Picture {
            layout,
            data: frame.to_vec(),
            chroma,
            full_range: false,
            timestamp_us: 0,
            focal_px: None,
        })
    }

    fn nearest(offered: Option<ResolutionInfo>) -> (u32, u32) {
        let distance = |(w, h): (u32, u32)| w.abs_diff(WANTED.0) + h.abs_diff(WANTED.1);
        match offered {
            Some(ResolutionInfo::Discretes(list)) => list
                .into_iter()
                .min_by_key(|r| distance(*r))
                .unwrap_or(WANTED),
            Some(ResolutionInfo::Stepwise { min, max, .. }) => (
                WANTED.0.clamp(min.0, max.0.max(min.0)),
                WANTED.1.clamp(min.1, max.1.max(min.1)),
            ),
            None => WANTED,
        }
    }
}
