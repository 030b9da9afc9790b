//! posewise itself, through its public interface.

use crate::tracked::Tracked;
use crate::video::Luma;
use anyhow::{Context, Result, anyhow};
use posewise::{Config, Intrinsics, Model, State, TrackResult, Tracker};
use posewise_format::AlignedBytes;
use std::path::{Path, PathBuf};

/// Time between frames \[µs\]: 30 a second.
const STEP_US: i64 = 33_333;
/// A still is shown at most so often until its face is tracked; the scan budget covers a whole
/// picture in one step.
const STILL_SEARCHES: usize = 8;
/// More steps on a still once it is tracked, as `posewise-lab eval landmarks` has by default.
const STILL_STEPS: usize = 4;
/// Work per step: nothing here is in a hurry.
const SCAN_BUDGET: u32 = 10_000_000;

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

/// The bytes of a model, and the camera.
pub struct Product {
    bytes: Option<AlignedBytes>,
    focal: Option<f32>,
}

impl Product {
    /// Reads the model.
    pub fn new(options: &Options) -> Result<Product> {
        let read = |path: &PathBuf| -> Result<AlignedBytes> {
            let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
            Ok(AlignedBytes::new(&bytes))
        };
        let product = Product {
            bytes: options.model.as_ref().map(read).transpose()?,
            focal: options.focal,
        };
        product.model()?;
        Ok(product)
    }

    /// The model.
    pub fn model(&self) -> Result<Model<'_>> {
        Model::load(self.bytes()).map_err(|e| anyhow!("the model: {e}"))
    }

    /// The bytes of the model.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.as_deref().unwrap_or(posewise::DEFAULT_MODEL)
    }

    /// A tracker for one clip.
    pub fn start(&self) -> Result<Session<'_>> {
        self.start_with(self.focal)
    }

    /// A tracker for one clip of a camera with this focal length \[px\].
    pub fn start_with(&self, focal: Option<f32>) -> Result<Session<'_>> {
        let mut config = Config::default();
        config.scan_budget = SCAN_BUDGET;
        Ok(Session {
            focal,
            model: self.model()?,
            tracker: Box::new(Tracker::new(&config).map_err(|e| anyhow!("{e}"))?),
            time_us: 0,
        })
    }

    /// One picture for a fresh tracker, which sees it again until it has settled.
    pub fn still(&self, path: &Path) -> Result<Option<Tracked>> {
        let luma = Luma::read(path)?;
        let mut session = self.start()?;
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
}

/// A tracker that follows one clip.
pub struct Session<'p> {
    focal: Option<f32>,
    model: Model<'p>,
    tracker: Box<Tracker>,
    time_us: i64,
}

impl Session<'_> {
    /// The camera of frames of this size.
    pub fn camera(&self, width: usize, height: usize) -> Intrinsics {
        let default = Intrinsics::of_frame(width as i32, height as i32);
        let given = |f| Intrinsics::new(f, f, default.cx, default.cy);
        self.focal.map_or(default, given)
    }

    /// The next frame.
    pub fn step(&mut self, luma: &Luma) -> Result<&TrackResult> {
        if self.time_us == 0 {
            let camera = self.camera(luma.width, luma.height);
            let set = self.tracker.set_intrinsics(Some(camera));
            set.map_err(|e| anyhow!("{e}"))?;
        }
        self.time_us += STEP_US;
        let frame = luma.frame()?;
        let stepped = self.tracker.step(&self.model, &frame, self.time_us);
        stepped.map_err(|e| anyhow!("{e}"))
    }
}
