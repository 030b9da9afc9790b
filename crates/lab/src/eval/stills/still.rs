//! Labelled pictures, each of which is a still for a fresh tracker.
//!
//! The picture is shown again and again, 33 ms apart, until the tracker tracks (at most
//! [`MAX_SEARCH_STEPS`] times, a budget that covers a whole scan many times over), then `--steps`
//! times more, as a camera's next frames would be. The last fit counts.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use indicatif::{ParallelProgressIterator, ProgressBar};
use posewise::detect::Detection;
use posewise::{Config, Intrinsics, Model, State, TrackResult, Tracker};
use posewise_cli::model_file::ModelFile;
use posewise_cli::picture::Picture;
use posewise_cli::source::read_rgb;
use rayon::prelude::*;

/// How each picture is shown to a new tracker.
#[derive(clap::Args)]
pub struct StillsArgs {
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Narrowest face searched for [px]
    #[arg(long, value_name = "PX", default_value_t = 30)]
    pub min_face: u32,
    /// Steps on the same picture after the one that found the face
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub steps: u32,
    /// Threads; 0 for all cores
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
}

const STEP_US: i64 = 33_333;
/// With [`SCAN_BUDGET`] one step searches any usual picture completely; a second search finds
/// nothing new.
const MAX_SEARCH_STEPS: u32 = 8;
/// Windows per step: stills are not in a hurry.
const SCAN_BUDGET: u32 = 10_000_000;
/// Trackers live on the threads' stacks in debug builds.
const THREAD_STACK: usize = 32 << 20;

/// How pictures are shown.
pub struct Stills {
    file: ModelFile,
    config: Config,
    /// Focal length \[px\]; `None` leaves the camera unknown.
    pub focal: Option<f32>,
    more_steps: u32,
    threads: usize,
}

/// The last fit on a picture.
pub struct Fit {
    /// What the tracker reports.
    pub result: TrackResult,
    /// Whether the first step found it.
    pub is_at_once: bool,
}

/// Shows pictures to trackers.
pub struct Showing<'a> {
    stills: &'a Stills,
    model: Model<'a>,
}

impl Stills {
    /// Checks the settings.
    pub fn new(args: &StillsArgs) -> Result<Self> {
        ensure!(
            args.images.is_dir(),
            "no such folder: {}",
            args.images.display()
        );
        let file = ModelFile::read(args.model.as_deref())?;
        Stills::of(file, args.min_face, args.steps, args.threads)
    }

    /// Stills that need no folder; the arguments are those of [`StillsArgs`].
    pub fn of(file: ModelFile, min_face: u32, steps: u32, threads: usize) -> Result<Self> {
        let mut config = Config::default();
        config.min_face_px = min_face;
        config.scan_budget = SCAN_BUDGET;
        Tracker::new(&config).map_err(|e| anyhow!("{e}"))?;
        Ok(Stills {
            file,
            config,
            focal: None,
            more_steps: steps,
            threads,
        })
    }

    /// What `of` makes of each label and its index, on several threads.
    pub fn each<L: Sync, T: Send>(
        &self,
        labels: &[L],
        of: impl Fn(&Showing<'_>, usize, &L) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let showing = Showing {
            stills: self,
            model: self.file.model()?,
        };
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .stack_size(THREAD_STACK)
            .build()
            .context("cannot start threads")?;
        let progress = ProgressBar::new(labels.len() as u64);
        pool.install(|| {
            labels
                .par_iter()
                .progress_with(progress)
                .enumerate()
                .map(|(index, label)| of(&showing, index, label))
                .collect()
        })
    }
}

impl Showing<'_> {
    /// Shows a picture of a folder to a fresh tracker; the last fit.
    pub fn fit_file(&self, folder: &Path, image: &str) -> Result<Option<Fit>> {
        let picture = Picture::from_rgb(read_rgb(&folder.join(image))?);
        self.fit(picture, None).with_context(|| image.to_owned())
    }

    /// Shows the picture to a fresh tracker; the last fit. `start`, if any, is where the face is.
    pub fn fit(&self, mut picture: Picture, mut start: Option<Detection>) -> Result<Option<Fit>> {
        let tracker = Tracker::new(&self.stills.config).map_err(|e| anyhow!("{e}"))?;
        let mut tracker = Box::new(tracker);
        if let Some(focal) = self.stills.focal {
            let frame = picture.frame()?;
            let mut camera = Intrinsics::of_frame(frame.width(), frame.height());
            (camera.fx, camera.fy) = (focal, focal);
            tracker
                .set_intrinsics(Some(camera))
                .map_err(|e| anyhow!("{e}"))?;
        }
        let mut found = None;
        let mut is_at_once = false;
        let (mut step, mut last) = (0, MAX_SEARCH_STEPS);
        while step < last {
            step += 1;
            picture.timestamp_us += STEP_US;
            let frame = picture.frame()?;
            let time = picture.timestamp_us;
            let result = match start.take() {
                Some(face) => tracker.fit_at(&self.model, &frame, time, &face),
                None => tracker.step(&self.model, &frame, time),
            };
            let result = result.map_err(|e| anyhow!("{e}"))?;
            if result.state == State::Tracking {
                if found.is_none() {
                    is_at_once = step == 1;
                    last = step + self.stills.more_steps;
                }
                found = Some(*result);
            }
        }
        Ok(found.map(|result| Fit { result, is_at_once }))
    }
}
