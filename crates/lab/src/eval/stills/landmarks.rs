//! `posewise-lab eval landmarks`: each labelled picture is a still for a fresh tracker.

use std::path::PathBuf;

use anyhow::{Context, Result};
use posewise::TrackResult;
use posewise::detect::Detection;
use posewise_cli::parse::within;
use posewise_cli::picture::Picture;
use posewise_metrics::landmarks::bounds;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::cut::cut;
use super::labels::{Label, read_labels};
use super::landmark_metrics::{
    FitConfidence, Outcome, Points, Summary, YawBand, eye_line, summarize,
};
use super::still::{Stills, StillsArgs};
use super::turned::Turn;
use crate::eval::camera;
use crate::output;
use crate::product::read_luma;

/// Where the first fit starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Start {
    /// The tracker's own detector finds the face
    Detector,
    /// The labelled box is given
    Box,
}

/// Options of `posewise-lab eval landmarks`.
#[derive(clap::Args)]
pub struct Args {
    /// Labels: image,x0,y0,…,x67,y67 [px], iBUG 68 order
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    #[command(flatten)]
    pub camera: camera::Args,
    /// Turn the pictures clockwise [deg]; what they do not show repeats their edges
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_negative_numbers = true,
        value_parser = within(-180.0, 180.0))]
    pub roll: f64,
    /// Cut off this share of the landmarks' box at the left, right, upper and lower edge in turn
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = within(0.0, 0.9))]
    pub cut: f64,
    /// Where the first fit starts
    #[arg(long, value_enum, default_value = "detector")]
    pub start: Start,
    #[command(flatten)]
    pub stills: StillsArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let labels = read_labels(&args.csv)?;
    let stills = Stills::new(&args.stills)?;
    let outcomes = stills.each(&labels, |show, index, label| {
        let grey = read_luma(&args.stills.images.join(&label.image))?;
        let grey = camera::through(&args.camera, grey, 1);
        let turn = Turn::new(&grey, args.roll);
        let (mut grey, mut points) = (turn.picture(&grey), turn.points(&label.points));
        let mut corner = [0.0; 2];
        if args.cut > 0.0 {
            (grey, corner) = cut(&grey, &points, args.cut, index % 4);
            points = points.map(|[x, y]| [x - corner[0], y - corner[1]]);
        }
        let start =
            (args.start == Start::Box).then(|| turned_box(&label.points, &turn, args.roll, corner));
        let found = show
            .fit(Picture::from_grey(grey), start)
            .with_context(|| label.image.clone())?;
        let (found, confidence) = found.map(|fit| points_of(&fit.result)).unzip();
        let mut outcome = Outcome::new(&points, found.as_ref());
        outcome.confidence = confidence;
        Ok(outcome)
    })?;
    let total = summarize(outcomes.iter());
    let bands = YawBand::ALL
        .map(|(band, name)| (name, summarize(outcomes.iter().filter(|o| o.band == band))));
    if let Some(path) = &args.stills.per_image {
        output::write_rows(path, labels.iter().zip(&outcomes).map(ImageRow::of))?;
    }
    output::show(&figures(args, &total, &bands), args.stills.json.as_deref())
}

/// The landmarks of a fit with their confidences.
fn points_of(result: &TrackResult) -> (Points, FitConfidence) {
    let points = result.landmarks.map(|l| [f64::from(l.x), f64::from(l.y)]);
    let confidence = FitConfidence {
        face: f64::from(result.confidence),
        landmarks: result.landmarks.map(|l| f64::from(l.confidence)),
    };
    (points, confidence)
}

/// The upright square around the labels, turned with the picture, of which the corner is at
/// `corner`.
fn turned_box(label: &Points, turn: &Turn, roll_deg: f64, corner: [f64; 2]) -> Detection {
    let [left, top, right, bottom] = bounds(label);
    let [x, y] = turn.point([(left + right) / 2.0, (top + bottom) / 2.0]);
    Detection {
        x: (x - corner[0]) as f32,
        y: (y - corner[1]) as f32,
        size: (right - left).max(bottom - top) as f32,
        roll: roll_deg.to_radians() as f32,
        score: 1.0,
        ..Detection::default()
    }
}

fn figures(args: &Args, total: &Summary, bands: &[(&str, Summary)]) -> Value {
    let mut value = json!(total);
    let bands = bands.iter().map(|(name, s)| (name.to_string(), json!(s)));
    value["yaw_bands"] = Map::from_iter(bands).into();
    value["start"] = json!(match args.start {
        Start::Detector => "detector",
        Start::Box => "box",
    });
    value["steps_after_found"] = json!(args.stills.steps);
    value["min_face_px"] = json!(args.stills.min_face);
    value["roll_deg"] = json!(args.roll);
    if args.cut > 0.0 {
        value["cut"] = json!(args.cut);
    }
    value
}

/// What `--per-image` writes of a picture.
#[derive(Serialize)]
struct ImageRow<'a> {
    image: &'a str,
    band: &'static str,
    found: u8,
    failed: u8,
    nme68: Option<f64>,
    nme51: Option<f64>,
    shift_along: Option<f64>,
    shift_down: Option<f64>,
    inter_ocular_px: f64,
    roll_deg: f64,
}

impl<'a> ImageRow<'a> {
    fn of((label, outcome): (&'a Label, &Outcome)) -> Self {
        let band = YawBand::ALL.iter().find(|(b, _)| *b == outcome.band);
        let [x, y] = eye_line(&label.points);
        ImageRow {
            image: &label.image,
            band: band.map_or("", |(_, name)| name),
            found: outcome.errors.is_some().into(),
            failed: outcome.failed().into(),
            nme68: outcome.nme(0, 68),
            nme51: outcome.nme(17, 68),
            shift_along: outcome.shift.map(|s| s[0]),
            shift_down: outcome.shift.map(|s| s[1]),
            inter_ocular_px: x.hypot(y),
            roll_deg: y.atan2(x).to_degrees(),
        }
    }
}
