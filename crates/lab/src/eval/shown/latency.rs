//! `posewise-lab eval latency`: frames until a small face anywhere in a photograph is tracked.
//!
//! A frame is a picture without people that a labelled picture, scaled so that its face has the
//! wanted size, is put into at a random place. It is shown again and again to a fresh tracker with
//! a camera's work per frame. A face counts as found once landmarks are reported whose mean lies
//! within a third of the face's size of the labels' mean.

use std::path::PathBuf;

use anyhow::{Result, bail};
use image::GrayImage;
use image::imageops::{FilterType, replace, resize};
use posewise::{Landmark, Model, State};
use posewise_cli::cli::TrackerArgs;
use posewise_cli::model_file::ModelFile;
use posewise_cli::parse::within;
use posewise_metrics::landmarks::bounds;
use serde_json::{Map, json};

use super::show::Show;
use crate::eval::stills::labels::{Label, read_labels};
use crate::footage::backgrounds::{self, BackgroundsArgs, covering, window};
use crate::output;
use crate::random::Random;

/// Options of `posewise-lab eval latency`.
#[derive(clap::Args)]
pub struct Args {
    /// Labels of pictures with one face, as for `eval landmarks`
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    #[command(flatten)]
    pub backgrounds: BackgroundsArgs,
    /// Size of the frames [px]; repeat for several [default: 640x480 1280x720 3840x2160]
    #[arg(long, value_name = "WxH", value_parser = frame_size)]
    pub frame: Vec<(u32, u32)>,
    /// Longer side of the box of the landmarks [px]
    #[arg(long, value_name = "PX", default_value_t = 60.0, value_parser = within(16.0, 1000.0))]
    pub face: f64,
    /// Faces in frames of each size
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub faces: usize,
    /// Most frames that are shown of each
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub frames: usize,
    /// Draws faces, places and pictures
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Frames per second.
const FPS: f64 = 30.0;
/// Sizes of frames where none are given \[px\].
const FRAMES: [(u32, u32); 3] = [(640, 480), (1280, 720), (3840, 2160)];
/// How far the mean of the landmarks may be off \[face sizes\].
const NEAR: f64 = 1.0 / 3.0;

/// Parses width and height of a frame, as `640x480`.
fn frame_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').map(|(w, h)| (w.parse(), h.parse()));
    match sides {
        Some((Ok(w @ 16..=16_384), Ok(h @ 16..=16_384))) => Ok((w, h)),
        _ => Err("not a size of 16 to 16384 px, as 640x480".into()),
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if args.faces == 0 || args.frames == 0 {
        bail!("--faces and --frames must be at least 1");
    }
    let labels = read_labels(&args.csv)?;
    if labels.is_empty() {
        bail!("{} names no picture", args.csv.display());
    }
    let backgrounds = backgrounds::list(&args.backgrounds)?;
    let file = ModelFile::read(args.tracker.model.as_deref())?;
    let model = file.model()?;
    let sizes = match args.frame.as_slice() {
        [] => &FRAMES,
        given => given,
    };
    let mut value = Map::new();
    for size @ (width, height) in sizes {
        let mut random = Random::of(args.seed);
        let mut until = Vec::new();
        for _ in 0..args.faces {
            let scene = Scene::draw(&labels, &backgrounds, *size, args, &mut random)?;
            until.push(frames_until(&model, &scene, args)?);
        }
        let sum = summarize(&until);
        let name = format!("{width}x{height}");
        let row = json!({"median_frames": sum.median, "p95_frames": sum.most,
            "worst_frames": sum.worst, "not_found": sum.never, "frames_until_tracked": until});
        value.insert(name, row);
    }
    value.insert("face_px".into(), json!(args.face));
    value.insert("seed".into(), json!(args.seed));
    output::show(&value.into(), args.json.as_deref())
}

/// The numbers of one row \[frames\]; `None` where a face that is not found would decide.
#[derive(Debug, PartialEq)]
struct Sum {
    /// So many or fewer for half of the faces.
    median: Option<u32>,
    /// For 95 % of them.
    most: Option<u32>,
    /// Of the faces that are found.
    worst: Option<u32>,
    never: usize,
}

fn summarize(until: &[Option<u32>]) -> Sum {
    let mut sorted = until.to_vec();
    sorted.sort_by_key(|frames| frames.unwrap_or(u32::MAX));
    let part = |q: f64| {
        let rank = (q * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.saturating_sub(1)).copied().flatten()
    };
    Sum {
        median: part(0.5),
        most: part(0.95),
        worst: until.iter().copied().flatten().max(),
        never: until.iter().filter(|frames| frames.is_none()).count(),
    }
}

/// A frame and where its face is.
struct Scene {
    frame: GrayImage,
    /// Mean of the true landmarks \[px\].
    centre: [f64; 2],
}

impl Scene {
    /// One of the faces somewhere in one of the pictures.
    fn draw(
        labels: &[Label],
        backgrounds: &[PathBuf],
        size: (u32, u32),
        args: &Args,
        random: &mut Random,
    ) -> Result<Scene> {
        let background = &backgrounds[random.below(backgrounds.len())];
        let mut frame = window(&covering(&backgrounds::open(background)?, size), size, 0.5);
        let label = &labels[random.below(labels.len())];
        let [left, top, right, bottom] = bounds(&label.points);
        let scale = args.face / (right - left).max(bottom - top).max(1.0);
        let picture = backgrounds::open(&args.images.join(&label.image))?;
        let scaled = |side: u32| ((f64::from(side) * scale).round() as u32).max(1);
        let (width, height) = (scaled(picture.width()), scaled(picture.height()));
        let picture = resize(&picture, width, height, FilterType::Triangle);
        // All of the face is in the frame; of the picture around it perhaps not.
        let mut place = |low: f64, high: f64, side: u32| {
            let first = (-low * scale).ceil() as i64;
            let last = (f64::from(side) - high * scale).floor() as i64;
            first + random.below((last - first + 1).max(1) as usize) as i64
        };
        let at = [place(left, right, size.0), place(top, bottom, size.1)];
        replace(&mut frame, &picture, at[0], at[1]);
        let sum = |axis: usize| label.points.iter().map(|p| p[axis]).sum::<f64>();
        let count = label.points.len() as f64;
        let centre = [0, 1].map(|axis| sum(axis) / count * scale + at[axis] as f64);
        Ok(Scene { frame, centre })
    }
}

/// Frames until the face is tracked, counting that one; `None` if it is not.
fn frames_until(model: &Model<'_>, scene: &Scene, args: &Args) -> Result<Option<u32>> {
    let mut show = Show::new(model, &args.tracker, true, FPS)?;
    for number in 1..=args.frames as u32 {
        let result = show.frame(&scene.frame)?;
        if result.state == State::Tracking {
            let mean = |of: fn(&Landmark) -> f32| {
                let sum: f64 = result.landmarks.iter().map(|l| f64::from(of(l))).sum();
                sum / result.landmarks.len() as f64
            };
            let [x, y] = [
                mean(|l| l.x) - scene.centre[0],
                mean(|l| l.y) - scene.centre[1],
            ];
            if x.hypot(y) <= NEAR * args.face {
                return Ok(Some(number));
            }
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_by_hand() {
        let until: Vec<Option<u32>> = (1..=19).rev().map(Some).chain([None]).collect();
        let sum = summarize(&until);
        assert_eq!((sum.median, sum.most), (Some(10), Some(19)));
        assert_eq!((sum.worst, sum.never), (Some(19), 1));
        let sum = summarize(&[None, Some(3), None]);
        assert_eq!((sum.median, sum.most), (None, None));
        assert_eq!((sum.worst, sum.never), (Some(3), 2));
    }
}
