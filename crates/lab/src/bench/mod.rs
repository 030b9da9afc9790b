//! `posewise-lab bench`: what a step costs, on one thread.
//!
//! The tracker gets the clip, also cut, moved, shuffled and damaged, so that it loses and finds the
//! face in every way ([`scenes`]) and the worst-case step is among those timed ([`steps`]).

mod frame_sizes;
mod scenes;
mod stack;
mod stages;
mod steps;

use std::path::PathBuf;

use anyhow::Result;
use image::GrayImage;
use posewise::network::{KernelName, chosen_kernel, select_kernel};
use posewise::{Model, Tracker};
use posewise_cli::demo;
use posewise_cli::model_file::ModelFile;
use posewise_cli::picture::Picture;
use serde_json::{Value, json};

use crate::footage::clip::Clip;
use crate::output;
use scenes::Scenes;
use stages::Stage;
use steps::{Kind, STEP_US, Steps};

/// Options of `posewise-lab bench`.
#[derive(clap::Args)]
pub struct Args {
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Clip to track; without it the one that ships with posewise
    #[arg(long, value_name = "INPUT")]
    pub input: Option<String>,
    /// Inner loops of the networks [default: the fastest of this machine]
    #[arg(long, value_name = "NAME", value_parser = kernel)]
    pub kernel: Option<KernelName>,
    /// Folder of pictures without people that are searched; without it blocks of the clip in a
    /// random order
    #[arg(long, value_name = "DIR")]
    pub clutter: Option<PathBuf>,
}

/// Most frames of the clip that are kept in memory.
const MAX_FRAMES: usize = 300;
/// Trackers that share the model, each with memory of its own.
const SHARED: [usize; 5] = [1, 2, 4, 8, 16];
/// Frames of the clip that they track.
const SHARED_FRAMES: usize = 30;
/// Frames of the clip over which the stack is measured.
const STACK_FRAMES: usize = 60;

/// A kernel that this machine runs.
fn kernel(name: &str) -> Result<KernelName, String> {
    let available = || KernelName::ALL.into_iter().filter(|k| k.is_available());
    available().find(|k| k.name() == name).ok_or_else(|| {
        let names: Vec<&str> = available().map(KernelName::name).collect();
        format!("this machine runs {}", names.join(", "))
    })
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let file = ModelFile::read(args.model.as_deref())?;
    let model = file.model()?;
    // Parsing the option has checked that the machine runs it.
    args.kernel.map(select_kernel);
    let clip = match &args.input {
        Some(input) => Clip::open(input, 30.0, MAX_FRAMES)?,
        None => Clip::read(demo::clip::open()?.as_mut(), MAX_FRAMES, "the demo clip")?,
    };
    let scenes = Scenes::of(&clip.frames);
    let steps = Steps::time(&model, || scenes.pictures())?;
    let sizes = frame_sizes::time(&model, &clip.frames, args.clutter.as_deref())?;
    let shared = time_shared(&model, &clip.frames)?;
    let stages = stages::time(&model, &clip.frames)?;
    let peak_stack = measure_stack(&model, &clip.frames, scenes.shuffled());
    let tracking = steps.of(Some(Kind::Tracking)).quantile(0.5);
    let over_tracking = |ns: Option<u64>| {
        let both = ns.zip(tracking);
        both.map(|(ns, tracking)| ns as f64 / tracking.max(1) as f64)
    };
    let worst = steps.worst();
    let name = |kind: Kind| Kind::ALL.iter().find(|(k, _)| *k == kind).map(|(_, n)| *n);
    let mut value = json!({
        "frame": clip.frames[0].dimensions(),
        "runs": steps.runs,
        "kernel": chosen_kernel().name(),
    });
    for (kind, name) in Kind::ALL {
        value[name] = steps.of(Some(kind)).json();
    }
    value["all"] = steps.of(None).json();
    let searching = steps.of(Some(Kind::Searching)).quantile(0.5);
    value["searching_over_tracking"] = json!(over_tracking(searching));
    value["worst_ns"] = json!(worst.map(|w| w.1));
    value["worst_state"] = json!(worst.and_then(|w| name(w.0)));
    value["worst_over_tracking"] = json!(over_tracking(worst.map(|w| w.1)));
    value["stages"] = stages.iter().map(|s| stage(s, tracking)).collect();
    value["frame_sizes"] = sizes.into();
    value["trackers"] = shared.into();
    value["model_bytes"] = json!(model.blob().total_len());
    value["tracker_bytes"] = json!(std::mem::size_of::<Tracker>());
    value["peak_stack_bytes"] = json!(peak_stack);
    value["threads"] = json!(1);
    output::show(&value, args.json.as_deref())
}

/// Times of tracking steps of several trackers in turn on each frame, as JSON.
fn time_shared(model: &Model<'_>, frames: &[GrayImage]) -> Result<Vec<Value>> {
    let shown = || frames.iter().take(SHARED_FRAMES).cloned();
    SHARED
        .iter()
        .map(|count| {
            let steps = Steps::time_shared(model, *count, shown)?;
            let tracking = steps.of(Some(Kind::Tracking)).json();
            Ok(json!({"count": count, "tracking": tracking}))
        })
        .collect()
}

fn stage(stage: &Stage, tracking: Option<u64>) -> Value {
    let Stage {
        name,
        ns,
        multiply_adds,
        of_tracking,
    } = *stage;
    let over = |n: u64, d: u64| n as f64 / d.max(1) as f64;
    let share = tracking.map(|tracking| over(ns, tracking));
    json!({
        "name": name,
        "ns": ns,
        "multiply_adds": multiply_adds,
        "multiply_adds_per_ns": (multiply_adds > 0).then(|| over(multiply_adds as u64, ns)),
        "share_of_tracking": share.filter(|_| of_tracking),
    })
}

/// Peak stack over steps of all kinds \[bytes\].
fn measure_stack(model: &Model<'_>, frames: &[GrayImage], shuffled: &[GrayImage]) -> Option<usize> {
    let shown = shuffled.iter().chain(frames.iter().take(STACK_FRAMES));
    let pictures: Vec<Picture> = shown.cloned().map(Picture::from_grey).collect();
    let mut tracker = steps::fresh().ok()?;
    let mut time = 0;
    stack::peak(|| {
        for picture in &pictures {
            time += STEP_US;
            if let Ok(frame) = picture.frame() {
                // Only the stack is looked at; time goes forward, so the step is taken.
                let _ = tracker.step(model, &frame, time);
            }
        }
    })
}
