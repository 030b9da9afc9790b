//! One tracker with its settings and its camera.

use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use posewise::image::{Frame, Roi};
use posewise::shape::Intrinsics;
use posewise::track::{
    Config, Detected, EventLog, FoundFace, Model, StepError, TrackResult, Tracker,
};

use crate::calibration::Calibration;
use crate::cli::TrackerArgs;
use crate::picture::Picture;

/// A tracker that follows the frame's size with its camera.
pub struct Session<'m> {
    model: &'m Model<'m>,
    tracker: Box<Tracker>,
    focal: Option<f32>,
    calibration: Option<Calibration>,
    /// That of the current frame.
    camera: Intrinsics,
    smooth: bool,
    size: (i32, i32),
    /// Time spent in steps.
    pub busy: Duration,
}

/// A search budget that no frame uses up.
const WHOLE_FRAME: u32 = 10_000_000;

impl<'m> Session<'m> {
    /// A new tracker with these settings. Only a live camera's frames cannot wait: elsewhere every
    /// frame is searched completely unless the settings say otherwise.
    pub fn new(model: &'m Model<'m>, args: &TrackerArgs, live: bool) -> Result<Self> {
        let mut config = Config::default();
        config.min_face_px = args.min_face.unwrap_or(config.min_face_px);
        let budget = if live {
            config.scan_budget
        } else {
            WHOLE_FRAME
        };
        config.scan_budget = args.scan_budget.unwrap_or(budget);
        config.gaze = args.gaze || args.natural_gaze;
        config.natural_gaze = args.natural_gaze;
        let smoothing = &mut config.smoothing;
        smoothing.cutoff_hz = args.smooth_cutoff.unwrap_or(smoothing.cutoff_hz);
        smoothing.beta = args.smooth_beta.unwrap_or(smoothing.beta);
        Ok(Session {
            model,
            tracker: Box::new(Tracker::new(&config).map_err(|e| anyhow!("{e}"))?),
            focal: args.focal,
            calibration: (args.calibration.as_deref())
                .map(|path| Calibration::read(path, args.fisheye))
                .transpose()?,
            camera: Intrinsics::of_frame(0, 0),
            smooth: args.smooth,
            size: (0, 0),
            busy: Duration::ZERO,
        })
    }

    /// Searches only this region of the frames.
    pub fn set_roi(&mut self, roi: Option<Roi>) -> Result<()> {
        self.tracker.set_roi(roi).map_err(|e| anyhow!("--roi: {e}"))
    }

    /// The camera that the tracker assumes for the current frame.
    pub fn intrinsics(&self) -> Intrinsics {
        self.camera
    }

    /// The camera of frames of this size.
    fn camera_for(&self, (width, height): (i32, i32)) -> Result<Intrinsics> {
        if let Some(calibration) = &self.calibration {
            return calibration.camera(width, height);
        }
        let mut camera = Intrinsics::of_frame(width, height);
        if let Some(focal) = self.focal {
            (camera.fx, camera.fy) = (focal, focal);
        }
        Ok(camera)
    }

    /// The events that were not written yet.
    pub fn events(&mut self) -> &mut EventLog {
        self.tracker.events()
    }

    /// One frame.
    pub fn step(&mut self, picture: &Picture) -> Result<&TrackResult> {
        self.call(picture, |tracker, model, frame| {
            let stepped = tracker.step(model, frame, picture.timestamp_us);
            stepped.map(drop)
        })?;
        Ok(self.shown())
    }

    /// One frame, on which a face is expected.
    pub fn step_at(&mut self, picture: &Picture, face: &FoundFace) -> Result<()> {
        self.call(picture, |tracker, model, frame| {
            let stepped = tracker.step_at(model, frame, picture.timestamp_us, &face.hint());
            stepped.map(drop)
        })
    }

    /// Looks for faces, whatever the tracker does.
    pub fn detect(&mut self, picture: &Picture, found: &mut [FoundFace]) -> Result<Detected> {
        self.call(picture, |tracker, model, frame| {
            tracker.detect(model, frame, found)
        })
    }

    /// Calls the tracker with a frame, and measures the time that it takes.
    fn call<T>(
        &mut self,
        picture: &Picture,
        call: impl FnOnce(&mut Tracker, &Model<'m>, &Frame<'_>) -> Result<T, StepError>,
    ) -> Result<T> {
        let frame = picture.frame()?;
        let size = (frame.width(), frame.height());
        if size != self.size {
            (self.size, self.camera) = (size, self.camera_for(size)?);
            // Where nothing is known of it, the tracker has the same default.
            let is_known = self.focal.is_some() || self.calibration.is_some();
            self.tracker
                .set_intrinsics(is_known.then_some(self.camera))
                .map_err(|e| anyhow!("{e}"))?;
        }
        let start = Instant::now();
        let called = call(&mut self.tracker, self.model, &frame);
        self.busy += start.elapsed();
        called.map_err(|e| match e {
            StepError::Roi => anyhow!(
                "--roi: does not lie in the frame of {}×{} px",
                size.0,
                size.1
            ),
            e => anyhow!("{e}"),
        })
    }

    /// The result of the last step.
    pub fn result(&self) -> &TrackResult {
        self.tracker.result()
    }

    /// The same, smoothed.
    pub fn smoothed(&self) -> &TrackResult {
        self.tracker.smoothed()
    }

    /// The same, smoothed if that is wanted.
    pub fn shown(&self) -> &TrackResult {
        match self.smooth {
            false => self.result(),
            true => self.smoothed(),
        }
    }

    /// Leaves the faces with these boxes to others.
    pub fn exclude(&mut self, boxes: &[[f32; 4]]) -> Result<()> {
        self.tracker.set_excluded(boxes).map_err(|e| anyhow!("{e}"))
    }
}
