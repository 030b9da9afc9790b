//! The command line's grammar: every option of `posewise`.

use std::net::SocketAddr;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, Parser, Subcommand, ValueEnum};
use posewise::monitor::{Preset, ZonesBy};
use posewise::{MAX_GROUP, Roi, Rotation};

use crate::parse::{DriverPlace, host_port, place, preset, rate, roi, whole, within, zones_by};

/// Head pose, 68 landmarks and facial animation from camera frames
#[derive(Parser)]
#[command(name = "posewise", version)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Track the face in a video, pictures, a pipe or a camera
    Track(Box<TrackArgs>),
    /// Track a camera or a video, and show it live in browsers, also on other machines
    View(ViewArgs),
    /// Track many videos on all cores: a Parquet file each, and a manifest
    Index(IndexArgs),
    /// Track the clip that ships with posewise; writes posewise-demo.png and posewise-demo.csv here
    Demo(DemoArgs),
    /// Look into model files
    #[command(subcommand)]
    Model(ModelCommand),
    /// Print the columns of `track --csv` with their units, as a Markdown table
    Columns,
    /// Write manual pages and shell completions into a folder that has the shape of /usr/share
    #[command(hide = true)]
    Manual {
        /// The folder; those below it are made
        folder: PathBuf,
    },
}

/// Settings of the tracker and the camera.
#[derive(Args, Clone, Default)]
pub struct TrackerArgs {
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Focal length [px] [default: that of a picture's EXIF, else of 60° across]
    #[arg(long, value_name = "PX", value_parser = within(1.0_f32, 1e6))]
    pub focal: Option<f32>,
    /// Horizontal field of view [deg] [default: that of a picture's EXIF, else 60]
    #[arg(long, value_name = "DEG", conflicts_with = "focal",
        value_parser = within(1.0_f32, 170.0))]
    pub fov: Option<f32>,
    /// Calibration of camera and lens, as OpenCV writes it (YAML or JSON)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["focal", "fov"])]
    pub calibration: Option<PathBuf>,
    /// The calibration is one of OpenCV's fisheye, and does not say so
    #[arg(long, requires = "calibration")]
    pub fisheye: bool,
    /// Narrowest face searched for [px] [default: 40]
    #[arg(long, value_name = "PX", value_parser = whole(24, 4096))]
    pub min_face: Option<u32>,
    /// Work per frame while searching: 2600 is a tracking step, 700 a tile [default: 3600 for
    /// cameras, else the whole frame]
    #[arg(long, value_name = "N", value_parser = whole(100, 10_000_000))]
    pub scan_budget: Option<u32>,
    /// Look at the eyes: lids, iris, gaze, glasses
    #[arg(long)]
    pub gaze: bool,
    /// The same, less part of the mean gaze, for who looks straight ahead most of the time, as
    /// drivers do; `track --monitor` does too
    #[arg(long)]
    pub natural_gaze: bool,
    /// Write the smoothed values (One-Euro filter)
    #[arg(long)]
    pub smooth: bool,
    /// Its cutoff for a face that does not move [Hz] [default: 1]
    #[arg(long, value_name = "HZ", requires = "smooth", value_parser = within(0.01_f32, 100.0))]
    pub smooth_cutoff: Option<f32>,
    /// How much the cutoff rises with speed [default: 12]
    #[arg(long, value_name = "N", requires = "smooth", value_parser = within(0.0_f32, 1000.0))]
    pub smooth_beta: Option<f32>,
}

/// How the frames of INPUT are to be read.
#[derive(Args)]
pub struct FrameArgs {
    /// Turn the frames clockwise to make them upright [deg]
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = ["0", "90", "180", "270"])]
    pub rotate: String,
    /// The frames are mirrored left to right (a selfie preview)
    #[arg(long)]
    pub mirror: bool,
    /// Search for faces only where they are centred in this rectangle of the upright frame [px]
    /// [default: the whole frame]
    #[arg(long, value_name = "X,Y,W,H", value_parser = roi, allow_hyphen_values = true)]
    pub roi: Option<Roi>,
    /// Frame rate of a folder or glob of pictures
    #[arg(long, value_name = "N", default_value_t = 30.0, value_parser = rate)]
    pub fps: f64,
}

impl FrameArgs {
    /// What makes the frames upright.
    pub fn rotation(&self) -> Rotation {
        match self.rotate.as_str() {
            "90" => Rotation::Cw90,
            "180" => Rotation::Half,
            "270" => Rotation::Cw270,
            _ => Rotation::None,
        }
    }

    /// Refuses what does not go together with the tracker's settings.
    pub fn check(&self, tracker: &TrackerArgs) -> Result<()> {
        if tracker.calibration.is_some() && (self.rotate != "0" || self.mirror) {
            bail!("--calibration is for upright frames, not for --rotate or --mirror");
        }
        Ok(())
    }
}

#[derive(Args)]
pub struct TrackArgs {
    /// A video file, a folder or glob of pictures, `-` for y4m on standard input, /dev/videoN, or
    /// an address (rtsp, rtsps, http, https)
    #[arg(allow_hyphen_values = true)]
    pub input: String,
    /// Write one row per frame (OpenFace 2's columns first); `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write one JSON object per frame; `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub jsonl: Option<PathBuf>,
    /// Draw the result: a video (.mp4 and others through ffmpeg, .y4m) or a folder for PNGs
    #[arg(long, value_name = "FILE")]
    pub overlay: Option<PathBuf>,
    /// What the overlay shows, separated by commas
    #[arg(
        long,
        value_name = "STYLES",
        value_enum,
        value_delimiter = ',',
        default_value = "points,mesh,axes,box"
    )]
    pub overlay_style: Vec<Style>,
    /// Plot angles and confidence over time (.svg or .png)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write the person's head, animated, as binary glTF 2.0: morph targets under ARKit's names,
    /// their weights and the head's motion as keyframes
    #[arg(long, value_name = "FILE")]
    pub gltf: Option<PathBuf>,
    /// Write the head of one frame as Wavefront OBJ
    #[arg(long, value_name = "FILE")]
    pub obj: Option<PathBuf>,
    /// The frame, from 1 [default: the last one that is tracked]
    #[arg(long, value_name = "N", requires = "obj",
        value_parser = clap::value_parser!(u64).range(1..))]
    pub obj_frame: Option<u64>,
    /// Write what happens to the face (acquired, coasting, lost and why), one event a line; without
    /// FILE to standard error
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub log: Option<Option<PathBuf>>,
    /// Send head rotation and blendshapes over OSC, as the Virtual Motion Capture protocol has them
    /// (VSeeFace, VMagicMirror and others)
    #[arg(long, value_name = "HOST:PORT", value_parser = host_port)]
    pub osc: Option<String>,
    /// Send the head pose to opentrack's input "UDP over network"
    #[arg(long, value_name = "HOST:PORT", value_parser = host_port)]
    pub udp_opentrack: Option<String>,
    /// Change the weights for an avatar as this file says, JSON: those of --osc, which then sends
    /// ARKit's 52 shapes, and of --gltf; CSV and JSON lines have them too, beside those as tracked
    #[arg(long, value_name = "FILE")]
    pub retarget: Option<PathBuf>,
    /// Watch a driver: write blinks, microsleeps, yawns, glances and others, one event a line, to
    /// FILE or to standard error; adds columns to the CSV and panels to the plot
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true,
        conflicts_with = "smooth")]
    pub monitor: Option<Option<PathBuf>>,
    #[command(flatten)]
    pub monitor_settings: MonitorArgs,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    #[command(flatten)]
    pub frame: FrameArgs,
    /// Track up to this many faces; with more than one, a row is written for each face that is
    /// tracked or coasted, and none for a frame without any
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = clap::builder::RangedU64ValueParser::<usize>::new()
            .range(1..=MAX_GROUP as u64))]
    pub faces: usize,
    /// Stop after this many frames [default: all]
    #[arg(long, value_name = "N")]
    pub frames: Option<u64>,
    /// No progress bar, no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Settings of the driver monitor.
#[derive(Args, Clone)]
pub struct MonitorArgs {
    /// The rule whose times and thresholds the monitor takes: general, euro-ncap, eu-addw-fast,
    /// eu-addw-slow, eu-ddaw
    #[arg(long, value_name = "NAME", default_value = "general", value_parser = preset,
        requires = "monitor")]
    pub monitor_preset: Preset,
    /// Zones of the monitor, as JSON; without it those of the preset
    #[arg(long, value_name = "FILE", requires = "monitor")]
    pub monitor_zones: Option<PathBuf>,
    /// What zones are met by: gaze (where it is known) or head
    #[arg(long, value_name = "NAME", default_value = "gaze", value_parser = zones_by,
        requires = "monitor")]
    pub monitor_zones_by: ZonesBy,
    /// Where the driver sits: learnt, any (every face is the driver's), or the point midway between
    /// the eyes, X,Y,Z in mm in the camera frame. A face elsewhere is given up, and the driver's is
    /// searched for around the place
    #[arg(long, value_name = "PLACE", default_value = "learnt", value_parser = place,
        allow_hyphen_values = true, requires = "monitor")]
    pub monitor_place: DriverPlace,
}

#[derive(Args)]
pub struct ViewArgs {
    /// /dev/videoN, or any other INPUT of `track`; files begin again at their end
    #[arg(allow_hyphen_values = true, default_value = "/dev/video0")]
    pub input: String,
    /// Where to listen. Other machines reach only another address than the default; pictures are
    /// not encrypted
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8041")]
    pub bind: SocketAddr,
    /// Answer under this host name too, as behind a proxy; repeat for several [default: addresses
    /// and localhost only]
    #[arg(long, value_name = "NAME")]
    pub host: Vec<String>,
    /// Widest picture that is sent [px]
    #[arg(long, value_name = "PX", default_value_t = 640,
        value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub width: u32,
    /// End at the end of a file
    #[arg(long)]
    pub once: bool,
    /// Watch a driver: the page shows eyes, PERCLOS, zones and events
    #[arg(long, conflicts_with = "smooth")]
    pub monitor: bool,
    #[command(flatten)]
    pub monitor_settings: MonitorArgs,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    #[command(flatten)]
    pub frame: FrameArgs,
}

#[derive(Args)]
pub struct IndexArgs {
    /// A folder, whose videos and those of its subfolders are tracked, or a text file with the path
    /// of a video on each line
    #[arg(value_name = "DIR|LIST")]
    pub input: PathBuf,
    /// Folder of the tables and of manifest.jsonl. What is there of the same video, model and
    /// settings is kept
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Videos that are tracked at the same time; 0 for as many as there are cores
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    #[command(flatten)]
    pub frame: FrameArgs,
    /// No progress bar, no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// A part of the overlay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Style {
    /// The landmarks, coloured by their confidence
    Points,
    /// Triangles between the landmarks
    Mesh,
    /// The axes of the head
    Axes,
    /// The box of the landmarks
    Box,
}

#[derive(Args)]
pub struct DemoArgs {
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
}

#[derive(Subcommand)]
pub enum ModelCommand {
    /// Print header, sections and data sheet of a model
    Info {
        /// A .posewise file
        file: PathBuf,
    },
}

#[cfg(test)]
#[path = "../../../tests/common/help.rs"]
mod help;

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use posewise::Config;

    #[test]
    fn help_shows_every_default() {
        Cli::command().debug_assert();
        help::check(&Cli::command());
    }

    /// The ranges of the options are those of the core.
    #[test]
    fn options_accept_what_the_core_accepts() {
        let accepted = |option: &str, value: &str| {
            let args = ["posewise", "track", "-", "--smooth", option, value];
            Cli::try_parse_from(args).is_ok()
        };
        let config = |change: fn(&mut Config, f32), value: f32| {
            let mut config = Config::default();
            change(&mut config, value);
            config.check().is_ok()
        };
        type Change = fn(&mut Config, f32);
        let options: [(&str, Change, &[f32]); 4] = [
            (
                "--min-face",
                |c, v| c.min_face_px = v as u32,
                &[23., 24., 4096., 4097.],
            ),
            (
                "--scan-budget",
                |c, v| c.scan_budget = v as u32,
                &[99., 100., 1e7, 10_000_001.],
            ),
            (
                "--smooth-cutoff",
                |c, v| c.smoothing.cutoff_hz = v,
                &[0.0, 0.01, 100., 101.],
            ),
            (
                "--smooth-beta",
                |c, v| c.smoothing.beta = v,
                &[0.0, 1000., 1001., f32::NAN],
            ),
        ];
        for (option, change, values) in options {
            for value in values {
                let text = value.to_string();
                assert_eq!(
                    accepted(option, &text),
                    config(change, *value),
                    "{option} {text}"
                );
            }
        }
    }
}
