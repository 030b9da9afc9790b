//! The search: faces that appear, move fast, are lost or were never there.

use anyhow::Result;
use serde_json::{Value, json};

use super::super::programs::Table;
use super::bench::{Bench, PRESENT, WEBCAMS, text};

/// Steps between the frames of the fast clip that are shown as if they were consecutive.
const STRIDES: [usize; 5] = [1, 2, 3, 5, 8];
/// Where each search for a face that was never seen begins \[s\], and how many frames it may take.
const STARTS: [&str; 4] = ["0", "2", "4", "6"];
const FIRST_FRAMES: &str = "90";
/// Filters of ffmpeg through which the clip that the head leaves is shown.
const FILTERS: [&str; 16] = [
    "null",
    "hflip",
    "scale=480:360",
    "scale=576:432",
    "scale=704:528",
    "crop=600:480:0:0",
    "crop=600:480:40:0",
    "rotate=8*PI/180:fillcolor=gray",
    "rotate=-8*PI/180:fillcolor=gray",
    "eq=brightness=-0.2",
    "eq=brightness=0.2",
    "eq=contrast=0.6",
    "eq=gamma=0.6",
    "eq=gamma=1.6",
    "gblur=2",
    "noise=alls=30:allf=t",
];
/// Work per frame with a camera, the library's default.
const CAMERA: [&str; 2] = ["--scan-budget", "3600"];

pub fn fast_motion(bench: &Bench) -> Result<Value> {
    let clip = bench.clip("05_fast")?;
    let one = |every: &usize| {
        let filter = format!("select='not(mod(n,{every}))',setpts=N/FRAME_RATE/TB");
        let ffmpeg = ["-vf", &filter, "-r", "30", "-pix_fmt", "yuv420p"];
        let table = bench
            .programs
            .track_filtered(&clip.video, &ffmpeg, &CAMERA)?;
        let (frames, tracked) = table.tracked()?;
        Ok(json!({"every": every, "frames": frames, "tracked": tracked}))
    };
    STRIDES.iter().map(one).collect()
}

/// Frames until a face is tracked that was never seen, with a camera's work per frame.
pub fn first_lock(bench: &Bench) -> Result<Value> {
    let webcams = WEBCAMS.map(|name| bench.at(&format!("clips/{name}.mp4")));
    let mut until = vec![];
    for video in bench.clips.iter().map(|clip| &clip.video).chain(&webcams) {
        for start in STARTS {
            let ffmpeg = [
                "-ss",
                start,
                "-frames:v",
                FIRST_FRAMES,
                "-pix_fmt",
                "yuv420p",
            ];
            let table = bench.programs.track_filtered(video, &ffmpeg, &CAMERA)?;
            let first = table.column("success")?.iter().position(|s| *s > 0.5);
            until.push(first.map_or(usize::MAX, |frames| frames + 1));
        }
    }
    until.sort_unstable();
    let found: Vec<_> = until.iter().filter(|u| **u < usize::MAX).collect();
    Ok(json!({"searches": until.len(), "found": found.len(),
        "median_frames": until[until.len() / 2], "worst_frames": found.last()}))
}

pub fn lost_and_found(bench: &Bench) -> Result<Value> {
    let backgrounds = text(&bench.at("backgrounds"));
    let clips = WEBCAMS.map(|name| text(&bench.at(&format!("clips/{name}.mp4"))));
    let args = [
        "eval",
        "recovery",
        "--backgrounds",
        &backgrounds,
        "--clip",
        &clips[0],
        "--clip",
        &clips[1],
    ];
    let mut recovery = bench.programs.json("posewise-lab", &args, true)?;
    for row in recovery
        .as_object_mut()
        .into_iter()
        .flat_map(|map| map.values_mut())
    {
        if let Value::Object(row) = row {
            row.remove("pieces");
        }
    }
    let cases: [&[&str]; 5] = [
        &[],
        &["--gain", "0.15", "--noise", "3"],
        &["--noise", "25"],
        &["--after", &clips[0]],
        &["--after", &clips[1]],
    ];
    let mut faceless = vec![];
    for options in cases {
        let mut args = vec!["eval", "faceless", "--backgrounds", &backgrounds];
        args.extend(CAMERA.iter().chain(options));
        let shown: Vec<_> = options
            .iter()
            .map(|o| o.rsplit('/').next().unwrap_or_default())
            .collect();
        let result = bench.programs.json("posewise-lab", &args, true)?;
        faceless.push(json!({"options": shown.join(" "), "result": result}));
    }
    Ok(json!({"recovery": recovery, "faceless": faceless, "departure": departure(bench)?}))
}

/// The clip that the head leaves for some seconds, filtered in several ways: frames tracked while
/// nobody is there, and while somebody is.
pub fn departure(bench: &Bench) -> Result<Value> {
    let clip = bench.clip("07_leave")?;
    let in_frame = Table::read(&clip.truth)?.column("in_frame")?;
    let one = |filter: &&str| {
        let ffmpeg = ["-vf", filter, "-pix_fmt", "gray"];
        let success = bench
            .programs
            .track_filtered(&clip.video, &ffmpeg, &[])?
            .column("success")?;
        let count = |is: &dyn Fn(f64) -> bool| {
            let rows = in_frame
                .iter()
                .zip(&success)
                .filter(|(share, _)| is(**share));
            rows.fold((0, 0), |(all, tracked), (_, s)| {
                (all + 1, tracked + usize::from(*s > 0.5))
            })
        };
        let (absent, present) = (
            count(&|share| share == 0.0),
            count(&|share| share >= PRESENT),
        );
        Ok(
            json!({"filter": filter, "absent_frames": absent.0, "absent_tracked": absent.1,
            "present_frames": present.0, "present_tracked": present.1}),
        )
    };
    FILTERS.iter().map(one).collect()
}
