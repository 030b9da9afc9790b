//! Measures what a tracker says of the eyes of rendered heads that no training has seen.

use super::samples::{DARK, is_looking, is_open};
use crate::render::{self, Kind, SampleSpec};
use anyhow::{Context, Result};
use glam::Vec3;
use posewise::image::{Frame, FrameLayout};
use posewise::track::{Config, FaceHint, Model, State, Tracker};
use posewise_format::AlignedBytes;
use rayon::prelude::*;
use std::path::PathBuf;

/// Options of `posewise-train gaze`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The model.
    #[arg(long, default_value = "models/posewise.posewise")]
    pub model: PathBuf,
    /// The shared data: `facekit.npz`.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Pictures.
    #[arg(long, default_value_t = 600)]
    pub count: u64,
    /// Seed of people and pictures; no training has it.
    #[arg(long, default_value_t = 777)]
    pub seed: u64,
}

/// Steps on each picture.
const STEPS: i64 = 3;
/// Largest yaw of heads whose gaze is to be known \[deg\].
const MOST_YAW_DEG: f32 = 30.0;

/// What came of a picture.
#[derive(Clone, Debug)]
struct Row {
    face_px: f32,
    glasses: bool,
    /// Error of the gaze of both eyes \[deg\], and its standard deviation.
    gaze: Option<(f32, f32)>,
    /// Whether the eyes are open, visible and not turned away.
    looks: bool,
    /// Per eye: whether it is open by the truth, and as it was found.
    lids: Vec<(Option<bool>, Option<bool>, bool)>,
    tracked: bool,
}

fn spec() -> SampleSpec {
    SampleSpec {
        face_px: (60.0, 200.0),
        margin: 0.6,
        yaw_deg: 45.0,
        inner_share: 0.8,
        pitch_deg: 25.0,
        roll_deg: 20.0,
        persons: render::Persons::Procedural,
        ..SampleSpec::eyes()
    }
}

/// Prints the table.
pub fn run(args: &Args) -> Result<()> {
    let bytes = std::fs::read(&args.model).with_context(|| args.model.display().to_string())?;
    let bytes = AlignedBytes::new(&bytes);
    let model = Model::load(&bytes)?;
    let alone = render::Args {
        makehuman: 0.0,
        panoramas: 0.0,
        ..render::Args::procedural(&args.data, args.seed, Kind::Eyes)
    };
    let renderer = render::renderer(&alone, None)?;
    let spec = spec();
    let rows: Vec<Row> = (0..args.count)
        .into_par_iter()
        .map(|index| {
            let rendered = renderer.render(args.seed, index, &spec);
            look(&model, &rendered.sample, &rendered.eyes)
        })
        .collect::<Result<_>>()?;
    print(&rows);
    Ok(())
}

fn look(
    model: &Model<'_>,
    sample: &render::Sample,
    truth: &[render::eye_truth::EyeTruth; 2],
) -> Result<Row> {
    let mut config = Config::default().with_gaze(true);
    config.intrinsics = Some(sample.camera);
    let mut tracker = Box::new(Tracker::new(&config)?);
    let layout = FrameLayout::grey(sample.width as u32, sample.height as u32);
    let frame = Frame::new(&layout, &sample.luma)?;
    let (low, high) = sample
        .landmarks
        .iter()
        .fold((glam::Vec2::MAX, glam::Vec2::MIN), |(low, high), p| {
            (low.min(*p), high.max(*p))
        });
    let size = high - low;
    let hint = FaceHint::new([low.x, low.y, size.x, size.y]);
    tracker.step_at(model, &frame, 1, &hint)?;
    for k in 1..STEPS {
        tracker.step(model, &frame, 1 + 33_333 * k)?;
    }
    let result = tracker.result();
    let seen = &result.eyes;
    let eyes = render::eye_cache::eyes_of(sample, truth);
    let true_gaze = (truth[0].gaze + truth[1].gaze).normalize();
    let error_deg = |gaze: [f32; 3]| {
        let cosine = Vec3::from(gaze).dot(true_gaze).clamp(-1.0, 1.0);
        cosine.acos().to_degrees()
    };
    let open = |eye: &render::eye_cache::Eye| is_looking(eye) && is_open(eye) == Some(true);
    // The image left's eye is the person's right one, which is second in a result.
    let lids = eyes.iter().zip(seen.each.iter().rev()).map(|(eye, found)| {
        (
            is_open(eye),
            found.open.ok().map(|open| open > 0.5),
            eye.truth.lens > DARK,
        )
    });
    Ok(Row {
        face_px: size.max_element(),
        glasses: truth[0].lens > 0.0,
        gaze: (seen.gaze.ok()).map(|gaze| (error_deg(gaze.camera), gaze.sigma_deg)),
        looks: eyes.iter().all(open) && sample.angles.yaw_deg.abs() <= MOST_YAW_DEG,
        lids: lids.collect(),
        tracked: result.state == State::Tracking,
    })
}

fn print(rows: &[Row]) {
    println!("| heads within 30° of yaw | pictures | gaze known | mean | median | deviation |");
    println!("|---|---|---|---|---|---|");
    type Chosen = fn(&Row) -> bool;
    let groups: [(&str, Chosen); 6] = [
        ("all", |_| true),
        ("60 to 90 px", |r| r.face_px < 90.0),
        ("90 to 140 px", |r| (90.0..140.0).contains(&r.face_px)),
        ("140 to 200 px", |r| r.face_px >= 140.0),
        ("without glasses", |r| !r.glasses),
        ("with clear glasses", |r| r.glasses),
    ];
    for (name, chosen) in groups {
        let looking: Vec<&Row> = rows
            .iter()
            .filter(|r| r.looks && r.tracked && chosen(r))
            .collect();
        let mut errors: Vec<f32> = looking.iter().filter_map(|r| Some(r.gaze?.0)).collect();
        let sigma: f32 = looking.iter().filter_map(|r| Some(r.gaze?.1)).sum();
        errors.sort_by(f32::total_cmp);
        let n = errors.len().max(1) as f32;
        println!(
            "| {name} | {} | {:.1} % | {:.2}° | {:.2}° | {:.2}° |",
            looking.len(),
            100.0 * errors.len() as f32 / looking.len().max(1) as f32,
            errors.iter().sum::<f32>() / n,
            errors.get(errors.len() / 2).unwrap_or(&0.0),
            sigma / n,
        );
    }
    let lids: Vec<_> = rows
        .iter()
        .filter(|r| r.tracked)
        .flat_map(|r| &r.lids)
        .collect();
    let known: Vec<_> = lids.iter().filter(|l| l.0.is_some()).collect();
    let answered: Vec<_> = known.iter().filter_map(|l| Some((l.0?, l.1?))).collect();
    let right = answered
        .iter()
        .filter(|(truth, found)| truth == found)
        .count();
    println!(
        "lids: {} eyes, {:.1} % answered, {:.1} % of these right",
        known.len(),
        100.0 * answered.len() as f32 / known.len().max(1) as f32,
        100.0 * right as f32 / answered.len().max(1) as f32
    );
    let dark: Vec<_> = lids.iter().filter(|l| l.2).collect();
    let shut = dark.iter().filter(|l| l.1 == Some(false)).count();
    println!(
        "behind dark glasses: {} eyes, {shut} said to be shut",
        dark.len()
    );
}
