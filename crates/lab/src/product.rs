//! posewise itself, as the command runs it.

use crate::tracked::Tracked;
use anyhow::{Context, Result};
use image::GrayImage;
use posewise::{Model, State, TrackResult};
use posewise_cli::cli::TrackerArgs;
use posewise_cli::model_file::ModelFile;
use posewise_cli::picture::Picture;
use posewise_cli::session;
use posewise_cli::source::read_rgb;
use std::path::{Path, PathBuf};

/// Time between frames \[µs\]: 30 a second.
const STEP_US: i64 = 33_333;
/// A still is shown at most so often until its face is tracked; the scan budget covers a whole
/// picture in one step.
const STILL_SEARCHES: usize = 8;
/// More steps on a still once it is tracked, as `posewise-lab eval landmarks` has by default.
const STILL_STEPS: usize = 4;
/// How often another tracker sees a still.
pub const STILL_FRAMES: usize = STILL_SEARCHES + STILL_STEPS;

/// Which model, and which camera.
#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// The model; the embedded one without it.
    #[arg(long)]
    pub model: Option<PathBuf>,
    /// Focal length \[px\]; that of 60° across without it.
    #[arg(long)]
    pub focal: Option<f32>,
}

/// Reads the model.
pub fn read(options: &Options) -> Result<ModelFile> {
    let file = ModelFile::read(options.model.as_deref())?;
    file.model()?;
    Ok(file)
}

/// A tracker that follows one clip.
pub struct Session<'m> {
    session: session::Session<'m>,
    time_us: i64,
}

impl<'m> Session<'m> {
    /// For a clip of a camera with this focal length \[px\].
    pub fn new(model: &'m Model<'m>, focal: Option<f32>) -> Result<Session<'m>> {
        let settings = TrackerArgs {
            focal,
            ..TrackerArgs::default()
        };
        Ok(Session {
            session: session::Session::new(model, &settings, false)?,
            time_us: 0,
        })
    }

    /// The camera of the last frame.
    pub fn camera(&self) -> posewise::Intrinsics {
        self.session.intrinsics()
    }

    /// The next frame.
    pub fn step(&mut self, luma: &GrayImage) -> Result<&TrackResult> {
        let mut picture = Picture::from_grey(luma.clone());
        self.time_us += STEP_US;
        picture.timestamp_us = self.time_us;
        self.session.step(&picture)
    }
}

/// The luma of a picture.
pub fn read_luma(path: &Path) -> Result<GrayImage> {
    let grey = Picture::from_rgb(read_rgb(path)?).upright_grey();
    grey.with_context(|| path.display().to_string())
}

/// One picture for a fresh tracker, which sees it again until it has settled.
pub fn still(model: &Model<'_>, focal: Option<f32>, path: &Path) -> Result<Option<Tracked>> {
    let luma = read_luma(path)?;
    let mut session = Session::new(model, focal)?;
    let mut is_tracked = false;
    for _ in 0..STILL_SEARCHES {
        is_tracked = is_tracked || session.step(&luma)?.state == State::Tracking;
    }
    let mut found = None;
    for _ in 0..STILL_STEPS {
        found = Tracked::of(session.step(&luma)?).or(found);
    }
    Ok(found)
}
