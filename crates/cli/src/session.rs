//! One tracker with its settings and its camera.

use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use posewise::mesh::{MAX_VERTICES, MeshError, MeshShape, MeshSpace, MeshVertex};
use posewise::{Config, EventLog, Frame, Intrinsics, Model, Roi, StepError, TrackResult, Tracker};

use crate::cli::TrackerArgs;
use crate::lens::Lens;
use crate::monitor::Turn;
use crate::picture::Picture;

/// A tracker that follows the frame's size with its camera.
pub struct Session<'m> {
    model: &'m Model<'m>,
    tracker: Box<Tracker>,
    lens: Lens,
    /// That of the current frame.
    camera: Intrinsics,
    smooth: bool,
    /// Size of the current frame, and the focal length that its file says.
    frame: ((i32, i32), Option<f32>),
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
            lens: Lens::new(args)?,
            camera: Intrinsics::of_frame(0, 0),
            smooth: args.smooth,
            frame: ((0, 0), None),
            busy: Duration::ZERO,
        })
    }

    /// Searches only this region of the frames.
    pub fn set_roi(&mut self, roi: Option<Roi>) -> Result<()> {
        self.tracker.set_roi(roi).map_err(|e| anyhow!("--roi: {e}"))
    }

    /// Turns to the driver or back. A region that was asked for stays.
    pub fn turn(&mut self, turn: Turn, asked: Option<Roi>) -> Result<()> {
        match turn {
            Turn::ToDriver(around) => {
                self.tracker.reset();
                self.set_roi(asked.or(Some(around)))
            }
            Turn::ToAnyone => self.set_roi(asked),
        }
    }

    /// The camera that the tracker assumes for the current frame.
    pub fn intrinsics(&self) -> Intrinsics {
        self.camera
    }

    /// The events that were not written yet.
    pub fn events(&mut self) -> &mut EventLog {
        self.tracker.events()
    }

    /// One frame.
    pub fn step(&mut self, picture: &Picture) -> Result<&TrackResult> {
        let (frame, model) = (picture.frame()?, self.model);
        let tracker = self.ready(&frame, picture.focal_px)?;
        let start = Instant::now();
        let stepped = tracker.step(model, &frame, picture.timestamp_us).map(drop);
        self.busy += start.elapsed();
        stepped.map_err(|e| in_words(e, &frame))?;
        Ok(self.shown())
    }

    /// The tracker, with the camera of this frame.
    pub fn ready(&mut self, frame: &Frame<'_>, focal_px: Option<f32>) -> Result<&mut Tracker> {
        let size = (frame.width(), frame.height());
        if (size, focal_px) != self.frame {
            let camera = self.lens.camera(size, focal_px)?;
            self.tracker
                .set_intrinsics(camera)
                .map_err(|e| anyhow!("{e}"))?;
            // Where nothing is known of it, the tracker has the same default.
            self.camera = camera.unwrap_or_else(|| Intrinsics::of_frame(size.0, size.1));
            self.frame = (size, focal_px);
        }
        Ok(&mut self.tracker)
    }

    /// Width and height of the current frame \[px\].
    pub fn size(&self) -> (i32, i32) {
        self.frame.0
    }

    /// The mesh of the face of the last step, head frame \[mm\].
    pub fn mesh(&self) -> Result<Vec<MeshVertex>, MeshError> {
        vertices(|out| self.tracker.mesh(self.model, MeshSpace::Head, out))
    }

    /// A shape of the person's own head, head frame \[mm\].
    pub fn mesh_shape(&self, shape: MeshShape) -> Result<Vec<MeshVertex>, MeshError> {
        vertices(|out| self.tracker.mesh_shape(self.model, shape, out))
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
}

/// Why a frame was refused.
pub fn in_words(error: StepError, frame: &Frame<'_>) -> anyhow::Error {
    match error {
        StepError::Roi => anyhow!(
            "--roi: does not lie in the frame of {}×{} px",
            frame.width(),
            frame.height()
        ),
        e => anyhow!("{e}"),
    }
}

/// What a call writes.
fn vertices(
    write: impl FnOnce(&mut [MeshVertex]) -> Result<usize, MeshError>,
) -> Result<Vec<MeshVertex>, MeshError> {
    let mut vertices = vec![MeshVertex::default(); MAX_VERTICES];
    let count = write(&mut vertices)?;
    vertices.truncate(count);
    Ok(vertices)
}
