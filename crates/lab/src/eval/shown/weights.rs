//! `posewise-lab eval weights`: animation weights on rendered people, whose weights are known.
//!
//! People of both families of heads, that no training has seen, are shown for half a second a
//! picture, from new sides and in new light each time. Every other picture is of the neutral face;
//! on the others, weights are mixed. Of each weight: the correlation of what is found with the
//! truth, over all pictures; the r.m.s. error; the mean of what is found where others are shown
//! and it is not (leak); and on neutral faces (rest). MakeHuman's heads count for weights of which
//! they have a clear counterpart.
//!
//! The neutral face of other people is shown for a minute with new noise in each frame: the offset
//! is the mean over the last ten seconds, the drift what that differs by from seconds five to
//! fifteen. Of a clip, the mean of each weight, and the drift from its first to its last third.

use crate::eval::on_renders;
use crate::output;
use crate::random::Random;
use anyhow::Result;
use posewise::shape::{ANIMATION_NAMES, ANIMATIONS, FITTED};
use posewise::{Config, Model, State, Tracker};
use posewise_cli::source;
use posewise_metrics::mean;
use posewise_train::render::expression::Expression;
use posewise_train::render::{Kind, Renderer, SampleSpec};
use posewise_train::weights::{self, Shot};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::json;
use std::fmt::Write as _;

/// Options of `posewise-lab eval weights`.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub on: on_renders::Args,
    /// Rendered people
    #[arg(long, default_value_t = 160)]
    pub persons: u64,
    /// Seed of people and pictures; no training has it
    #[arg(long, default_value_t = 4243)]
    pub seed: u64,
    /// A clip whose weights drift, any INPUT of `track`
    #[arg(long, value_name = "INPUT")]
    pub clip: Option<String>,
}

/// Pictures of each person, every other one neutral, and frames of each.
const PICTURES: u64 = 24;
const FRAMES: usize = 15;
/// Largest yaw \[deg\].
const YAW_DEG: f32 = 30.0;
/// Neutral faces that are shown for long; for how many frames; noise \[grey levels\].
const STILL: u64 = 24;
const STILL_FRAMES: usize = 1800;
const NOISE: i32 = 4;
/// Frames between which a mean is taken at first, and how many are at the end.
const FIRST: std::ops::Range<usize> = 150..450;
const LAST: usize = 300;

/// Weights of which MakeHuman's heads have a clear counterpart, beside the fitted ones.
const CLEAR: [&str; 2] = ["noseSneerLeft", "noseSneerRight"];

/// What is found and what is true on a picture.
struct Measured {
    found: [f32; ANIMATIONS],
    truth: [f32; ANIMATIONS],
    is_neutral: bool,
    is_makehuman: bool,
}

/// What is drawn of a person.
fn spec(person: u64) -> SampleSpec {
    SampleSpec {
        face_px: (100.0, 200.0),
        yaw_deg: YAW_DEG,
        everyday: 1.0,
        ..weights::spec(person)
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let file = args.on.file()?;
    let model = file.model()?;
    let renderer = args.on.renderer(args.seed, Kind::Near)?;
    let measured: Vec<Vec<Measured>> = (0..args.persons)
        .into_par_iter()
        .map(|person| session(&model, &renderer, args.seed, person))
        .collect::<Result<_>>()?;
    let measured: Vec<Measured> = measured.into_iter().flatten().collect();
    let still: Vec<Option<[[f32; ANIMATIONS]; 2]>> = (0..STILL)
        .into_par_iter()
        .map(|person| still(&model, &renderer, args.seed, args.persons + person))
        .collect::<Result<_>>()?;
    let still: Vec<_> = still.into_iter().flatten().collect();
    let clip = match &args.clip {
        Some(clip) => Some(of_clip(&model, clip)?),
        None => None,
    };
    let rows: Vec<_> = (0..ANIMATIONS)
        .map(|k| row(k, &measured, &still, clip.as_ref()))
        .collect();
    posewise_cli::output::print(&table(&rows))?;
    let pictures = (measured.len(), args.persons * PICTURES);
    let figures = json!({
        "tracked": pictures.0, "pictures": pictures.1, "still": still.len(), "weights": rows,
    });
    match args.on.json.as_deref() {
        Some(path) => output::write_json(path, &figures),
        None => Ok(()),
    }
}

/// A person's pictures, one after the other.
fn session(
    model: &Model<'_>,
    renderer: &Renderer,
    seed: u64,
    person: u64,
) -> Result<Vec<Measured>> {
    let mut tracker = Box::new(Tracker::new(&Config::default())?);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(person);
    let mut all = Vec::new();
    for index in 0..PICTURES {
        let is_neutral = index % 2 == 0;
        let expression = match is_neutral {
            true => Expression::default(),
            false => weights::expression(seed, person, index),
        };
        let rendered = renderer.portray([seed, person, index], &spec(person), &expression);
        let is_makehuman = rendered.is_makehuman();
        let shot = Shot::new(person as u32, rendered);
        let first = index as usize * FRAMES;
        if weights::show(&mut tracker, model, &shot, first, FRAMES, &mut rng)? {
            let truth = ANIMATION_NAMES.map(|name| shot.weight(name).min(1.0));
            all.push(Measured {
                found: tracker.result().animation,
                truth,
                is_neutral,
                is_makehuman,
            });
        }
    }
    Ok(all)
}

/// Means of the weights of a neutral face at first and at the end; `None` where it is lost.
fn still(
    model: &Model<'_>,
    renderer: &Renderer,
    seed: u64,
    person: u64,
) -> Result<Option<[[f32; ANIMATIONS]; 2]>> {
    let spec = SampleSpec {
        yaw_deg: 15.0,
        pitch_deg: 10.0,
        face_px: (110.0, 110.0),
        ..spec(person)
    };
    let rendered = renderer.portray([seed, person, 0], &spec, &Expression::default());
    let mut shot = Shot::new(person as u32, rendered);
    let plain = shot.picture.luma.clone();
    let mut tracker = Box::new(Tracker::new(&Config::default())?);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut random = Random::of(person);
    let mut found = Vec::new();
    for frame in 0..STILL_FRAMES {
        // The sum of two even distributions is nearly a normal one.
        let mut noisy = |luma: &u8| {
            let noise = random.within(NOISE) + random.within(NOISE);
            (i32::from(*luma) + noise).clamp(0, 255) as u8
        };
        shot.picture.luma = plain.iter().map(&mut noisy).collect();
        match frame {
            0 => drop(weights::show(&mut tracker, model, &shot, 0, 1, &mut rng)?),
            _ => drop(weights::go_on(&mut tracker, model, &shot, frame)?),
        }
        if tracker.result().state != State::Tracking {
            return Ok(None);
        }
        found.push(tracker.result().animation);
    }
    let last = STILL_FRAMES - LAST..STILL_FRAMES;
    Ok(Some([FIRST, last].map(|range| means(&found[range]))))
}

/// Mean of each weight.
fn means(found: &[[f32; ANIMATIONS]]) -> [f32; ANIMATIONS] {
    let n = found.len().max(1) as f32;
    std::array::from_fn(|k| found.iter().map(|weights| weights[k]).sum::<f32>() / n)
}

/// Means of the weights over a clip, over its first and its last third.
fn of_clip(model: &Model<'_>, clip: &str) -> Result<[[f32; ANIMATIONS]; 3]> {
    const FPS: f64 = 30.0;
    let mut source = source::open(clip, FPS)?;
    let mut tracker = Box::new(Tracker::new(&Config::default())?);
    let mut found = Vec::new();
    let mut number = 0;
    while let Some(picture) = source.next()? {
        number += 1;
        let time = (f64::from(number) * 1e6 / FPS) as i64;
        let grey = picture.upright_grey()?;
        let (width, height) = grey.dimensions();
        let layout = posewise::FrameLayout::grey(width, height);
        tracker.step(model, &posewise::Frame::new(&layout, &grey)?, time)?;
        if tracker.result().state == State::Tracking {
            found.push(tracker.result().animation);
        }
    }
    let third = found.len() / 3;
    Ok([&found[..], &found[..third], &found[found.len() - third..]].map(means))
}

/// The figures of a weight.
fn row(
    k: usize,
    measured: &[Measured],
    still: &[[[f32; ANIMATIONS]; 2]],
    clip: Option<&[[f32; ANIMATIONS]; 3]>,
) -> serde_json::Value {
    let name = ANIMATION_NAMES[k];
    let counts = |m: &&Measured| !m.is_makehuman || k < FITTED || CLEAR.contains(&name);
    let all: Vec<&Measured> = measured.iter().filter(counts).collect();
    let pairs: Vec<[f64; 2]> = (all.iter())
        .map(|m| [m.found[k], m.truth[k]].map(f64::from))
        .collect();
    let mean_of = |chosen: &dyn Fn(&Measured) -> bool| {
        let found = all.iter().filter(|m| chosen(m));
        mean(&found.map(|m| f64::from(m.found[k])).collect::<Vec<_>>())
    };
    let of_still = |of: &dyn Fn(&[[f32; ANIMATIONS]; 2]) -> f32| {
        mean(&still.iter().map(|s| f64::from(of(s))).collect::<Vec<_>>())
    };
    let squares: Vec<f64> = pairs.iter().map(|[f, t]| (f - t) * (f - t)).collect();
    json!({
        "name": name,
        "correlation": correlation(&pairs),
        "rms": mean(&squares).map(f64::sqrt),
        "leak": mean_of(&|m| !m.is_neutral && m.truth[k] == 0.0),
        "rest": mean_of(&|m| m.is_neutral),
        "shown": mean_of(&|m| m.truth[k] >= 0.6),
        "still_offset": of_still(&|[_, last]| last[k]),
        "still_drift": of_still(&|[first, last]| (last[k] - first[k]).abs()),
        "clip_mean": clip.map(|[all, ..]| all[k]),
        "clip_drift": clip.map(|[_, first, last]| last[k] - first[k]),
    })
}

/// Pearson's.
fn correlation(pairs: &[[f64; 2]]) -> Option<f64> {
    let of = |k: usize| mean(&pairs.iter().map(|p| p[k]).collect::<Vec<_>>());
    let middle = [of(0)?, of(1)?];
    let product = |a: usize, b: usize| -> f64 {
        let of = |p: &[f64; 2]| (p[a] - middle[a]) * (p[b] - middle[b]);
        pairs.iter().map(of).sum()
    };
    let deviations = (product(0, 0) * product(1, 1)).sqrt();
    (deviations > 0.0).then(|| product(0, 1) / deviations)
}

/// The columns of the table, and their figures.
const COLUMNS: [(&str, &str); 9] = [
    ("correlation", "correlation"),
    ("r.m.s. error", "rms"),
    ("leak", "leak"),
    ("at rest", "rest"),
    ("from 0.6 on", "shown"),
    ("offset", "still_offset"),
    ("drift", "still_drift"),
    ("mean of clip", "clip_mean"),
    ("its drift", "clip_drift"),
];

/// As Markdown.
fn table(rows: &[serde_json::Value]) -> String {
    let has = |key: &str| rows.iter().any(|row| !row[key].is_null());
    let columns: Vec<_> = COLUMNS.iter().filter(|(_, key)| has(key)).collect();
    let mut out = String::from("| weight |");
    columns.iter().for_each(|(title, _)| {
        let _ = write!(out, " {title} |");
    });
    out.push_str("\n|---|");
    columns.iter().for_each(|_| out.push_str("---|"));
    for row in rows {
        let _ = write!(out, "\n| `{}` |", row["name"].as_str().unwrap_or_default());
        for (_, key) in &columns {
            let _ = match row[key].as_f64() {
                Some(value) => write!(out, " {value:.2} |"),
                None => write!(out, " – |"),
            };
        }
    }
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_the_same_way_is_correlated() {
        let same: Vec<[f64; 2]> = (0..9).map(|k| [f64::from(k), 3.0 * f64::from(k)]).collect();
        assert!((correlation(&same).expect("deviations") - 1.0).abs() < 1e-9);
        assert_eq!(correlation(&[[1.0, 2.0]]), None);
    }
}
