//! `posewise-lab render-u3pt`: a stand-in for U3PT, the thesis' own data set, which is not public.
//! Ten subjects, five videos each, rendered with exact truth from a seed.
//!
//! Videos lie in a folder by what they show, `yaw/subject-01.y4m.gz` beside
//! `yaw/subject-01.csv`, so that `posewise-lab protocol subsets` prints a row for each.

use super::Material;
use super::clip::Studio;
use super::covers::Cover;
use super::plan::{Hair, Kind, SEED, SIZE, Sweep, VIEWS_DEG, Video};
use anyhow::{Result, ensure};
use posewise_train::head::Head;
use rayon::prelude::*;
use std::path::PathBuf;

/// First of the streams of the seed, behind those of sweeps and crossings.
const FIRST_STREAM: u64 = 1_000_000;
/// Streams that a subject may use: its person and its videos.
const STREAMS: u64 = 16;
/// Frames per second.
const FPS: usize = 25;

/// Settings of `posewise-lab render-u3pt`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub material: Material,
    /// Where the folders of videos (.y4m.gz), truths (.csv) and descriptions (.json) go. A video
    /// whose description is there and agrees is not rendered again.
    #[arg(long)]
    pub out: PathBuf,
    /// Render only videos whose names begin with one of these, as `yaw`; repeat for several.
    #[arg(long)]
    pub only: Vec<String>,
    /// Number of subjects.
    #[arg(long, default_value_t = 10)]
    pub subjects: usize,
    /// Frames of each video, at 25 per second.
    #[arg(long, default_value_t = 150)]
    pub frames: usize,
    /// Width of the frames, 4 : 3 \[px\].
    #[arg(long, default_value_t = SIZE[0])]
    pub width: usize,
}

/// Hair that leaves room for what covers a face.
const HAIRS: [Hair; 3] = [Hair::Short, Hair::Bald, Hair::Big];
/// What covers the faces of the subjects, in turn.
const COVERS: [Cover; 8] = [
    Cover::HandOnMouth,
    Cover::HairLeft,
    Cover::PhoneOnEyes,
    Cover::Scarf,
    Cover::HandOnEyes,
    Cover::Mask,
    Cover::PhoneOnMouth,
    Cover::HairRight,
];

/// The videos of one subject, with the folders that they lie in.
fn videos(subject: usize) -> [(&'static str, Video); 5] {
    [
        ("yaw", Video::Yaw),
        ("pitch", Video::Pitch),
        ("roll", Video::Roll),
        (
            "expression",
            Video::Expression(COVERS[subject % COVERS.len()]),
        ),
        ("free", Video::Free),
    ]
}

/// The videos that are wanted.
pub fn plan(args: &Args) -> Vec<Sweep> {
    let seed = SEED ^ args.material.seed;
    let of_subject = |subject: usize| {
        let first = FIRST_STREAM + STREAMS * subject as u64;
        videos(subject)
            .into_iter()
            .zip(1..)
            .map(move |((folder, video), k)| Sweep {
                name: format!("{folder}/subject-{:02}", subject + 1),
                kind: Kind::Subject(video),
                hair: HAIRS[subject % HAIRS.len()],
                view_deg: VIEWS_DEG[subject % VIEWS_DEG.len()],
                seed: (seed, first + k),
                person: Some((seed, first)),
                size: [args.width, args.width * SIZE[1] / SIZE[0]],
                frames: args.frames,
                fps: FPS,
            })
    };
    let wanted = |video: &Sweep| {
        let begins = |name: &String| video.name.starts_with(name.as_str());
        args.only.is_empty() || args.only.iter().any(begins)
    };
    let all = (0..args.subjects).flat_map(of_subject);
    all.filter(wanted).collect()
}

/// Renders the videos that are not there yet.
pub fn run(args: &Args) -> Result<()> {
    render(args).map(drop)
}

/// The same; says where all are.
pub fn render(args: &Args) -> Result<Vec<PathBuf>> {
    ensure!(args.width >= 64, "a width of at least 64 px");
    let kit = Head::load(&args.material.facekit)?;
    let studio = Studio::new(&kit, None, args.material.pictures()?)?;
    let each = plan(args).into_par_iter().map(|video| {
        studio.render(&video, &args.out)?;
        Ok(args.out.join(format!("{}.y4m.gz", video.name)))
    });
    each.collect()
}
