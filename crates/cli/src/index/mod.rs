//! `posewise index`: tracks many videos on all cores, a Parquet file each, and a manifest.
//!
//! | file | what it does |
//! |---|---|
//! | `videos` | the videos of a folder or a list, and where their tables go |
//! | `table` | a video's table, and what its metadata says |
//! | `summary` | spans with a face, where it looks, gaps |

mod summary;
mod table;
mod videos;

use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, anyhow, bail, ensure};
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use posewise::Model;
use rayon::prelude::*;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use self::summary::Summary;
use self::table::{Origin, Table};
use self::videos::Video;
use crate::calibration::Calibration;
use crate::cli::IndexArgs;
use crate::csv::Row;
use crate::destination::Destination;
use crate::interrupt::Interrupt;
use crate::model_file::ModelFile;
use crate::session::Session;
use crate::{bounded, output, source};

/// The list of all videos, in the folder of the tables.
const MANIFEST: &str = "manifest.jsonl";

/// Stack of a thread \[bytes\]: a tracker may be moved by value.
const THREAD_STACK: usize = 16 << 20;

/// What became of a video.
enum Outcome {
    /// It was tracked now.
    Tracked(Value),
    /// Its table was there, made from the same file with the same settings.
    Present(Value),
    /// It cannot be read.
    Broken(String),
    /// A signal came before its end.
    Interrupted,
}

/// Runs the command; returns the exit status that a signal asked for.
pub fn run(args: &IndexArgs) -> Result<Option<u8>> {
    args.frame.check(&args.tracker)?;
    let file = ModelFile::read(args.tracker.model.as_deref())?;
    let model = file.model()?;
    let videos = videos::find(&args.input, &args.out)?;
    let settings = settings(args, file.bytes())?;
    let _lock = open_folder(&args.out, &videos)?;
    let interrupt = Interrupt::listen().context("cannot listen for signals")?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .stack_size(THREAD_STACK)
        .build()
        .context("cannot start threads")?;
    let broken = AtomicUsize::new(0);
    let bar = progress_bar(videos.len(), args.quiet);
    let said = Mutex::new(());
    let work = || -> Vec<Outcome> {
        let videos = videos.par_iter().with_max_len(1);
        let outcomes = videos.progress_with(bar.clone()).map(|video| {
            let outcome = outcome_of(args, &model, &settings, video, &interrupt);
            if let Outcome::Broken(error) = &outcome {
                broken.fetch_add(1, Ordering::Relaxed);
                let _lock = said.lock();
                bar.suspend(|| eprintln!("posewise: {error}"));
            }
            outcome
        });
        outcomes.collect()
    };
    let outcomes = threads.install(work);
    bar.finish_and_clear();
    write_manifest(&args.out, &videos, &outcomes)?;
    if !args.quiet {
        output::print(&report(&outcomes))?;
    }
    let broken = broken.into_inner();
    if interrupt.status().is_none() && broken > 0 {
        bail!("{broken} of {} videos cannot be read", videos.len());
    }
    Ok(interrupt.status())
}

/// Makes the folder of tables, and keeps other runs away from it until the result is dropped. What
/// a killed run left half-written of these tables, is removed.
fn open_folder(folder: &Path, videos: &[Video]) -> Result<File> {
    let cannot = || format!("cannot make folder {}", folder.display());
    std::fs::create_dir_all(folder).with_context(cannot)?;
    let handle = File::open(folder).with_context(cannot)?;
    match handle.try_lock() {
        Err(TryLockError::WouldBlock) => bail!("{}: another run writes there", folder.display()),
        // Some file systems have no locks.
        Err(TryLockError::Error(_)) => {}
        Ok(()) => {
            let manifest = folder.join(MANIFEST);
            let tables = videos.iter().map(|video| &*video.table);
            videos::remove_leftovers(tables.chain([&*manifest]))?;
        }
    }
    Ok(handle)
}

fn outcome_of(
    args: &IndexArgs,
    model: &Model<'_>,
    settings: &str,
    video: &Video,
    interrupt: &Interrupt,
) -> Outcome {
    if interrupt.status().is_some() {
        return Outcome::Interrupted;
    }
    let tracked = Origin::of(&video.path, settings).and_then(|origin| {
        if let Some(summary) = table::summary_of(&video.table, &origin) {
            return Ok(Outcome::Present(summary));
        }
        track(args, model, &origin, video, interrupt)
    });
    tracked.unwrap_or_else(|error| {
        let name = video.path.display().to_string();
        let error = format!("{error:#}");
        Outcome::Broken(match error.contains(&name) {
            true => error,
            false => format!("{name}: {error}"),
        })
    })
}

/// Tracks one video. Its table has its name only when it is complete.
fn track(
    args: &IndexArgs,
    model: &Model<'_>,
    origin: &Origin,
    video: &Video,
    interrupt: &Interrupt,
) -> Result<Outcome> {
    let input = video.path.to_str();
    let input = input.ok_or_else(|| anyhow!("its name is not UTF-8"))?;
    let mut source = source::open(input, args.frame.fps)?;
    ensure!(!source.is_live(), "only recordings can be indexed");
    let mut session = Session::new(model, &args.tracker, false)?;
    session.set_roi(args.frame.roi)?;
    if let Some(folder) = video.table.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make folder {}", folder.display()))?;
    }
    let destination = Destination::new(&video.table);
    let mut table = Table::create(destination.path())?;
    let mut summary = Summary::new(source.fps());
    let mut frame = 0;
    while let Some(mut picture) = source.next()? {
        if interrupt.status().is_some() {
            return Ok(Outcome::Interrupted);
        }
        frame += 1;
        picture.layout.rotation = args.frame.rotation();
        picture.layout.mirrored = args.frame.mirror;
        let result = session.step(&picture)?;
        let row = Row {
            frame,
            face_id: 0,
            result,
        };
        table.write(&row)?;
        summary.add(result);
        while session.events().pop().is_some() {}
    }
    let mut summary = summary.finish();
    if let Some(warning) = source.warning() {
        summary["warning"] = json!(warning);
    }
    table.finish(origin, &summary)?;
    destination.finish()?;
    Ok(Outcome::Tracked(summary))
}

/// What a table depends on beside the video, as JSON.
fn settings(args: &IndexArgs, model: &[u8]) -> Result<String> {
    let (tracker, frame) = (&args.tracker, &args.frame);
    let calibration = tracker.calibration.as_deref();
    let calibration = calibration
        .map(|path| bounded::read("calibration", path, Calibration::MOST_MB))
        .transpose()?;
    Ok(json!({
        "version": env!("CARGO_PKG_VERSION"),
        "model_sha256": sha256(model),
        "focal": tracker.focal,
        "fov": tracker.fov,
        "calibration_sha256": calibration.map(|bytes| sha256(&bytes)),
        "fisheye": tracker.fisheye,
        "min_face": tracker.min_face,
        "scan_budget": tracker.scan_budget,
        "gaze": tracker.gaze,
        "natural_gaze": tracker.natural_gaze,
        "smooth": tracker.smooth,
        "smooth_cutoff": tracker.smooth_cutoff,
        "smooth_beta": tracker.smooth_beta,
        "rotate": frame.rotate,
        "mirror": frame.mirror,
        "roi": frame.roi.map(|r| [r.x, r.y, r.width, r.height]),
        "fps": frame.fps,
    })
    .to_string())
}

fn sha256(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// One line for each video of this run, in their order. Videos that a signal left out are not in
/// it.
fn write_manifest(folder: &Path, videos: &[Video], outcomes: &[Outcome]) -> Result<()> {
    let destination = Destination::new(&folder.join(MANIFEST));
    let mut out = output::open(&destination)?;
    for (video, outcome) in videos.iter().zip(outcomes) {
        let mut line = json!({ "video": video.path.to_string_lossy() });
        match outcome {
            Outcome::Tracked(summary) | Outcome::Present(summary) => {
                let table = video.table.strip_prefix(folder).unwrap_or(&video.table);
                line["table"] = json!(table.to_string_lossy());
                let fields = summary.as_object().into_iter().flatten();
                for (key, value) in fields {
                    line[key] = value.clone();
                }
            }
            Outcome::Broken(error) => line["error"] = json!(error),
            Outcome::Interrupted => continue,
        }
        writeln!(out, "{line}").context("cannot write the manifest")?;
    }
    out.flush().context("cannot write the manifest")?;
    drop(out);
    destination.finish()
}

fn progress_bar(count: usize, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} videos eta {eta}") {
        bar.set_style(style);
    }
    bar
}

fn report(outcomes: &[Outcome]) -> String {
    let count = |is: fn(&Outcome) -> bool| outcomes.iter().filter(|o| is(o)).count();
    let frames: u64 = (outcomes.iter())
        .filter_map(|outcome| match outcome {
            Outcome::Tracked(summary) => summary["frames"].as_u64(),
            _ => None,
        })
        .sum();
    format!(
        "tracked  {} videos, {frames} frames\npresent  {}\nbroken   {}\nleft     {}\n",
        count(|o| matches!(o, Outcome::Tracked(_))),
        count(|o| matches!(o, Outcome::Present(_))),
        count(|o| matches!(o, Outcome::Broken(_))),
        count(|o| matches!(o, Outcome::Interrupted)),
    )
}
