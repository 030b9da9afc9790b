//! `posewise-lab eval landmarks`: each labelled picture is a still for a fresh tracker.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use posewise::TrackResult;
use posewise::detect::Detection;
use posewise_cli::parse::within;
use posewise_cli::picture::Picture;
use posewise_cli::plot;
use posewise_cli::source::read_rgb;
use posewise_metrics::landmarks::bounds;
use serde_json::{Map, Value, json};

use super::ced::Curve;
use super::cut::cut;
use super::labels::{Label, read_labels};
use super::landmark_metrics::{
    FitConfidence, Outcome, PARTS, Points, Summary, YawBand, eye_line, summarize,
};
use super::still::{Stills, StillsArgs};
use super::turned::Turn;
use crate::eval::camera;
use crate::output;

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
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
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
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture: found, errors, yaw band, mean shift from the labels
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    /// Plot the cumulative error distribution up to 10 % (.svg or .png)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    #[command(flatten)]
    pub stills: StillsArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if let Some(path) = &args.plot {
        plot::check_name(path)?;
    }
    let labels = read_labels(&args.csv)?;
    if !args.images.is_dir() {
        bail!("no such folder: {}", args.images.display());
    }
    let stills = Stills::new(&args.stills)?;
    let outcomes = stills.each(&labels, |show, index, label| {
        let picture = Picture::from_rgb(read_rgb(&args.images.join(&label.image))?);
        let grey = camera::through(&args.camera, picture.upright_grey()?, 1);
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
    output::print(&report(&total, &bands))?;
    if let Some(path) = &args.plot {
        plot::save(path, &Curve::of(&outcomes))?;
    }
    if let Some(path) = &args.per_image {
        write_per_image(path, &labels, &outcomes)?;
    }
    if let Some(path) = &args.json {
        output::write_json(path, &to_json(args, &total, &bands))?;
    }
    Ok(())
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

fn percent(value: Option<f64>) -> String {
    value.map_or("–".into(), |v| format!("{:.2}", 100.0 * v))
}

fn report(total: &Summary, bands: &[(&str, Summary)]) -> String {
    let mut out = format!(
        "{:<12}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
        "[%]", "images", "found", "nme68", "median", "nme51", "median", "failure", "auc68", "auc51"
    );
    let rows = std::iter::once(("all", total)).chain(bands.iter().map(|(n, s)| (*n, s)));
    for (name, s) in rows {
        let share = |v: f64| percent((s.images > 0).then_some(v));
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{name:<12}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
            s.images,
            share(s.found),
            percent(s.nme68.0),
            percent(s.nme68.1),
            percent(s.nme51.0),
            percent(s.nme51.1),
            share(s.failure),
            share(s.auc.0),
            share(s.auc.1),
        );
    }
    for ((name, ..), value) in PARTS.iter().zip(total.parts) {
        let _ = write!(out, "{name} {}  ", percent(value));
    }
    out.truncate(out.trim_end().len());
    let _ = write!(
        out,
        "\nnme68 and nme51 by box {} {}, by eye centres {} {}; auc to 10 % {} {}",
        percent(total.nme_box.0),
        percent(total.nme_box.1),
        percent(total.nme_pupils.0),
        percent(total.nme_pupils.1),
        percent(Some(total.wide_auc.0)),
        percent(Some(total.wide_auc.1)),
    );
    let cell = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.3}"));
    let (landmarks, face) = total.calibration;
    let _ = writeln!(
        out,
        "\ncalibration error: landmarks {}, face {}",
        cell(landmarks),
        cell(face)
    );
    out
}

fn to_json(args: &Args, total: &Summary, bands: &[(&str, Summary)]) -> Value {
    let mut value = total.json();
    let bands: Map<String, Value> = bands
        .iter()
        .map(|(name, s)| (name.to_string(), s.json()))
        .collect();
    if let Value::Object(map) = &mut value {
        map.insert("yaw_bands".into(), bands.into());
        let start = match args.start {
            Start::Detector => "detector",
            Start::Box => "box",
        };
        map.insert("start".into(), json!(start));
        map.insert("steps_after_found".into(), json!(args.stills.steps));
        map.insert("min_face_px".into(), json!(args.stills.min_face));
        map.insert("roll_deg".into(), json!(args.roll));
        if args.cut > 0.0 {
            map.insert("cut".into(), json!(args.cut));
        }
    }
    value
}

fn write_per_image(path: &Path, labels: &[Label], outcomes: &[Outcome]) -> Result<()> {
    let mut out = csv::Writer::from_writer(output::create(path)?);
    let context = || format!("cannot write {}", path.display());
    out.write_record([
        "image",
        "band",
        "found",
        "failed",
        "nme68",
        "nme51",
        "shift_along",
        "shift_down",
        "inter_ocular_px",
        "roll_deg",
    ])
    .with_context(context)?;
    for (label, outcome) in labels.iter().zip(outcomes) {
        let band = YawBand::ALL.iter().find(|(b, _)| *b == outcome.band);
        let [x, y] = eye_line(&label.points);
        let number = |v: Option<f64>| v.map_or(String::new(), |v| format!("{v:.5}"));
        out.write_record([
            label.image.as_str(),
            band.map_or("", |(_, name)| name),
            if outcome.errors.is_some() { "1" } else { "0" },
            if outcome.failed() { "1" } else { "0" },
            &number(outcome.nme(0, 68)),
            &number(outcome.nme(17, 68)),
            &number(outcome.shift.map(|s| s[0])),
            &number(outcome.shift.map(|s| s[1])),
            &format!("{:.2}", x.hypot(y)),
            &format!("{:.2}", y.atan2(x).to_degrees()),
        ])
        .with_context(context)?;
    }
    out.flush().with_context(context)
}
