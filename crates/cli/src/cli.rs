//! The command line's grammar. Every option stands here, which makes this file longer than others.

use std::net::SocketAddr;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, Parser, Subcommand, ValueEnum};
use posewise::image::Rotation;
use posewise::network::KernelName;
use posewise::{Config, MAX_EXCLUDED, Preset, Roi};

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
    /// Measure accuracy against labelled data
    #[command(subcommand)]
    Eval(EvalCommand),
    /// Measure time, memory and stack of a step
    Bench(BenchArgs),
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

/// Most frames per second: timestamps are whole microseconds.
pub const MAX_FPS: f64 = 1e6;

/// Most faces of `track --faces`: each tracker excludes all others.
const MAX_FACES: usize = MAX_EXCLUDED + 1;

/// Settings of the tracker and the camera.
#[derive(Args, Clone, Default)]
pub struct TrackerArgs {
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Focal length [px] [default: that of a picture's EXIF, else of 60° across]
    #[arg(long, value_name = "PX", value_parser = single(1.0, 1e6))]
    pub focal: Option<f32>,
    /// Horizontal field of view [deg] [default: that of a picture's EXIF, else 60]
    #[arg(long, value_name = "DEG", conflicts_with = "focal", value_parser = single(1.0, 170.0))]
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
    /// Work per frame while searching: 3000 is about a tracking step, 600 a tile [default: 3600 for
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
    #[arg(long, value_name = "HZ", requires = "smooth", value_parser = single(0.01, 100.0))]
    pub smooth_cutoff: Option<f32>,
    /// How much the cutoff rises with speed [default: 12]
    #[arg(long, value_name = "N", requires = "smooth", value_parser = single(0.0, 1000.0))]
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
    /// Write what happens to the face (acquired, coasting, lost and why), one event a line; without
    /// FILE to standard error
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub log: Option<Option<PathBuf>>,
    /// Send head rotation and blendshapes over OSC, as the Virtual Motion Capture protocol has them
    /// (VSeeFace, Warudo, VNyan and others)
    #[arg(long, value_name = "HOST:PORT", value_parser = host_port)]
    pub osc: Option<String>,
    /// Send the head pose to opentrack's input "UDP over network"
    #[arg(long, value_name = "HOST:PORT", value_parser = host_port)]
    pub udp_opentrack: Option<String>,
    /// Watch a driver: write blinks, microsleeps, yawns, glances and others, one event a line, to
    /// FILE or to standard error; adds columns to the CSV and panels to the plot
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true,
        conflicts_with = "smooth")]
    pub monitor: Option<Option<PathBuf>>,
    /// The rule whose times and thresholds the monitor takes: general, euro-ncap, eu-addw-fast,
    /// eu-addw-slow, eu-ddaw
    #[arg(long, value_name = "NAME", default_value = "general", value_parser = preset,
        requires = "monitor")]
    pub monitor_preset: Preset,
    /// Zones of the monitor, as JSON; without it those of the preset
    #[arg(long, value_name = "FILE", requires = "monitor")]
    pub monitor_zones: Option<PathBuf>,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    #[command(flatten)]
    pub frame: FrameArgs,
    /// Track up to this many faces; with more than one, a row is written for each face that is
    /// tracked or coasted, and none for a frame without any
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = clap::builder::RangedU64ValueParser::<usize>::new()
            .range(1..=MAX_FACES as u64))]
    pub faces: usize,
    /// Stop after this many frames [default: all]
    #[arg(long, value_name = "N")]
    pub frames: Option<u64>,
    /// No progress bar, no summary
    #[arg(long, short)]
    pub quiet: bool,
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
pub enum EvalCommand {
    /// 68 landmarks on labelled stills
    Landmarks(LandmarksArgs),
    /// Marked landmarks and yaw on stills of profiles
    Profiles(ProfilesArgs),
    /// Yaw and pitch on stills with labelled angles
    Angles(AnglesArgs),
    /// Head pose and landmarks against per-frame truth
    Pose(ClipsArgs),
    /// Whether the standard deviations of a pose are true, against per-frame truth
    Deviations(DeviationsArgs),
    /// Eye openness and closures against per-frame truth
    Eyes(ClipsArgs),
    /// Events and measures of the driver monitor against per-frame truth
    Monitor(MonitorArgs),
    /// Jitter of the landmarks of a tracked clip
    Jitter(JitterArgs),
    /// Frames until a face that disappeared is tracked again elsewhere
    Recovery(RecoveryArgs),
    /// Frames until a small face anywhere in a photograph is tracked
    Latency(LatencyArgs),
    /// Frames tracked in pictures without people
    Faceless(FacelessArgs),
    /// Angle errors over many minutes
    Drift(DriftArgs),
}

/// Where the first fit starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Start {
    /// The tracker's own detector finds the face
    Detector,
    /// The labelled box is given
    Box,
}

/// Parses a number from `least` to `most`.
fn within(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match text.parse() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("not a number from {least} to {most}")),
    }
}

/// Parses width and height of a frame, as `640x480`.
fn frame_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').map(|(w, h)| (w.parse(), h.parse()));
    match sides {
        Some((Ok(w @ 16..=16_384), Ok(h @ 16..=16_384))) => Ok((w, h)),
        _ => Err("not a size of 16 to 16384 px, as 640x480".into()),
    }
}

/// As [`within`], in single precision.
fn single(least: f32, most: f32) -> impl Fn(&str) -> Result<f32, String> + Clone {
    move |text| match text.parse() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("not a number from {least} to {most}")),
    }
}

/// Parses a whole number from `least` to `most`.
fn whole(least: u32, most: u32) -> impl Fn(&str) -> Result<u32, String> + Clone {
    move |text| match text.parse() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("not a whole number from {least} to {most}")),
    }
}

/// Parses a frame rate: timestamps are whole microseconds, and each is after the last one.
fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(fps) if fps > 0.0 && fps <= MAX_FPS => Ok(fps),
        _ => Err(format!("not a number above 0, up to {MAX_FPS}")),
    }
}

/// Checks the form of a host and a port; the host is looked up later.
fn host_port(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse().is_ok_and(|n: u16| n > 0) => {
            Ok(text.to_string())
        }
        _ => Err("not HOST:PORT with a port from 1 to 65535".into()),
    }
}

/// Parses the name of a preset.
fn preset(text: &str) -> Result<Preset, String> {
    let known = Preset::ALL.into_iter().find(|preset| preset.name() == text);
    known.ok_or_else(|| {
        let names = Preset::ALL.map(Preset::name);
        format!("not one of {}", names.join(", "))
    })
}

/// Parses a region of interest.
fn roi(text: &str) -> Result<Roi, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let Ok([x, y, width, height]) = numbers.as_deref() else {
        return Err("not four whole numbers X,Y,W,H [px]".into());
    };
    let roi = Roi::new(*x, *y, *width, *height);
    match Config::default().with_roi(roi).check() {
        Ok(()) => Ok(roi),
        Err(error) => Err(error.to_string()),
    }
}

/// Defects of a poor camera, applied to the pictures in this order.
#[derive(Args, Clone, Copy)]
pub struct CameraArgs {
    /// Blur the pictures: sigma of a Gaussian [px]
    #[arg(long, value_name = "PX", default_value_t = 0.0,
        value_parser = within(0.0, 100.0))]
    pub blur: f64,
    /// Leave this share of their contrast, as haze does
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = within(0.0, 1.0))]
    pub contrast: f64,
    /// Multiply their grey levels: 0.15 is a dim room
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = within(0.0, 100.0))]
    pub gain: f64,
    /// Add noise of this deviation [grey levels]
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0,
        value_parser = within(0.0, 255.0))]
    pub noise: f64,
}

/// How each picture is shown to a new tracker.
#[derive(Args)]
pub struct StillsArgs {
    /// Model file [default: the embedded model]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Narrowest face searched for [px]
    #[arg(long, value_name = "PX", default_value_t = 30)]
    pub min_face: u32,
    /// Steps on the same picture after the one that found the face
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub steps: u32,
    /// Threads; 0 for all cores
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
}

#[derive(Args)]
pub struct LandmarksArgs {
    /// Labels: image,x0,y0,…,x67,y67 [px], iBUG 68 order
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    #[command(flatten)]
    pub camera: CameraArgs,
    /// Turn the pictures clockwise [deg]; what they do not show repeats their edges
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_negative_numbers = true,
        value_parser = within(-180.0, 180.0))]
    pub roll: f64,
    /// Cut off this share of the landmarks' box at the left, right, upper and lower edge in turn
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = within(0.0, 0.9))]
    pub cut: f64,
    /// Where the first fit starts
    #[arg(long, value_enum, default_value = "detector")]
    pub start: Start,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture: found, errors, yaw band, mean shift from the labels
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    /// Plot the cumulative error distribution up to 10 % (.svg or .png)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    #[command(flatten)]
    pub stills: StillsArgs,
}

#[derive(Args)]
pub struct ProfilesArgs {
    /// Labels: image,kind,half,yaw_geometric_deg,x0,y0,…,x67,y67; landmarks that are not marked are
    /// empty
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture: found, errors, yaw
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    #[command(flatten)]
    pub stills: StillsArgs,
}

#[derive(Args)]
pub struct AnglesArgs {
    /// Labels: image,pitch_deg,yaw_deg; with a column identity the people are counted
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    /// In the labels, yaw > 0 turns the face to the image left
    #[arg(long)]
    pub yaw_left: bool,
    /// Focal length [px] [default: unknown; a field of view of 60° is assumed]
    #[arg(long, value_name = "PX", value_parser = single(1.0, 1e6))]
    pub focal: Option<f32>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture: found, angles
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    #[command(flatten)]
    pub stills: StillsArgs,
}

#[derive(Args)]
pub struct ClipsArgs {
    /// Per-frame truth; repeat for several clips
    #[arg(long, value_name = "FILE", required = true)]
    pub truth: Vec<PathBuf>,
    /// What `posewise track --csv` wrote for the clip; as many as there are truths, in their order
    #[arg(long, value_name = "FILE", required = true)]
    pub csv: Vec<PathBuf>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
pub struct DeviationsArgs {
    #[command(flatten)]
    pub clips: ClipsArgs,
    /// Print the constants of src/shape/deviation.rs that suit these clips, whose focal length was
    /// given
    #[arg(long)]
    pub fit: bool,
}

#[derive(Args)]
pub struct MonitorArgs {
    #[command(flatten)]
    pub clips: ClipsArgs,
    /// The rule whose times and thresholds the monitor takes
    #[arg(long, value_name = "NAME", default_value = "general", value_parser = preset)]
    pub preset: Preset,
    /// Zones of the monitor, as for `track --monitor-zones`
    #[arg(long, value_name = "FILE")]
    pub zones: Option<PathBuf>,
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

#[derive(Args)]
pub struct JitterArgs {
    /// What `posewise track --csv` wrote; repeat for several clips
    #[arg(long, value_name = "FILE", required = true)]
    pub csv: Vec<PathBuf>,
    /// The clip that was tracked, any INPUT of `track`: also measures how the picture itself moves;
    /// repeat in the same order
    #[arg(long, value_name = "FILE")]
    pub clip: Vec<String>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Pictures without people.
#[derive(Args)]
pub struct BackgroundsArgs {
    /// Folder of pictures; those that its file with-people.txt names are left out
    #[arg(long, value_name = "DIR")]
    pub backgrounds: PathBuf,
    /// Take one picture in N, in the order of their names; 1 for all. Training leaves out one
    /// of five
    #[arg(long, value_name = "N", default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// Which one of them, from 0 [default: the last, which training leaves out]
    #[arg(long, value_name = "K")]
    pub offset: Option<u32>,
}

#[derive(Args)]
pub struct RecoveryArgs {
    /// A clip (any INPUT of `track`) with one face in every frame; repeat for several
    #[arg(long, value_name = "FILE", required = true)]
    pub clip: Vec<String>,
    #[command(flatten)]
    pub backgrounds: BackgroundsArgs,
    /// Times that the face of each clip comes back
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub pieces: usize,
    /// Frames of a piece
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub length: usize,
    /// Only the pieces as they are, no mirrored ones
    #[arg(long)]
    pub no_mirror: bool,
    /// Draws pieces, places and pictures
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
pub struct LatencyArgs {
    /// Labels of pictures with one face, as for `eval landmarks`
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    #[command(flatten)]
    pub backgrounds: BackgroundsArgs,
    /// Size of the frames [px]; repeat for several [default: 640x480 1280x720 3840x2160]
    #[arg(long, value_name = "WxH", value_parser = frame_size)]
    pub frame: Vec<(u32, u32)>,
    /// Longer side of the box of the landmarks [px]
    #[arg(long, value_name = "PX", default_value_t = 60.0, value_parser = within(16.0, 1000.0))]
    pub face: f64,
    /// Faces in frames of each size
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub faces: usize,
    /// Most frames that are shown of each
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub frames: usize,
    /// Draws faces, places and pictures
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
pub struct FacelessArgs {
    #[command(flatten)]
    pub backgrounds: BackgroundsArgs,
    /// Show 60 frames of this clip with a face before each picture
    #[arg(long, value_name = "CLIP")]
    pub after: Option<String>,
    #[command(flatten)]
    pub camera: CameraArgs,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
pub struct DriftArgs {
    /// The clip (any INPUT of `track`)
    #[arg(long, value_name = "FILE")]
    pub clip: String,
    /// Its per-frame truth, as for `eval pose`; its column fx is the default of --focal
    #[arg(long, value_name = "FILE")]
    pub truth: PathBuf,
    /// How long the clip is shown back and forth
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub minutes: f64,
    #[command(flatten)]
    pub tracker: TrackerArgs,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Args)]
pub struct BenchArgs {
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

/// A kernel that this machine runs.
fn kernel(name: &str) -> Result<KernelName, String> {
    let available = || KernelName::ALL.into_iter().filter(|k| k.is_available());
    available().find(|k| k.name() == name).ok_or_else(|| {
        let names: Vec<&str> = available().map(KernelName::name).collect();
        format!("this machine runs {}", names.join(", "))
    })
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
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// Options whose absence means that nothing is read, written or sent.
    const FILES: [&str; 5] = ["FILE", "CLIP", "DIR", "INPUT", "HOST:PORT"];

    fn check(command: &clap::Command) {
        command.get_subcommands().for_each(check);
        for option in command.get_opts() {
            let names = option.get_value_names().unwrap_or_default();
            let is_file = names.iter().any(|name| FILES.contains(&name.as_str()));
            let help = option
                .get_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            let shows = !option.get_default_values().is_empty() || help.contains("[default: ");
            let takes_value = option.get_action().takes_values();
            assert!(
                !takes_value || is_file || shows || option.is_required_set(),
                "{} --{}: {help}",
                command.get_name(),
                option.get_id()
            );
        }
    }

    #[test]
    fn help_shows_every_default() {
        Cli::command().debug_assert();
        check(&Cli::command());
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
