//! `posewise-lab eval faceless`: false tracks in pictures without a face.
//!
//! Every picture is panned: a window of three quarters of its width (the whole width of an upright
//! picture), scaled to 480×360, moves from the upper left to the lower right in 25 frames, at 25
//! frames per second. One tracker gets all pictures. With `--after`, 60 frames of a clip come
//! before each, so that the tracker has just lost a face of which it has keyframes.

use std::path::PathBuf;

use anyhow::Result;
use image::GrayImage;
use posewise::State;
use posewise_cli::cli::TrackerArgs;
use posewise_cli::model_file::ModelFile;
use serde_json::{Map, Value, json};

use super::show::Show;
use crate::eval::camera;
use crate::footage::backgrounds::{self, BackgroundsArgs, covering, window};
use crate::footage::clip::{Clip, back_and_forth};
use crate::output;

/// Options of `posewise-lab eval faceless`.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub backgrounds: BackgroundsArgs,
    /// Show 60 frames of this clip with a face before each picture
    #[arg(long, value_name = "CLIP")]
    pub after: Option<String>,
    #[command(flatten)]
    pub camera: camera::Args,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Size of the frames \[px\].
const FRAME: (u32, u32) = (480, 360);
/// Width of a picture that is wider than high, in frames of that size \[px\].
const WIDE: u32 = 640;
/// Frames of a pan.
const PAN: usize = 25;
const FPS: f64 = 25.0;
/// Frames of the clip before each picture.
const AFTER: usize = 60;
/// Most frames of the clip that are kept in memory.
const MAX_FRAMES: usize = 1500;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let paths = backgrounds::list(&args.backgrounds)?;
    let faces = match &args.after {
        Some(input) => faces_of(input)?,
        None => vec![],
    };
    let file = ModelFile::read(args.tracker.model.as_deref())?;
    let model = file.model()?;
    let mut show = Show::new(&model, &args.tracker, false, FPS)?;
    let mut tracks = Vec::new();
    let (mut tracked_before, mut faces_shown) = (0, 0);
    let mut seed = 0;
    let mut shown = |frame: GrayImage| {
        seed += 1;
        camera::through(&args.camera, frame, seed)
    };
    for path in &paths {
        let mut state = State::Searching;
        for _ in 0..if faces.is_empty() { 0 } else { AFTER } {
            let frame = shown(faces[back_and_forth(faces_shown, faces.len())].clone());
            state = show.frame(&frame)?.state;
            faces_shown += 1;
        }
        tracked_before += usize::from(state == State::Tracking);
        let picture = scaled(&backgrounds::open(path)?);
        let mut tracked = 0;
        for k in 0..PAN {
            let frame = shown(window(&picture, FRAME, k as f64 / (PAN - 1) as f64));
            tracked += usize::from(show.frame(&frame)?.state == State::Tracking);
        }
        tracks.push(tracked);
    }
    let (frames, tracked) = (PAN * paths.len(), tracks.iter().sum::<usize>());
    let wrong = paths
        .iter()
        .zip(&tracks)
        .filter(|(_, tracked)| **tracked > 0);
    let wrong: Map<String, Value> = wrong
        .map(|(path, tracked)| (path.display().to_string(), json!(tracked)))
        .collect();
    let tracked_before = args.after.as_ref().map(|_| tracked_before);
    let figures = json!({"pictures": paths.len(), "frames": frames, "tracked": tracked,
        "tracked_before": tracked_before, "tracked_in": wrong});
    output::show(&figures, args.json.as_deref())
}

/// So that the window is as large as a frame.
fn scaled(picture: &GrayImage) -> GrayImage {
    let wide = picture.width() > picture.height();
    covering(picture, (if wide { WIDE } else { FRAME.0 }, FRAME.1))
}

/// The clip's frames in the size of the others.
fn faces_of(input: &str) -> Result<Vec<GrayImage>> {
    let clip = Clip::open(input, FPS, MAX_FRAMES)?;
    let fitted = |image: &GrayImage| window(&covering(image, FRAME), FRAME, 0.5);
    Ok(clip.frames.iter().map(fitted).collect())
}
