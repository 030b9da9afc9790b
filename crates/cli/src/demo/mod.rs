//! `posewise demo`: tracks the shipped clip and shows what came out.

pub mod clip;
mod truth;

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result};
use image::RgbImage;
use posewise::{State, TrackResult, Tracker};
use posewise_metrics::median;

use crate::cli::{DemoArgs, TrackerArgs};
use crate::csv::{CsvWriter, Row};
use crate::destination::Destination;
use crate::faces::Face;
use crate::model_file::ModelFile;
use crate::output;
use crate::overlay::{Painter, save};
use crate::picture::Picture;
use crate::session::Session;
use truth::{Errors, Truth};

const PICTURE: &str = "posewise-demo.png";
const TABLE: &str = "posewise-demo.csv";
/// Columns and rows of the contact sheet.
const SHEET: (usize, usize) = (3, 2);

/// Runs the command.
pub fn run(args: &DemoArgs) -> Result<()> {
    let file = ModelFile::read(args.model.as_deref())?;
    let model = file.model()?;
    let mut source = clip::open()?;
    let truth = Truth::read()?;
    let settings = TrackerArgs {
        focal: Some(truth.focal),
        ..TrackerArgs::default()
    };
    let mut session = Session::new(&model, &settings, false)?;
    let mut csv = CsvWriter::new(Vec::new(), &[])?;
    let mut frames: Vec<(Picture, TrackResult)> = Vec::new();
    let mut step_ms = Vec::new();
    while let Some(picture) = source.next()? {
        let before = session.busy;
        let result = *session.step(&picture)?;
        step_ms.push((session.busy - before).as_secs_f64() * 1e3);
        let row = Row {
            frame: frames.len() as u64 + 1,
            face_id: 0,
            result: &result,
        };
        csv.write(&row, &[])?;
        frames.push((picture, result));
    }
    let csv = csv.into_inner()?;
    let table = Destination::new(Path::new(TABLE));
    std::fs::write(table.path(), &csv).with_context(|| format!("cannot write {TABLE}"))?;
    table.finish()?;
    save(&contact_sheet(&frames, &session)?, Path::new(PICTURE))?;
    let errors = truth.errors(frames.iter().map(|(_, result)| result));
    output::print(&report(&frames, &step_ms, &errors, file.bytes().len()))
}

/// Frames at equal distances with their overlay, side by side.
fn contact_sheet(frames: &[(Picture, TrackResult)], session: &Session<'_>) -> Result<RgbImage> {
    let count = SHEET.0 * SHEET.1;
    let mut painter = Painter::all();
    let mut sheet = RgbImage::new(1, 1);
    for i in 0..count {
        let at = (2 * i + 1) * frames.len() / (2 * count);
        let Some((picture, result)) = frames.get(at) else {
            break;
        };
        let mut image = picture.upright_rgb()?;
        let camera = session.intrinsics();
        let face = Face {
            id: 0,
            result: *result,
        };
        painter.paint(&mut image, at as u64 + 1, &[face], &camera);
        let (w, h) = image.dimensions();
        if i == 0 {
            sheet = RgbImage::new(w * SHEET.0 as u32, h * SHEET.1 as u32);
        }
        let (column, row) = ((i % SHEET.0) as i64, (i / SHEET.0) as i64);
        image::imageops::replace(
            &mut sheet,
            &image,
            column * i64::from(w),
            row * i64::from(h),
        );
    }
    Ok(sheet)
}

fn report(
    frames: &[(Picture, TrackResult)],
    step_ms: &[f64],
    errors: &Errors,
    model_bytes: usize,
) -> String {
    let is = |state: State| frames.iter().filter(|(_, r)| r.state == state).count();
    let share = |n: usize| 100.0 * n as f64 / frames.len().max(1) as f64;
    let (tracked, coasted) = (is(State::Tracking), is(State::Coasting));
    let longest = step_ms.iter().copied().fold(0.0, f64::max);
    let mut out = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{name:<16}{value}");
    };
    if let Some((picture, _)) = frames.first() {
        let (w, h) = (picture.layout.width, picture.layout.height);
        line("frames", format!("{} of {w}×{h} px", frames.len()));
    }
    line("tracked", format!("{tracked} ({:.1} %)", share(tracked)));
    line("coasted", format!("{coasted} ({:.1} %)", share(coasted)));
    if let Some([yaw, pitch, roll]) = errors.angles {
        line(
            "angle error",
            format!("yaw {yaw:.2}°, pitch {pitch:.2}°, roll {roll:.2}° (mean absolute)"),
        );
    }
    if let Some((all, depth)) = errors.place {
        line(
            "position error",
            format!("{all:.1} mm, {depth:.1} mm of it in depth"),
        );
    }
    if let Some(e) = errors.landmarks {
        line("landmark error", format!("{:.2} % of the face", 100.0 * e));
    }
    line(
        "step",
        format!(
            "{:.3} ms median, {longest:.3} ms longest",
            median(step_ms).unwrap_or(0.0)
        ),
    );
    line("model", format!("{model_bytes} bytes"));
    line(
        "tracker memory",
        format!("{} bytes", std::mem::size_of::<Tracker>()),
    );
    line("written", format!("{PICTURE}, {TABLE}"));
    out
}
