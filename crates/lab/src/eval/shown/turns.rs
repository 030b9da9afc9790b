//! `posewise-lab eval turns`: what it costs that faces of a group take turns with some networks.
//!
//! Each clip is tracked twice: with all networks on each frame, and with all of them on one frame
//! in some, as a face of a group of that many. Nothing else differs.

use std::path::PathBuf;

use anyhow::{Result, anyhow, ensure};
use posewise::{Config, Model, State, TrackResult, Tracker};
use posewise_cli::model_file::ModelFile;
use posewise_cli::source;
use posewise_metrics::jitter::{Shape, landmark_jitter, second_difference};
use posewise_metrics::landmarks::{distance, nme_percent, outer_corners};
use posewise_metrics::mean;
use serde_json::{Value, json};

use crate::{output, truth};

/// Options of `posewise-lab eval turns`.
#[derive(clap::Args)]
pub struct Args {
    /// A clip (any INPUT of `track`) with one face; repeat for several
    #[arg(long, value_name = "FILE", required = true)]
    pub clip: Vec<String>,
    /// Its truth, one row per frame; repeat in the same order, or not at all
    #[arg(long, value_name = "FILE")]
    pub truth: Vec<PathBuf>,
    /// Frames of which one has all networks
    #[arg(long, value_name = "N", default_value_t = 4,
        value_parser = clap::value_parser!(u32).range(1..=8))]
    pub of: u32,
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Frames per second.
const FPS: f64 = 30.0;
/// Inter-ocular distance that jitter is scaled to \[px\].
const INTER_OCULAR: f64 = 40.0;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    ensure!(
        args.truth.is_empty() || args.truth.len() == args.clip.len(),
        "--truth once for every --clip, or not at all"
    );
    let file = ModelFile::read(args.model.as_deref())?;
    let model = file.model()?;
    let mut clips = Vec::new();
    for (k, clip) in args.clip.iter().enumerate() {
        let truth = args
            .truth
            .get(k)
            .map(|path| truth::read(path))
            .transpose()?;
        let always = track(&model, clip, 1)?;
        let in_turns = track(&model, clip, args.of)?;
        clips.push(json!({
            "clip": clip,
            "always": figures(&always, truth.as_deref()),
            "in_turns": figures(&in_turns, truth.as_deref()),
            "difference": difference(&always, &in_turns),
        }));
    }
    output::show(
        &json!({"of": args.of, "clips": clips}),
        args.json.as_deref(),
    )
}

/// Results of all frames; one frame of every `of` has all networks.
fn track(model: &Model<'_>, clip: &str, of: u32) -> Result<Vec<TrackResult>> {
    let mut tracker = Tracker::new(&Config::default()).map(Box::new)?;
    let mut source = source::open(clip, FPS)?;
    let (mut results, mut number) = (Vec::new(), 0);
    while let Some(picture) = source.next()? {
        let (frame, now_us) = (picture.frame()?, picture.timestamp_us);
        let stepped = match number % of {
            0 => tracker.step(model, &frame, now_us),
            _ => tracker.step_with_few(model, &frame, now_us),
        };
        results.push(*stepped.map_err(|e| anyhow!("{e}"))?);
        number += 1;
    }
    Ok(results)
}

fn is_tracking(result: &&TrackResult) -> bool {
    result.state == State::Tracking
}

fn points(result: &TrackResult) -> Shape {
    result.landmarks.map(|l| [l.x, l.y].map(f64::from))
}

/// Of one run: tracked frames, landmark error \[% of the outer eye corners' distance\], mean error
/// of the angles \[deg\], jitter \[px\].
fn figures(results: &[TrackResult], truth: Option<&[truth::Truth]>) -> Value {
    let tracked = results.iter().filter(is_tracking).count();
    let (mut landmarks, mut angles) = (Vec::new(), Vec::new());
    for (result, truth) in results.iter().zip(truth.unwrap_or(&[])) {
        if is_tracking(&result) {
            let pairs = points(result).into_iter().zip(truth.points);
            landmarks.push(nme_percent(pairs, outer_corners(&truth.points)));
            let own = [result.yaw_deg, result.pitch_deg, result.roll_deg].map(f64::from);
            let errors = [0, 1, 2].map(|k| (own[k] - truth.angles[k]).abs());
            angles.push(errors.iter().sum::<f64>() / 3.0);
        }
    }
    let differences: Vec<Shape> = (results.windows(3))
        .filter(|three| three.iter().all(|result| is_tracking(&result)))
        .map(|three| {
            let [a, b, c] = [0, 1, 2].map(|k| points(&three[k]));
            let scale = INTER_OCULAR / distance(b[36], b[45]).max(1.0);
            second_difference([&a, &b, &c], scale)
        })
        .collect();
    json!({
        "tracked": tracked,
        "nme68_percent": mean(&landmarks),
        "angle_deg": mean(&angles),
        "jitter_px": landmark_jitter(&differences),
    })
}

/// Between both runs: mean distance of landmarks \[% of the outer eye corners' distance\], of all
/// and of the mouth, mean difference of openness and of yaw.
fn difference(always: &[TrackResult], in_turns: &[TrackResult]) -> Value {
    let (mut all, mut mouth, mut open, mut yaw) = (vec![], vec![], vec![], vec![]);
    for (a, b) in always.iter().zip(in_turns) {
        if !is_tracking(&a) || !is_tracking(&b) {
            continue;
        }
        let (p, q) = (points(a), points(b));
        let unit = outer_corners(&p);
        all.push(nme_percent(p.into_iter().zip(q), unit));
        mouth.push(nme_percent(
            p[48..].iter().copied().zip(q[48..].iter().copied()),
            unit,
        ));
        open.extend(
            (0..2).filter_map(|k| Some(f64::from((a.eye_open[k]? - b.eye_open[k]?).abs()))),
        );
        yaw.push(f64::from((a.yaw_deg - b.yaw_deg).abs()));
    }
    json!({
        "landmarks_percent": mean(&all),
        "mouth_percent": mean(&mouth),
        "eye_open": mean(&open),
        "yaw_deg": mean(&yaw),
    })
}
