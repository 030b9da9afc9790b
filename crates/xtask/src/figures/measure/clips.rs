//! Clips: pose, eyes, jitter, drift.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::super::programs::{Table, succeed};
use super::bench::{Bench, Clip, PRESENT, WEBCAMS, text, words};

/// Step between the frames of the rendered clips that are searched by themselves.
const STILL: usize = 5;
/// Upper ends of the bands of true |yaw| of these stills \[deg\].
const BANDS: [f64; 5] = [15.0, 45.0, 60.0, 75.0, 91.0];

/// The clips of a folder, each with its truth beside it.
pub fn rendered_clips(folder: &Path, extension: &str, scratch: &Path) -> Result<Vec<Clip>> {
    let mut clips = vec![];
    for entry in std::fs::read_dir(folder).with_context(|| text(folder))? {
        let truth = entry?.path();
        if truth.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        let name = truth
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let focal = Table::read(&truth)?.column("fx")?;
        let focal = focal.first().with_context(|| text(&truth))?;
        clips.push(Clip {
            video: truth.with_extension(extension),
            focal: focal.to_string(),
            csv: scratch.join(format!("{name}.csv")),
            truth,
            name,
        });
    }
    clips.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(clips)
}

pub fn rendered(bench: &Bench) -> Result<Value> {
    let mut pairs: Vec<(&Path, &Path)> = vec![];
    for clip in &bench.clips {
        bench
            .programs
            .track(&clip.video, &["--focal", &clip.focal], &clip.csv)?;
        pairs.push((&clip.truth, &clip.csv));
    }
    Ok(json!({"pose": bench.compare("pose", &pairs)?, "eyes": bench.compare("eyes", &pairs)?}))
}

pub fn smoothed(bench: &Bench) -> Result<Value> {
    let one = |start: &&str| {
        let clip = bench.clip(start)?;
        let csv = bench.programs.scratch.join(format!("{start}-smooth.csv"));
        let options = ["--focal", &clip.focal, "--smooth"];
        bench.programs.track(&clip.video, &options, &csv)?;
        let result = bench.compare("pose", &[(&clip.truth, &csv)])?;
        Ok(json!({"clip": clip.name, "result": result}))
    };
    ["04_free", "05_fast"].iter().map(one).collect()
}

/// Each still is a picture for a fresh tracker, which searches the whole frame.
pub fn stills(bench: &Bench) -> Result<Value> {
    let mut counts = BANDS.map(|_| (0, 0));
    for clip in &bench.clips {
        let folder = bench.programs.scratch.join("stills").join(&clip.name);
        std::fs::create_dir_all(&folder)?;
        let select = format!("select='not(mod(n,{STILL}))'");
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg
            .args(["-v", "error", "-y", "-i"])
            .arg(&clip.video)
            .args(["-vf", &select]);
        ffmpeg.args(["-fps_mode", "passthrough", "-pix_fmt", "gray"]);
        succeed(ffmpeg.arg(folder.join("%04d.png")))?;
        let truth = Table::read(&clip.truth)?;
        let (yaw, in_frame) = (truth.column("yaw")?, truth.column("in_frame")?);
        for (index, at) in (0..yaw.len()).step_by(STILL).enumerate() {
            if in_frame[at] < PRESENT {
                continue;
            }
            let still = folder.join(format!("{:04}.png", index + 1));
            let csv = bench.programs.scratch.join("still.csv");
            let table = bench
                .programs
                .track(&still, &["--focal", &clip.focal], &csv)?;
            let band = BANDS.iter().position(|to| yaw[at].abs() <= *to);
            let count = &mut counts[band.unwrap_or(BANDS.len() - 1)];
            count.0 += 1;
            count.1 += table.tracked()?.1;
        }
    }
    let rows = BANDS.iter().zip(counts);
    Ok(rows
        .map(|(to, (all, found))| json!({"to_deg": to, "stills": all, "found": found}))
        .collect())
}

pub fn real_eyes(bench: &Bench) -> Result<Value> {
    let of = |folder: &str, options: &[&str]| {
        let eyes = text(&bench.at(folder));
        let args = [&["eyes", "--eyes", &eyes][..], options].concat();
        bench.programs.json("posewise-train", &args, true)
    };
    let mut eyes = of("eyes", &[])?;
    eyes["near_infrared"] = of("eyes-nir", &["--all"])?["network"].take();
    Ok(eyes)
}

pub fn webcams(bench: &Bench) -> Result<Value> {
    let jitter = |csv: &Path, clip: Option<&Path>| -> Result<Value> {
        let mut args = words(&["eval", "jitter", "--csv"]);
        args.push(text(csv));
        args.extend(clip.iter().flat_map(|clip| ["--clip".into(), text(clip)]));
        Ok(bench.programs.json("posewise-lab", &args, false)?["clips"][0].take())
    };
    let one = |name: &&str| {
        let clip = bench.at(&format!("clips/{name}.mp4"));
        let csv = bench.programs.scratch.join(format!("{name}.csv"));
        let (frames, tracked) = bench.programs.track::<&str>(&clip, &[], &csv)?.tracked()?;
        let raw = jitter(&csv, Some(&clip))?;
        bench.programs.track(&clip, &["--smooth"], &csv)?;
        Ok(
            json!({"clip": name, "frames": frames, "tracked": tracked, "raw": raw,
            "smoothed": jitter(&csv, None)?}),
        )
    };
    WEBCAMS.iter().map(one).collect()
}

pub fn drift(bench: &Bench) -> Result<Value> {
    let clip = bench.clip("04_free")?;
    let (video, truth) = (text(&clip.video), text(&clip.truth));
    let args = ["eval", "drift", "--clip", &video, "--truth", &truth];
    bench.programs.json("posewise-lab", &args, true)
}
