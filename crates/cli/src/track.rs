//! `posewise track`: source → tracker → CSV, JSON lines, overlay, plot, head.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use indicatif::{ProgressBar, ProgressStyle};
use posewise::{EventLog, Model, State, TrackResult};

use crate::cli::{TrackArgs, TrackerArgs};
use crate::csv::{CsvWriter, Row};
use crate::destination::{self, Destination, Named};
use crate::faces::{Face, Faces};
use crate::head::{self, HeadFiles};
use crate::interrupt::Interrupt;
use crate::lens::LensNote;
use crate::model_file::ModelFile;
use crate::monitor;
use crate::monitor::watch::Watch;
use crate::overlay::{Overlay, Painter};
use crate::picture::Picture;
use crate::plot::{self, Sample};
use crate::retarget::{self, Retargeting};
use crate::source::Source;
use crate::streams::{Pace, Streams};
use crate::{jsonl, log, output, source};

/// What happened over a run.
#[derive(Default)]
pub struct Counts {
    /// Frames seen.
    pub frames: u64,
    /// Frames fitted.
    pub tracked: u64,
    /// Frames bridged with the last fit.
    pub coasted: u64,
}

impl Counts {
    fn add(&mut self, state: State) {
        self.frames += 1;
        self.tracked += u64::from(state == State::Tracking);
        self.coasted += u64::from(state == State::Coasting);
    }

    /// Share of a count among all frames \[%\].
    pub fn percent(&self, count: u64) -> f64 {
        100.0 * count as f64 / self.frames.max(1) as f64
    }
}

struct Outputs<'m> {
    /// The files, renamed when they are complete.
    destinations: Vec<Destination>,
    csv: Option<CsvWriter<Box<dyn Write>>>,
    jsonl: Option<Box<dyn Write>>,
    log: Option<Box<dyn Write>>,
    watch: Option<Watch>,
    retargeting: Option<Retargeting>,
    overlay: Option<Overlay>,
    head: HeadFiles<'m>,
    streams: Streams,
    painter: Painter,
    samples: Vec<Sample>,
    live: bool,
}

impl<'m> Outputs<'m> {
    fn open(
        args: &TrackArgs,
        source: &dyn Source,
        model: &Model<'m>,
        retargeting: Option<Retargeting>,
    ) -> Result<Self> {
        let mut destinations = Vec::new();
        let mut open = |path: &Path| {
            let destination = Destination::new(path);
            let out = output::open(&destination);
            destinations.push(destination);
            out
        };
        let csv = args.csv.as_deref().map(&mut open).transpose()?;
        let jsonl = args.jsonl.as_deref().map(&mut open).transpose()?;
        let log = match &args.log {
            None => None,
            Some(None) => Some(Box::new(std::io::stderr()) as Box<dyn Write>),
            Some(Some(path)) => Some(open(path)?),
        };
        let events = match &args.monitor {
            None => None,
            Some(None) => Some(Box::new(std::io::stderr()) as Box<dyn Write>),
            Some(Some(path)) => Some(open(path)?),
        };
        let watch =
            events.map(|out| Watch::new(&args.monitor_settings, Some(out), args.plot.is_some()));
        let mut more = match &watch {
            Some(_) => monitor::columns::names(),
            None => Vec::new(),
        };
        if retargeting.is_some() {
            more.extend(retarget::columns());
        }
        Ok(Outputs {
            destinations,
            csv: csv.map(|out| CsvWriter::new(out, &more)).transpose()?,
            jsonl,
            log,
            watch: watch.transpose()?,
            overlay: args
                .overlay
                .as_deref()
                .map(|path| Overlay::create(path, source.fps()))
                .transpose()?,
            head: HeadFiles::open(args, model)?,
            streams: Streams::open(
                args.osc.as_deref(),
                args.udp_opentrack.as_deref(),
                args.tracker.gaze || args.tracker.natural_gaze || args.monitor.is_some(),
                retargeting.clone(),
            )?,
            retargeting,
            painter: Painter::new(&args.overlay_style),
            samples: Vec::new(),
            live: source.is_live(),
        })
    }

    fn write(
        &mut self,
        args: &TrackArgs,
        frame: u64,
        picture: &Picture,
        trackers: &Faces<'_>,
        faces: &[Face],
    ) -> Result<()> {
        if let Err(error) = self.write_rows(frame, picture, faces) {
            // None of them gets its name that may miss a row.
            self.destinations.clear();
            return Err(error);
        }
        if let Some(overlay) = &mut self.overlay {
            let mut image = picture.upright_rgb()?;
            let camera = trackers.intrinsics();
            self.painter.paint(&mut image, frame, faces, &camera);
            overlay.write(&image)?;
        }
        let first = faces.iter().find(|face| face.id == 0);
        let mut result = first.map_or(TrackResult::EMPTY, |face| face.result);
        result.timestamp_us = picture.timestamp_us;
        if args.plot.is_some() {
            self.samples.push(Sample::of(&result));
        }
        self.streams.send(&result)?;
        if let Some(retargeting) = &self.retargeting {
            result.animation = retargeting.animation(&result);
        }
        let head = &mut self.head;
        head.add(frame, picture.timestamp_us, &result, trackers.first())?;
        if self.live {
            self.flush()?;
        }
        Ok(())
    }

    fn write_rows(&mut self, frame: u64, picture: &Picture, faces: &[Face]) -> Result<()> {
        let watched = self.watch(picture, faces)?;
        for Face { id, result } in faces {
            let avatar = self.retargeting.as_ref().map(|of| of.weights(result));
            let cells = retarget::cells(avatar.as_ref().map_or(&[][..], |weights| &weights[..]));
            let more = [&watched[..], &cells[..]].concat();
            let row = Row {
                frame,
                face_id: *id,
                result,
            };
            if let Some(csv) = &mut self.csv {
                csv.write(&row, &more)?;
            }
            if let Some(out) = &mut self.jsonl {
                jsonl::write(out, &row, avatar.as_ref())?;
            }
        }
        Ok(())
    }

    /// Shows the driver to the monitor; returns what it adds to the row.
    fn watch(&mut self, picture: &Picture, faces: &[Face]) -> Result<Vec<String>> {
        let Some(watch) = &mut self.watch else {
            return Ok(Vec::new());
        };
        let result = faces.first().map_or(TrackResult::EMPTY, |face| face.result);
        watch.see(&result, picture.timestamp_us)?;
        Ok(monitor::columns::values(&watch.state()))
    }

    /// `face_id` is that of a tracker among several.
    fn write_log(&mut self, face_id: Option<usize>, events: &mut EventLog) -> Result<()> {
        match &mut self.log {
            Some(out) => log::write(out, face_id, events).context("cannot write the log"),
            None => Ok(()),
        }
    }

    fn flush(&mut self) -> Result<()> {
        if let Some(csv) = &mut self.csv {
            csv.flush()?;
        }
        if let Some(out) = &mut self.jsonl {
            out.flush().context("cannot write the JSON lines")?;
        }
        if let Some(out) = &mut self.log {
            out.flush().context("cannot write the log")?;
        }
        if let Some(watch) = &mut self.watch {
            watch.flush()?;
        }
        Ok(())
    }

    /// Closes all files and gives them their names; draws the plot and writes the head.
    fn finish(mut self, args: &TrackArgs, trackers: &Faces<'_>) -> Result<()> {
        self.flush()?;
        (self.csv, self.jsonl, self.log) = (None, None, None);
        if let Some(watch) = &mut self.watch {
            watch.close();
        }
        for destination in self.destinations.drain(..) {
            destination.finish()?;
        }
        if let Some(overlay) = self.overlay.take() {
            overlay.finish()?;
        }
        for warning in self.streams.warnings() {
            eprintln!("posewise: warning: {warning}");
        }
        if let (Some(path), false) = (&args.plot, self.samples.is_empty()) {
            let destination = Destination::new(path);
            let to = destination.path();
            match &self.watch {
                Some(Watch { states, events, .. }) => {
                    monitor::plot::write(to, &self.samples, states, events)?;
                }
                None => plot::write(to, &self.samples)?,
            }
            destination.finish()?;
        }
        self.head.finish(trackers.first())
    }

    /// Whether results go to standard output, where a summary would be in the way.
    fn on_stdout(args: &TrackArgs) -> bool {
        let dash = Some(std::path::Path::new("-"));
        let outputs = [
            &args.csv,
            &args.jsonl,
            &args.gltf,
            &args.obj,
            file_of(&args.log),
            file_of(&args.monitor),
        ];
        outputs.iter().any(|path| path.as_deref() == dash)
    }
}

/// The file of an option whose value may be missing; `None` is standard error, or no output.
fn file_of(option: &Option<Option<PathBuf>>) -> &Option<PathBuf> {
    option.as_ref().unwrap_or(&None)
}

/// Refuses outputs that would overwrite what is read, or each other.
fn check_outputs(args: &TrackArgs) -> Result<()> {
    let files = source::files(&args.input);
    let mut inputs: Vec<Named<'_>> = (files.iter())
        .map(|path| Named {
            option: "INPUT",
            path,
        })
        .collect();
    fn named<'a>(option: &'a str, path: &'a Option<PathBuf>) -> Option<Named<'a>> {
        path.as_deref().map(|path| Named { option, path })
    }
    inputs.extend(named("--model", &args.tracker.model));
    inputs.extend(named("--calibration", &args.tracker.calibration));
    inputs.extend(named(
        "--monitor-zones",
        &args.monitor_settings.monitor_zones,
    ));
    inputs.extend(named("--retarget", &args.retarget));
    let outputs = [
        named("--csv", &args.csv),
        named("--jsonl", &args.jsonl),
        named("--overlay", &args.overlay),
        named("--plot", &args.plot),
        named("--gltf", &args.gltf),
        named("--obj", &args.obj),
        named("--log", file_of(&args.log)),
        named("--monitor", file_of(&args.monitor)),
    ];
    let outputs: Vec<Named<'_>> = outputs.into_iter().flatten().collect();
    destination::check(&inputs, &outputs)?;
    // The pictures of an overlay's folder are outputs too.
    let Some(folder) = args.overlay.as_deref().filter(|path| path.is_dir()) else {
        return Ok(());
    };
    let mut files = inputs.iter().chain(&outputs);
    match files.find(|file| destination::is_numbered(file.path, folder)) {
        None => Ok(()),
        Some(Named { option, path }) => bail!(
            "--overlay {} would overwrite {option} {}",
            folder.display(),
            path.display()
        ),
    }
}

/// Runs the command; returns the exit status that a signal asked for.
pub fn run(args: &TrackArgs) -> Result<Option<u8>> {
    if let Some(path) = &args.plot {
        plot::check_name(path)?;
    }
    args.frame.check(&args.tracker)?;
    if args.monitor.is_some() && args.faces > 1 {
        bail!("--monitor watches one driver: not with --faces");
    }
    check_outputs(args)?;
    let retargeting = args
        .retarget
        .as_deref()
        .map(Retargeting::read)
        .transpose()?;
    let file = ModelFile::read(args.tracker.model.as_deref())?;
    let model = file.model()?;
    head::check(args, &model)?;
    let mut source = source::open(&args.input, args.frame.fps)?;
    let live = source.is_live();
    let settings = TrackerArgs {
        natural_gaze: args.tracker.natural_gaze || args.monitor.is_some(),
        ..args.tracker.clone()
    };
    let mut trackers = Faces::new(args.faces, &model, &settings, live, args.frame.roi)?;
    let interrupt = Interrupt::listen().context("cannot listen for signals")?;
    let mut outputs = Outputs::open(args, source.as_ref(), &model, retargeting)?;
    let progress = progress_bar(source.as_ref(), args);
    let mut counts = Counts::default();
    let mut lens = LensNote::default();
    let ended = follow(
        args,
        source.as_mut(),
        &mut trackers,
        &mut outputs,
        &mut lens,
        |state| {
            counts.add(state);
            progress.inc(1);
            interrupt.status().is_none()
        },
    );
    progress.finish_and_clear();
    // What was tracked before an input broke off is kept.
    outputs.finish(args, &trackers)?;
    // A signal reaches the programs at the other end of a pipe too.
    if interrupt.status().is_none() {
        ended?;
    }
    if let Some(warning) = source.warning() {
        eprintln!("posewise: warning: {warning}");
    }
    if !args.quiet {
        let text = summary(&counts, &lens, trackers.busy());
        if Outputs::on_stdout(args) {
            eprint!("{text}");
        } else {
            output::print(&text)?;
        }
    }
    Ok(interrupt.status())
}

/// Tracks frame by frame, until `go_on` says that the last one was enough.
fn follow(
    args: &TrackArgs,
    source: &mut dyn Source,
    trackers: &mut Faces<'_>,
    outputs: &mut Outputs<'_>,
    lens: &mut LensNote,
    mut go_on: impl FnMut(State) -> bool,
) -> Result<()> {
    let rotation = args.frame.rotation();
    let limit = args.frames.unwrap_or(u64::MAX);
    let mut pace = (!outputs.streams.is_empty() && !source.is_live()).then(Pace::default);
    for frame in 1..=limit {
        let Some(mut picture) = source.next()? else {
            break;
        };
        picture.layout.rotation = rotation;
        picture.layout.mirrored = args.frame.mirror;
        if let Some(pace) = &mut pace {
            pace.wait(picture.timestamp_us);
        }
        let faces = match source.total() {
            Some(1) => still(trackers, &mut picture)?,
            _ => trackers.step(&picture)?,
        };
        for (id, events) in trackers.events() {
            outputs.write_log(id, events)?;
        }
        let camera = trackers.intrinsics();
        lens.add(&args.tracker, 2.0 * camera.cx + 1.0, picture.focal_px);
        outputs.write(args, frame, &picture, trackers, &faces)?;
        if let Some(watch) = &mut outputs.watch {
            let size = trackers.first().size();
            if let Some(turn) = watch.keep(picture.timestamp_us, &camera, size) {
                trackers.turn(turn, args.frame.roi)?;
            }
        }
        if !go_on(state_of(&faces)) {
            break;
        }
    }
    Ok(())
}

/// How often a picture that is alone is searched: each scan looks at other sizes than the others.
const STILL_STEPS: usize = 8;

/// The faces of a picture that is alone. It is shown again, a microsecond later, until a face is
/// found.
fn still(trackers: &mut Faces<'_>, picture: &mut Picture) -> Result<Vec<Face>> {
    let timestamp_us = picture.timestamp_us;
    let mut faces = trackers.step(picture)?;
    for _ in 1..STILL_STEPS {
        if state_of(&faces) == State::Tracking {
            break;
        }
        picture.timestamp_us += 1;
        faces = trackers.step(picture)?;
    }
    picture.timestamp_us = timestamp_us;
    for face in &mut faces {
        face.result.timestamp_us = timestamp_us;
    }
    Ok(faces)
}

/// That of the frame: tracking, or else coasting, if any face is.
fn state_of(faces: &[Face]) -> State {
    let is = |state: State| faces.iter().any(|face| face.result.state == state);
    let known = [State::Tracking, State::Coasting].into_iter();
    known
        .into_iter()
        .find(|state| is(*state))
        .unwrap_or_default()
}

fn progress_bar(source: &dyn Source, args: &TrackArgs) -> ProgressBar {
    // The log and a bar would write over each other.
    if args.quiet || args.log == Some(None) || args.monitor == Some(None) {
        return ProgressBar::hidden();
    }
    let total = [source.total(), args.frames].into_iter().flatten().min();
    let (bar, template) = match total {
        Some(total) => (
            ProgressBar::new(total),
            "{bar:40} {pos}/{len} frames {per_sec} eta {eta}",
        ),
        None => (ProgressBar::no_length(), "{spinner} {pos} frames {per_sec}"),
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

fn summary(counts: &Counts, lens: &LensNote, busy: Duration) -> String {
    let mean_ms = busy.as_secs_f64() * 1e3 / counts.frames.max(1) as f64;
    format!(
        "frames   {}\ntracked  {} ({:.1} %)\ncoasted  {} ({:.1} %)\nlens     {lens}\n\
         step     {:.3} ms on average\n",
        counts.frames,
        counts.tracked,
        counts.percent(counts.tracked),
        counts.coasted,
        counts.percent(counts.coasted),
        mean_ms
    )
}
