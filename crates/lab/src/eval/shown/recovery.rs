//! `posewise-lab eval recovery`: frames until a face that disappeared is tracked again elsewhere.
//!
//! Each clip is cut into pieces of some frames. Its tracker first gets one piece, which does not
//! count, so that there is a face to lose. Then follow, several times, one second of a picture
//! without people and a piece from another time of the clip, moved by up to a quarter of the width
//! and an eighth of the height, with repeated edges. The person is the same; half of the pieces are
//! mirrored, which changes the identity of an asymmetric face, unless `--no-mirror` is set. A last
//! run resets the tracker before each picture without people: frames until a new face is found.

use std::path::PathBuf;

use anyhow::{Result, bail};
use image::GrayImage;
use image::imageops::flip_horizontal;
use posewise::{Model, State};
use posewise_cli::cli::TrackerArgs;
use posewise_cli::model_file::ModelFile;
use posewise_metrics::median;
use serde_json::{Map, json};

use super::show::Show;
use crate::footage::backgrounds::{self, BackgroundsArgs, covering, window};
use crate::footage::clip::{Clip, moved};
use crate::output;
use crate::random::Random;

/// Options of `posewise-lab eval recovery`.
#[derive(clap::Args)]
pub struct Args {
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

/// Most frames of a clip that are kept in memory.
const MAX_FRAMES: usize = 3000;
/// A piece is moved by up to the frame's width and height over these.
const MOVE: (u32, u32) = (4, 8);
/// Frames per second of a folder of pictures.
const FPS: f64 = 25.0;

/// How the pieces are shown.
struct Mode {
    key: &'static str,
    /// Whether half of them are mirrored.
    mirrored: bool,
    /// Whether the tracker forgets everything before each.
    forgetful: bool,
}

const MODES: [Mode; 3] = [
    Mode {
        key: "half_mirrored",
        mirrored: true,
        forgetful: false,
    },
    Mode {
        key: "not_mirrored",
        mirrored: false,
        forgetful: false,
    },
    Mode {
        key: "first_seen",
        mirrored: false,
        forgetful: true,
    },
];

/// A clip and the order in which it is shown.
struct Cut {
    name: String,
    clip: Clip,
    /// First frame of the piece that comes before all others.
    first: usize,
    pieces: Vec<Piece>,
}

/// What comes back.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    /// First frame, in the clip.
    start: usize,
    /// To the right and down \[px\].
    by: (i32, i32),
    mirrored: bool,
    /// The picture without people that comes before.
    background: PathBuf,
}

/// What the tracker made of it.
#[derive(Clone, Debug)]
struct Outcome {
    /// Frames of the piece until one is tracked, counting that; `None` if none is.
    until: Option<usize>,
    /// Frames of the picture without people, and those tracked.
    faceless: (usize, usize),
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if args.pieces == 0 || args.length == 0 {
        bail!("--pieces and --length must be at least 1");
    }
    let mut pictures = backgrounds::list(&args.backgrounds)?;
    let mut random = Random::of(args.seed);
    random.shuffle(&mut pictures);
    let mut pictures = pictures.iter().cycle().cloned();
    let mut cuts = Vec::new();
    for input in &args.clip {
        let clip = Clip::open(input, FPS, MAX_FRAMES)?;
        cuts.push(cut(input, clip, args, &mut random, &mut pictures)?);
    }
    let file = ModelFile::read(args.tracker.model.as_deref())?;
    let model = file.model()?;
    let modes = MODES
        .iter()
        .filter(|mode| !(args.no_mirror && mode.mirrored));
    let mut value = Map::new();
    for mode in modes {
        let mut rows = Vec::new();
        let mut all = Vec::new();
        for cut in &cuts {
            let outcomes = show(&model, cut, args, mode)?;
            rows.extend(cut.pieces.iter().zip(&outcomes).map(|(piece, o)| {
                json!({"clip": cut.name, "from_frame": piece.start + 1, "moved_px": piece.by,
                    "mirrored": mode.mirrored && piece.mirrored, "frames_until_tracked": o.until})
            }));
            all.extend(outcomes);
        }
        let sum = summarize(&all);
        value.insert(
            mode.key.to_string(),
            json!({"median_frames": sum.median, "worst_frames": sum.worst, "never": sum.never,
                "faceless_frames": sum.faceless.0, "false_tracks": sum.faceless.1,
                "pieces": rows}),
        );
    }
    value.insert("piece_frames".into(), json!(args.length));
    value.insert("seed".into(), json!(args.seed));
    output::show(&value.into(), args.json.as_deref())
}

/// Draws the pieces: no two overlap in the clip, and half of them are mirrored.
fn cut(
    name: &str,
    clip: Clip,
    args: &Args,
    random: &mut Random,
    pictures: &mut impl Iterator<Item = PathBuf>,
) -> Result<Cut> {
    let mut starts: Vec<usize> = (0..clip.frames.len() / args.length)
        .map(|i| i * args.length)
        .collect();
    if starts.len() <= args.pieces {
        bail!(
            "{name} has {} frames: too few for {} pieces of {} and one before them",
            clip.frames.len(),
            args.pieces,
            args.length
        );
    }
    random.shuffle(&mut starts);
    let mut mirrored: Vec<bool> = (0..args.pieces).map(|i| i % 2 == 1).collect();
    random.shuffle(&mut mirrored);
    let (width, height) = clip.frames[0].dimensions();
    let pieces = starts.iter().skip(1).zip(mirrored).zip(pictures);
    let pieces = pieces
        .map(|((start, mirrored), background)| Piece {
            start: *start,
            by: (
                random.within((width / MOVE.0) as i32),
                random.within((height / MOVE.1) as i32),
            ),
            mirrored,
            background,
        })
        .collect();
    Ok(Cut {
        name: name.into(),
        first: starts[0],
        clip,
        pieces,
    })
}

/// Shows a clip's pieces to a fresh tracker that searches as for a camera.
fn show(model: &Model<'_>, cut: &Cut, args: &Args, mode: &Mode) -> Result<Vec<Outcome>> {
    let Clip { frames, fps } = &cut.clip;
    let fresh = || Show::new(model, &args.tracker, true, *fps);
    let mut show = fresh()?;
    for frame in &frames[cut.first..][..args.length] {
        show.frame(frame)?;
    }
    let second = fps.round() as usize;
    let size = frames[0].dimensions();
    let mut outcomes = Vec::new();
    for piece in &cut.pieces {
        if mode.forgetful {
            show = fresh()?;
        }
        let picture = backgrounds::open(&piece.background)?;
        let empty = window(&covering(&picture, size), size, 0.5);
        let mut false_tracks = 0;
        for _ in 0..second {
            false_tracks += usize::from(show.frame(&empty)?.state == State::Tracking);
        }
        let mut until = None;
        for (k, frame) in frames[piece.start..][..args.length].iter().enumerate() {
            let frame = seen(frame, piece, mode.mirrored);
            if show.frame(&frame)?.state == State::Tracking && until.is_none() {
                until = Some(k + 1);
            }
        }
        outcomes.push(Outcome {
            until,
            faceless: (second, false_tracks),
        });
    }
    Ok(outcomes)
}

/// A frame as the piece has it.
fn seen(frame: &GrayImage, piece: &Piece, mirror: bool) -> GrayImage {
    let (right, down) = piece.by;
    match mirror && piece.mirrored {
        true => moved(&flip_horizontal(frame), right, down),
        false => moved(frame, right, down),
    }
}

/// The numbers of one row.
#[derive(Debug, PartialEq)]
struct Sum {
    /// Median of the frames until tracked, a piece never tracked counting as longer than any;
    /// `None` when the median is such a piece.
    median: Option<f64>,
    /// Most frames, of the pieces that were tracked.
    worst: Option<usize>,
    never: usize,
    faceless: (usize, usize),
}

fn summarize(outcomes: &[Outcome]) -> Sum {
    let untils: Vec<f64> = outcomes
        .iter()
        .map(|o| o.until.map_or(f64::INFINITY, |k| k as f64))
        .collect();
    let add = |a: (usize, usize), o: &Outcome| (a.0 + o.faceless.0, a.1 + o.faceless.1);
    Sum {
        median: median(&untils).filter(|m| m.is_finite()),
        worst: outcomes.iter().filter_map(|o| o.until).max(),
        never: outcomes.iter().filter(|o| o.until.is_none()).count(),
        faceless: outcomes.iter().fold((0, 0), add),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(until: Option<usize>) -> Outcome {
        Outcome {
            until,
            faceless: (25, 1),
        }
    }

    #[test]
    fn numbers_by_hand() {
        let sum = summarize(&[4, 2, 9].map(|k| outcome(Some(k))));
        assert_eq!((sum.median, sum.worst, sum.never), (Some(4.0), Some(9), 0));
        assert_eq!(sum.faceless, (75, 3));
        let sum = summarize(&[Some(4), None, Some(2)].map(outcome));
        assert_eq!((sum.median, sum.worst, sum.never), (Some(4.0), Some(4), 1));
        let sum = summarize(&[Some(4), None, None].map(outcome));
        assert_eq!((sum.median, sum.worst, sum.never), (None, Some(4), 2));
    }
}
