//! `posewise bench`: what a step costs, on one thread.
//!
//! Tracking is timed on the clip, shown forwards and backwards again and again so that the face
//! never jumps. Searching is timed on the same pictures cut into blocks and shuffled: natural
//! texture without a face.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Result, anyhow, bail};
use posewise::image::PixelFormat;
use posewise::track::{Config, Model, State, Tracker};
use serde_json::{Value, json};

use crate::cli::BenchArgs;
use crate::model_file::ModelFile;
use crate::picture::{Chroma, Picture};
use crate::{demo_clip, output, source, stack, stages};

/// Most frames of the clip that are kept in memory.
const MAX_FRAMES: usize = 300;
/// Steps timed per state.
const STEPS: usize = 600;
/// Side of the shuffled blocks \[px\].
const BLOCK: usize = 16;
const STEP_US: i64 = 33_333;

/// Times of one state's steps \[ns\], sorted.
struct Times(Vec<u64>);

impl Times {
    fn of(mut ns: Vec<u64>) -> Self {
        ns.sort_unstable();
        Times(ns)
    }

    fn quantile(&self, q: f64) -> Option<u64> {
        let last = self.0.len().checked_sub(1)?;
        self.0.get((q * last as f64).round() as usize).copied()
    }

    fn json(&self) -> Value {
        json!({
            "steps": self.0.len(),
            "median_ns": self.quantile(0.5),
            "p99_ns": self.quantile(0.99),
        })
    }
}

/// Runs the command.
pub fn run(args: &BenchArgs) -> Result<()> {
    let file = ModelFile::read(args.model.as_deref())?;
    let model = file.model()?;
    let frames = load(args)?;
    let shuffled = shuffled(&frames);
    let (tracking, acquiring) = time_tracking(&model, &frames)?;
    let searching = time_searching(&model, &shuffled)?;
    let parts = stages::time(&model, &frames)?;
    let peak_stack = measure_stack(&model, &frames, &shuffled);
    let layout = frames.first().map(|p| p.layout);
    let (width, height) = layout.map_or((0, 0), |l| (l.width, l.height));
    let ratio = searching
        .quantile(0.5)
        .zip(tracking.quantile(0.5))
        .map(|(s, t)| s as f64 / t.max(1) as f64);
    let value = json!({
        "frame": [width, height],
        "tracking": tracking.json(),
        "acquiring": acquiring.json(),
        "searching": searching.json(),
        "searching_over_tracking": ratio,
        "stages_ns": parts.iter().map(|(name, ns)| json!([name, ns])).collect::<Vec<_>>(),
        "model_bytes": model.blob().total_len(),
        "tracker_bytes": std::mem::size_of::<Tracker>(),
        "peak_stack_bytes": peak_stack,
        "threads": 1,
    });
    if let Some(path) = &args.json {
        output::write_json(path, &value)?;
    }
    output::print(&report(&value))
}

/// The clip's first frames, luma only.
fn load(args: &BenchArgs) -> Result<Vec<Picture>> {
    let mut source = match &args.input {
        Some(input) => source::open(input, 30.0)?,
        None => demo_clip::open()?,
    };
    let mut frames = Vec::new();
    while let Some(mut picture) = source.next()? {
        if picture.chroma != Chroma::None {
            let luma = picture.layout.stride as usize * picture.layout.height as usize;
            picture.data.truncate(luma);
            picture.chroma = Chroma::None;
        }
        frames.push(picture);
        if frames.len() == MAX_FRAMES {
            break;
        }
    }
    if frames.is_empty() {
        bail!("the input has no frames");
    }
    Ok(frames)
}

/// Frames with their blocks in a random order (fixed seed), as grey pictures.
fn shuffled(frames: &[Picture]) -> Vec<Picture> {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut below = |n: usize| {
        // xorshift64: any reproducible order will do.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % n.max(1) as u64) as usize
    };
    let some = frames.iter().step_by((frames.len() / 8).max(1));
    some.filter_map(|picture| {
        let frame = picture.frame().ok()?;
        let (w, h) = (frame.width() as usize, frame.height() as usize);
        let (across, down) = (w.div_ceil(BLOCK), h.div_ceil(BLOCK));
        let mut order: Vec<usize> = (0..across * down).collect();
        (1..order.len())
            .rev()
            .for_each(|i| order.swap(i, below(i + 1)));
        let data = (0..w * h).map(|at| {
            let (x, y) = (at % w, at / w);
            let from = order[y / BLOCK * across + x / BLOCK];
            let (bx, by) = (from % across * BLOCK, from / across * BLOCK);
            frame.luma((bx + x % BLOCK) as i32, (by + y % BLOCK) as i32)
        });
        let mut out = picture.clone();
        out.data = data.collect();
        out.layout = posewise::image::FrameLayout {
            format: PixelFormat::Grey,
            ..posewise::image::FrameLayout::grey(w as u32, h as u32)
        };
        Some(out)
    })
    .collect()
}

/// Index of step `i` when `n` frames are shown forwards, backwards, forwards …
fn back_and_forth(i: usize, n: usize) -> usize {
    let period = (2 * n).saturating_sub(2).max(1);
    let at = i % period;
    if at < n { at } else { period - at }
}

fn fresh() -> Result<Box<Tracker>> {
    let tracker = Tracker::new(&Config::default()).map_err(|e| anyhow!("{e}"))?;
    Ok(Box::new(tracker))
}

/// Steps from Tracking to Tracking, and steps that find the face.
fn time_tracking(model: &Model<'_>, frames: &[Picture]) -> Result<(Times, Times)> {
    let mut tracker = fresh()?;
    let (mut tracking, mut acquiring) = (Vec::new(), Vec::new());
    let mut before = State::Searching;
    for i in 0..4 * STEPS {
        let Some(picture) = frames.get(back_and_forth(i, frames.len())) else {
            break;
        };
        let frame = picture.frame()?;
        let start = Instant::now();
        let result = tracker.step(model, &frame, i as i64 * STEP_US);
        let ns = start.elapsed().as_nanos() as u64;
        let after = result.map_err(|e| anyhow!("{e}"))?.state;
        match (before, after) {
            (State::Tracking, State::Tracking) => tracking.push(ns),
            (State::Searching, State::Tracking) => acquiring.push(ns),
            _ => {}
        }
        before = after;
        if tracking.len() == STEPS {
            break;
        }
    }
    Ok((Times::of(tracking), Times::of(acquiring)))
}

/// Steps that stay in Searching.
fn time_searching(model: &Model<'_>, frames: &[Picture]) -> Result<Times> {
    let mut tracker = fresh()?;
    let mut searching = Vec::new();
    for i in 0..STEPS {
        // A scan goes on over several frames; each picture stays for a while.
        let Some(picture) = frames.get(i / 40 % frames.len().max(1)) else {
            break;
        };
        let frame = picture.frame()?;
        let start = Instant::now();
        let result = tracker.step(model, &frame, i as i64 * STEP_US);
        let ns = start.elapsed().as_nanos() as u64;
        if result.map_err(|e| anyhow!("{e}"))?.state == State::Searching {
            searching.push(ns);
        }
    }
    Ok(Times::of(searching))
}

/// Peak stack over steps of both kinds \[bytes\].
fn measure_stack(model: &Model<'_>, frames: &[Picture], shuffled: &[Picture]) -> Option<usize> {
    let mut tracker = fresh().ok()?;
    let mut time = 0;
    stack::peak(|| {
        for picture in shuffled.iter().chain(frames.iter().take(60)) {
            time += STEP_US;
            if let Ok(frame) = picture.frame() {
                // Only the stack is looked at; time goes forward, so the step is taken.
                let _ = tracker.step(model, &frame, time);
            }
        }
    })
}

fn report(value: &Value) -> String {
    let mut out = String::new();
    let number = |v: &Value| {
        v.as_f64()
            .map_or("–".into(), |v| format!("{}", (v * 100.0).round() / 100.0))
    };
    // Writing to a String cannot fail.
    for state in ["tracking", "acquiring", "searching"] {
        let v = &value[state];
        let _ = writeln!(
            out,
            "{state:<18}{:>12} ns median {:>12} ns p99   ({} steps)",
            number(&v["median_ns"]),
            number(&v["p99_ns"]),
            number(&v["steps"])
        );
    }
    for part in value["stages_ns"].as_array().into_iter().flatten() {
        let name = part[0].as_str().unwrap_or_default();
        let _ = writeln!(out, "  {name:<28}{:>12} ns median", number(&part[1]));
    }
    for (name, key, unit) in [
        ("search / track", "searching_over_tracking", "×"),
        ("model", "model_bytes", "bytes"),
        ("tracker memory", "tracker_bytes", "bytes"),
        ("peak stack", "peak_stack_bytes", "bytes"),
    ] {
        let _ = writeln!(out, "{name:<18}{:>12} {unit}", number(&value[key]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_go_back_and_forth() {
        let order: Vec<usize> = (0..8).map(|i| back_and_forth(i, 4)).collect();
        assert_eq!(order, [0, 1, 2, 3, 2, 1, 0, 1]);
        assert_eq!(back_and_forth(5, 1), 0);
    }

    #[test]
    fn shuffling_keeps_the_pixels() {
        let image = image::RgbImage::from_fn(64, 32, |x, y| image::Rgb([(x + y) as u8; 3]));
        let picture = Picture::from_rgb(image);
        let shuffled = shuffled(std::slice::from_ref(&picture));
        let mut old: Vec<u8> = picture.data.iter().step_by(3).copied().collect();
        let mut new = shuffled[0].data.clone();
        assert_ne!(old, new);
        old.sort_unstable();
        new.sort_unstable();
        assert_eq!(old, new);
    }
}
