//! `posewise-lab eval people`: whether faces are found as often, and landmarks as exactly, on
//! people of each sex, age and skin, in good and in poor light.
//!
//! MakeHuman's people, that no training has seen, as photographs mostly show them, where hair and
//! turn leave most of the face to be seen. Each picture is a still for a new tracker. Their labels
//! are the head's vertices, alike for all groups; whether people of all groups are rendered as
//! faithfully, figures of renders cannot say.

use crate::output;
use anyhow::Result;
use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};
use posewise_cli::model_file::ModelFile;
use posewise_metrics::landmarks::{INNER, distance, nme_percent};
use posewise_metrics::{mean, median};
use posewise_train::render::makehuman::Groups;
use posewise_train::render::{self, Kind, Renderer, SampleSpec};
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// Options of `posewise-lab eval people`.
#[derive(clap::Args)]
pub struct Args {
    /// The shared data: `facekit.npz`, `free/`
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// The model; the built-in one by default
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Pictures
    #[arg(long, default_value_t = 3000)]
    pub count: u64,
    /// Seed of people and pictures; no training has it
    #[arg(long, default_value_t = 5151)]
    pub seed: u64,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Times that a picture is shown to find the face, and after that.
const SEARCH: i64 = 8;
const MORE: i64 = 1;
/// Windows per step, enough for any picture.
const SCAN_BUDGET: u32 = 1_000_000;
const STEP_US: i64 = 33_333;
/// Albedo below which skin is dark, and from which it is light.
const DARK: f32 = 0.17;
const LIGHT: f32 = 0.36;
/// Least share of the inner landmarks that is seen.
const SEEN: f32 = 0.7;
/// Light and noise of the poor camera, as in the photographs of accuracy.md: a share of the grey
/// values, and grey levels.
const GAIN: f32 = 0.15;
const NOISE: i32 = 4;

fn spec() -> SampleSpec {
    SampleSpec {
        face_px: (60.0, 150.0),
        yaw_deg: 45.0,
        defects: 0.5,
        makehuman: 1.0,
        panoramas: render::PANORAMAS,
        everyday: 1.0,
        ..SampleSpec::default()
    }
}

/// A picture's groups, and in good and in poor light the error \[% of the distance between the
/// outer eye corners\] where the face is found.
struct Measured {
    groups: Groups,
    errors: [Option<f64>; 2],
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let file = ModelFile::read(args.model.as_deref())?;
    let model = file.model()?;
    let procedural = render::Args::procedural(&args.data, args.seed, Kind::Plain);
    let renderer = render::renderer(&procedural, None)?;
    let measured: Vec<Measured> = (0..args.count)
        .into_par_iter()
        .filter_map(|index| measure(&model, &renderer, args.seed, index).transpose())
        .collect::<Result<_>>()?;
    let tone = |groups: &Groups| match groups.skin {
        ..DARK => "dark skin",
        ..LIGHT => "medium skin",
        _ => "light skin",
    };
    type Key<'a> = &'a dyn Fn(&Groups) -> &'static str;
    let keys: [Key<'_>; 5] = [&|_| "all", &|g| g.people, &|g| g.sex, &|g| g.age, &tone];
    let mut figures = Map::new();
    for key in keys {
        let mut names: Vec<_> = measured.iter().map(|m| key(&m.groups)).collect();
        names.sort_unstable();
        names.dedup();
        for name in names {
            let of: Vec<_> = measured.iter().filter(|m| key(&m.groups) == name).collect();
            figures.insert(name.to_owned(), figures_of(&of));
        }
    }
    output::show(&Value::Object(figures), args.json.as_deref())
}

/// One picture; `None` where too little of the face is seen.
fn measure(
    model: &Model<'_>,
    renderer: &Renderer,
    seed: u64,
    index: u64,
) -> Result<Option<Measured>> {
    let rendered = renderer.render(seed, index, &spec());
    let sample = &rendered.sample;
    let inner = &sample.visible[INNER..];
    let seen = inner.iter().filter(|seen| **seen).count();
    if (seen as f32) < SEEN * inner.len() as f32 {
        return Ok(None);
    }
    let truth = sample.landmarks.map(|p| p.to_array());
    let unit = distance(truth[36], truth[45]);
    let mut random = crate::random::Random::of(index);
    let mut poor = |luma: &u8| {
        let noise = random.within(NOISE) + random.within(NOISE);
        ((GAIN * f32::from(*luma)) as i32 + noise).clamp(0, 255) as u8
    };
    let dim: Vec<u8> = sample.luma.iter().map(&mut poor).collect();
    let layout = FrameLayout::grey(sample.width as u32, sample.height as u32);
    let mut errors = [None; 2];
    for (error, luma) in errors.iter_mut().zip([&sample.luma, &dim]) {
        let found = fit(model, &Frame::new(&layout, luma)?)?;
        *error = found.map(|found| {
            let pairs = truth.into_iter().zip(found);
            f64::from(nme_percent(pairs, unit))
        });
    }
    let groups = rendered.groups.expect("all heads are MakeHuman's");
    Ok(Some(Measured { groups, errors }))
}

/// The landmarks that a new tracker finds.
fn fit(model: &Model<'_>, frame: &Frame<'_>) -> Result<Option<[[f32; 2]; 68]>> {
    let mut config = Config::default();
    config.scan_budget = SCAN_BUDGET;
    let mut tracker = Box::new(Tracker::new(&config)?);
    let (mut found, mut last) = (None, SEARCH);
    let mut step = 0;
    while step < last {
        step += 1;
        let result = tracker.step(model, frame, step * STEP_US)?;
        if result.state == State::Tracking {
            if found.is_none() {
                last = step + MORE;
            }
            found = Some(result.landmarks.map(|landmark| [landmark.x, landmark.y]));
        }
    }
    Ok(found)
}

fn figures_of(measured: &[&Measured]) -> Value {
    let of = |k: usize| {
        let errors: Vec<f64> = measured.iter().filter_map(|m| m.errors[k]).collect();
        let found = 100.0 * errors.len() as f64 / measured.len() as f64;
        (found, mean(&errors), median(&errors))
    };
    let (good, poor) = (of(0), of(1));
    json!({
        "count": measured.len(),
        "found_percent": good.0, "nme_percent": good.1, "nme_median_percent": good.2,
        "dim_found_percent": poor.0, "dim_nme_percent": poor.1,
    })
}
