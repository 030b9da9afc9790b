//! `posewise-lab eval monitor`: does the driver monitor notice what the truth says?
//!
//! The monitor is shown again what the tracker reported, as the CSV has it, so that rates and
//! dropped frames can be tried. What is compared stands in docs/driver-monitor.md.

use std::path::PathBuf;

use anyhow::{Result, bail};
use glam::DVec3;
use posewise::State;
use posewise::eyes::{EyeUnknown, Eyes, Gaze};
use posewise::monitor::openness;
use posewise::monitor::{
    MonitorEvent, MonitorEventKind as Kind, MonitorState, Observation, Preset, ZonesBy,
};
use posewise_cli::cli::MonitorArgs;
use posewise_cli::monitor::watch::Watch;
use posewise_cli::parse::{DriverPlace, place, preset, within};
use serde_json::json;

use super::gaze_metrics::TrueGaze;
use super::glance_metrics::FoundGlances;
use super::monitor_metrics::{Found, Scores, Truth};
use super::pairs::{ClipsArgs, clips_of};
use super::passenger_metrics::TrueNoses;
use super::spans::Span;
use crate::output;
use crate::random::Random;
use crate::table::Table;

/// Options of `posewise-lab eval monitor`.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub clips: ClipsArgs,
    /// The rule whose times and thresholds the monitor takes
    #[arg(long, value_name = "NAME", default_value = "general", value_parser = preset)]
    pub preset: Preset,
    /// Zones of the monitor, as for `track --monitor-zones`
    #[arg(long, value_name = "FILE")]
    pub zones: Option<PathBuf>,
    /// Where the driver sits, as for `track --monitor-place`
    #[arg(long, value_name = "PLACE", default_value = "learnt", value_parser = place,
        allow_hyphen_values = true)]
    pub place: DriverPlace,
    /// Show the monitor this number of frames a second of those in the CSV [default: all]
    #[arg(long, value_name = "N", value_parser = within(1.0, 1000.0))]
    pub fps: Option<f64>,
    /// Leave out this share of the frames, by chance
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = within(0.0, 0.9))]
    pub drop: f64,
    /// Draws them
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

impl Args {
    fn settings(&self) -> MonitorArgs {
        MonitorArgs {
            monitor_preset: self.preset,
            monitor_zones: self.zones.clone(),
            monitor_zones_by: ZonesBy::default(),
            monitor_place: self.place,
        }
    }
}

/// Frames per second of a truth without times.
const FPS: f64 = 30.0;
/// The landmarks of the eyes and of the mouth.
const EYES: std::ops::Range<usize> = 36..48;
const MOUTH: std::ops::Range<usize> = 48..68;
/// A face with more than this share of its landmarks in the picture is seen.
const IN_FRAME: f64 = 0.9;
/// The tip of the nose.
const NOSE: usize = 30;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let (mut clips, mut all) = (Vec::new(), Scores::default());
    for (truth, csv) in clips_of(&args.clips)? {
        let truth_table = Table::read(truth)?;
        let found = replay(args, &Table::read(csv)?)?;
        let scores = Scores::of(&truth_of(&truth_table)?, &found);
        let mut value = scores.json();
        value["clip"] = truth.display().to_string().into();
        clips.push(value);
        all.add(&scores);
    }
    let mut value = all.json();
    value["preset"] = args.preset.name().into();
    value["fps"] = json!(args.fps);
    value["drop"] = args.drop.into();
    value["clips"] = clips.into();
    output::show(&value, args.clips.json.as_deref())
}

/// The columns of `track --csv` that a monitor needs.
struct Columns {
    frame: usize,
    timestamp: usize,
    state: usize,
    confidence: usize,
    pose: [usize; 5],
    sigma: [usize; 3],
    eyes: [usize; 2],
    /// What the network of single eyes says: `eye_status_…` and `eye_open_p_…`, in newer files.
    network: [Option<[usize; 2]>; 2],
    jaw: usize,
    /// `camera_assumed`, in newer files.
    assumed: Option<usize>,
    mouth: Vec<usize>,
    nose: [usize; 2],
    /// `gaze_status` and both angles, in newer files.
    gaze: Option<[usize; 3]>,
    /// The gaze in the head.
    gaze_head: Option<[usize; 3]>,
    /// Its standard deviation.
    gaze_sigma: Option<usize>,
}

impl Columns {
    fn of(csv: &Table) -> Result<Columns> {
        let column = |name: &str| csv.column(name);
        Ok(Columns {
            frame: column("frame")?,
            timestamp: column("timestamp")?,
            state: column("state")?,
            confidence: column("confidence")?,
            pose: [
                column("yaw_deg")?,
                column("pitch_deg")?,
                column("pose_Tx")?,
                column("pose_Ty")?,
                column("pose_Tz")?,
            ],
            sigma: [
                column("R_sigma_x")?,
                column("R_sigma_y")?,
                column("R_sigma_z")?,
            ],
            eyes: [column("eye_open_left")?, column("eye_open_right")?],
            network: ["left", "right"].map(|side| {
                let unknown = column(&format!("eye_status_{side}")).ok()?;
                Some([unknown, column(&format!("eye_open_p_{side}")).ok()?])
            }),
            jaw: column("jawOpen")?,
            assumed: column("camera_assumed").ok(),
            mouth: (48..68)
                .map(|i| column(&format!("vis_{i}")))
                .collect::<Result<_>>()?,
            nose: [column(&format!("x_{NOSE}"))?, column(&format!("y_{NOSE}"))?],
            gaze: three(csv, ["gaze_status", "gaze_angle_x", "gaze_angle_y"]),
            gaze_head: three(csv, ["gaze_head_x", "gaze_head_y", "gaze_head_z"]),
            gaze_sigma: column("gaze_sigma_deg").ok(),
        })
    }

    /// Angles of both eyes' gaze to the image right and down \[rad\], if it is known.
    fn gaze(&self, csv: &Table, row: usize) -> Result<Option<[f64; 2]>> {
        match self.gaze {
            Some([unknown, x, y]) if csv.text(row, unknown) == EyeUnknown::name_of(Ok(())) => {
                Ok(Some([csv.number(row, x)?, csv.number(row, y)?]))
            }
            _ => Ok(None),
        }
    }

    /// What a monitor sees of a row.
    fn observation(&self, csv: &Table, row: usize) -> Result<Observation> {
        let number = |column: usize| csv.number(row, column).map(|v| v as f32);
        let mut seen = Observation::default();
        seen.state = match csv.text(row, self.state) {
            "tracking" => State::Tracking,
            "coasting" => State::Coasting,
            _ => State::Searching,
        };
        seen.confidence = number(self.confidence)?;
        let [yaw, pitch, x, y, z] = self.pose;
        (seen.yaw_deg, seen.pitch_deg) = (number(yaw)?, number(pitch)?);
        seen.translation_mm = [number(x)?, number(y)?, number(z)?];
        seen.camera_assumed = self.assumed.map_or(Ok(0.0), number)? > 0.5;
        for (to, column) in seen.rotation_sigma_deg.iter_mut().zip(self.sigma) {
            *to = number(column)?;
        }
        let (mut lids, mut eyes) = ([None; 2], Eyes::EMPTY);
        for (k, (column, network)) in self.eyes.iter().zip(self.network).enumerate() {
            lids[k] = Some(number(*column)?).filter(|open| *open >= 0.0);
            if let Some([unknown, open]) = network {
                let word = csv.text(row, unknown);
                let reason = EyeUnknown::ALL.into_iter().find(|u| u.name() == word);
                eyes.each[k].open = match word == EyeUnknown::name_of(Ok(())) {
                    true => Ok(number(open)?),
                    false => Err(reason.unwrap_or_default()),
                };
            }
        }
        if let (Some([x, y]), Some(head)) = (self.gaze(csv, row)?, self.gaze_head) {
            let gaze = DVec3::new(x.tan(), y.tan(), -1.0).normalize();
            let camera = gaze.as_vec3().to_array();
            let [x, y, z] = head.map(number);
            eyes.gaze = Ok(Gaze::new(camera, [x?, y?, z?], 0.0));
            seen.gaze = Some(camera);
            seen.gaze_sigma_deg = self.gaze_sigma.map_or(Ok(0.0), number)?;
        }
        let both = openness(lids, &eyes);
        (seen.eye_open, seen.may_look_down) = (both.eye_open, both.may_look_down);
        let mut visibility = 0.0;
        for column in &self.mouth {
            visibility += number(*column)?;
        }
        // As `Observation` has it from a result.
        let is_visible = visibility >= 0.5 * self.mouth.len() as f32;
        seen.jaw_open = is_visible.then(|| number(self.jaw)).transpose()?;
        Ok(seen)
    }
}

/// Columns that newer files have.
fn three(csv: &Table, names: [&str; 3]) -> Option<[usize; 3]> {
    let columns: Option<Vec<usize>> = names.iter().map(|name| csv.column(name).ok()).collect();
    columns?.try_into().ok()
}

/// Shows the rows to a monitor, some of them left out.
fn replay(args: &Args, csv: &Table) -> Result<Found> {
    let columns = Columns::of(csv)?;
    let mut watch = Watch::new(&args.settings(), None, false)?;
    let mut random = Random::of(args.seed);
    let mut next_s = f64::NEG_INFINITY;
    let mut states: Vec<(i64, MonitorState)> = Vec::new();
    let (mut gazes, mut noses) = (Vec::new(), Vec::new());
    for row in 0..csv.len() {
        let time_s = csv.number(row, columns.timestamp)?;
        let is_dropped = (random.below(1_000_000) as f64) < args.drop * 1e6;
        // A tenth of a frame for times that are rounded.
        let is_early = args.fps.is_some_and(|fps| time_s < next_s - 0.1 / fps);
        if is_early || is_dropped {
            continue;
        }
        if let Some(fps) = args.fps {
            next_s = next_s.max(time_s - 1.0 / fps) + 1.0 / fps;
        }
        let seen = columns.observation(csv, row)?;
        let timestamp_us = (time_s * 1e6).round() as i64;
        watch.observe(&seen, timestamp_us)?;
        // Rows are numbered from 1, frames of the truth from 0.
        let frame = csv.number(row, columns.frame)? as i64 - 1;
        states.push((frame, watch.state()));
        gazes.push(columns.gaze(csv, row)?);
        let [x, y] = columns.nose.map(|column| csv.number(row, column));
        noses.push([x?, y?]);
    }
    if states.is_empty() {
        bail!("no frame is left");
    }
    let start_s = csv.number(0, columns.timestamp)?;
    let events = |begins: &[Kind], ends: &[Kind]| spans(&watch.events, start_s, begins, ends);
    let levels = [
        Kind::LongClosure,
        Kind::Microsleep,
        Kind::Sleep,
        Kind::Unresponsive,
    ];
    Ok(Found {
        closures: events(&levels, &[Kind::Blink, Kind::ClosureEnd]),
        yawns: events(&[Kind::Yawn], &[Kind::YawnEnd]),
        nods: events(&[], &[Kind::Nod]),
        glances: glances(&watch.events, start_s),
        states,
        gazes: columns.gaze.map(|_| gazes),
        noses,
    })
}

/// Glances of all lengths, and long ones up to when they were reported.
fn glances(events: &[MonitorEvent], start_s: f64) -> FoundGlances {
    let span = |event: &MonitorEvent, length_s: f64| Span {
        start_s: event.start_us as f64 / 1e6 - start_s,
        length_s,
    };
    let of = |kind: Kind| events.iter().filter(move |event| event.kind == kind);
    let seconds = |event: &MonitorEvent| f64::from(event.duration_us) / 1e6;
    let until = |event: &MonitorEvent| (event.timestamp_us - event.start_us) as f64 / 1e6;
    FoundGlances {
        all: of(Kind::Glance)
            .map(|event| span(event, seconds(event)))
            .collect(),
        long: of(Kind::LongGlance)
            .map(|event| (span(event, until(event)), seconds(event)))
            .collect(),
    }
}

/// When events were that end with these kinds, from the first frame on; the last one too that began
/// and has not ended, with its length so far.
fn spans(events: &[MonitorEvent], start_s: f64, begins: &[Kind], ends: &[Kind]) -> Vec<Span> {
    let span = |event: &MonitorEvent| Span {
        start_s: event.start_us as f64 / 1e6 - start_s,
        length_s: f64::from(event.duration_us) / 1e6,
    };
    let begin = |event: &&MonitorEvent| begins.contains(&event.kind);
    let end = |event: &&MonitorEvent| ends.contains(&event.kind);
    let last = (events.iter().rev()).find(|event| begin(event) || end(event));
    let ended = events.iter().filter(end);
    ended.chain(last.filter(begin)).map(span).collect()
}

/// Reads the truth of a clip.
fn truth_of(table: &Table) -> Result<Vec<Truth>> {
    let column = |name: &str| table.column(name);
    let (frame, yaw) = (column("frame")?, column("yaw")?);
    let blinks = [column("eyeBlink_R")?, column("eyeBlink_L")?];
    let jaw = column("jawOpen")?;
    // Columns that a truth need not have.
    let (time, nod, zone) = (column("time"), column("nod"), column("zone"));
    let gaze_zone = column("gaze_zone");
    let noses: Result<Vec<usize>> = ["x30", "y30", "passenger_x", "passenger_y", "in_frame"]
        .map(column)
        .into_iter()
        .collect();
    let covers = |part: std::ops::Range<usize>| -> Vec<usize> {
        part.filter_map(|i| column(&format!("o{i}")).ok()).collect()
    };
    let (eyes, mouth) = (covers(EYES), covers(MOUTH));
    let gazes: Result<Vec<usize>> = (0..2)
        .flat_map(|eye| ["x", "y", "z"].map(|axis| format!("gaze_{eye}_{axis}")))
        .map(|name| column(&name))
        .collect();
    let mut rows = Vec::new();
    for row in 0..table.len() {
        let number = |column: usize| table.number(row, column);
        let covered = |columns: &[usize]| -> Result<usize> {
            let mut hidden = 0;
            for column in columns {
                hidden += usize::from(number(*column)? > 0.5);
            }
            Ok(hidden)
        };
        let (covered_eyes, covered_mouth) = (covered(&eyes)?, covered(&mouth)?);
        let blinks = [number(blinks[0])?, number(blinks[1])?];
        let both = match &gazes {
            Ok(columns) => Some(both_gazes(table, row, columns)?),
            Err(_) => None,
        };
        let gaze = both.map(|both| TrueGaze {
            both,
            blinks,
            covered: covered_eyes,
        });
        let frame = number(frame)? as i64;
        let optional = |column: &Result<usize>| match column {
            Ok(column) => number(*column).map(Some),
            Err(_) => Ok(None),
        };
        let noses = match noses.as_deref() {
            Ok(&[x, y, other_x, other_y, in_frame]) => Some(TrueNoses {
                driver: [number(x)?, number(y)?],
                passenger: [number(other_x)?, number(other_y)?],
                is_driver_seen: number(in_frame)? > IN_FRAME,
            }),
            _ => None,
        };
        rows.push(Truth {
            frame,
            time_s: optional(&time)?.unwrap_or(frame as f64 / FPS),
            blink: (blinks[0] + blinks[1]) / 2.0,
            jaw: number(jaw)?,
            yaw_deg: number(yaw)?,
            is_covered: 2 * covered_eyes >= EYES.len()
                || noses.as_ref().is_some_and(|noses| !noses.is_driver_seen),
            is_mouth_covered: 2 * covered_mouth >= MOUTH.len(),
            is_nod: optional(&nod)?.map(|nod| nod > 0.5),
            zone: optional(&zone)?,
            gaze_zone: optional(&gaze_zone)?,
            gaze,
            noses,
        });
    }
    Ok(rows)
}

/// The sum of both eyes' gazes; their columns are the axes of one after the other.
fn both_gazes(table: &Table, row: usize, columns: &[usize]) -> Result<DVec3> {
    let mut sum = [0.0; 3];
    for (k, column) in columns.iter().enumerate() {
        sum[k % 3] += table.number(row, *column)?;
    }
    Ok(DVec3::from(sum))
}
