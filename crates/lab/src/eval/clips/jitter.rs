//! `posewise-lab eval jitter`: how much the landmarks jitter.
//!
//! Per landmark the r.m.s. of the second difference (frame before, this, next) over all runs of
//! tracked frames, scaled to an inter-ocular distance of 40 px; then the median over landmarks. A
//! second figure is without the motion that all landmarks share (a similarity per second
//! difference): a head moves as a whole, noise moves each landmark by itself. With the clip, a
//! third figure is the jitter of landmarks that move exactly as the picture between brows and nose
//! does: a tracker that does not lag behind the head cannot be below it.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use posewise::math::Similarity;
use posewise_cli::source;
use posewise_metrics::jitter::{Shape, common_motion, landmark_jitter, second_difference};
use posewise_metrics::landmarks::distance;
use serde_json::json;

use super::registration::{Luma, Patch, register};
use crate::{output, tracked};

/// Options of `posewise-lab eval jitter`.
#[derive(clap::Args)]
pub struct Args {
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

/// Inter-ocular distance that figures are scaled to \[px\].
const INTER_OCULAR: f64 = 40.0;
/// Frames per second of a folder of pictures; nothing here depends on it.
const FPS: f64 = 30.0;
/// Brows, nose and eyes: where nothing but the head moves much.
const RIGID: std::ops::Range<usize> = 17..48;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    ensure!(
        args.clip.is_empty() || args.clip.len() == args.csv.len(),
        "--clip once for every --csv, or not at all"
    );
    let mut rows = Vec::new();
    for (index, path) in args.csv.iter().enumerate() {
        let frames = tracked::read(path)?.into_values();
        // `None` where no face is tracked.
        let shapes: Vec<Option<Shape>> = frames.map(|f| Some(f.tracked?.points)).collect();
        let [jitter, rest] = jitter(&shapes);
        let picture = match args.clip.get(index) {
            Some(clip) => of_picture(&shapes, clip)?,
            None => None,
        };
        rows.push(
            json!({"csv": path.display().to_string(), "jitter_px": jitter,
            "rest_px": rest, "picture_px": picture}),
        );
    }
    output::show(&json!({"clips": rows}), args.json.as_deref())
}

/// Three frames in a row, if the face is tracked in them, and what scales them.
fn triple(three: &[Option<Shape>]) -> Option<([&Shape; 3], f64)> {
    let [Some(a), Some(b), Some(c)] = three else {
        return None;
    };
    let eyes = distance(b[36], b[45]);
    Some(([a, b, c], INTER_OCULAR / eyes.max(1.0)))
}

/// Of the landmarks as they are, and without what they do together.
fn jitter(shapes: &[Option<Shape>]) -> [Option<f64>; 2] {
    let (mut all, mut rest) = (Vec::new(), Vec::new());
    for (three, scale) in shapes.windows(3).filter_map(triple) {
        let differences = second_difference(three, scale);
        let whole = common_motion(three[1], &differences);
        rest.push(std::array::from_fn(|i| {
            [0, 1].map(|k| differences[i][k] - whole[i][k])
        }));
        all.push(differences);
    }
    [landmark_jitter(&all), landmark_jitter(&rest)]
}

/// Of landmarks that move from each frame to its neighbours as the picture does. The clip must have
/// a frame for each shape.
fn of_picture(shapes: &[Option<Shape>], clip: &str) -> Result<Option<f64>> {
    let mut source = source::open(clip, FPS)?;
    let mut frames: Vec<Luma> = Vec::new();
    let (mut moved, mut count) = (Vec::new(), 0usize);
    while let Some(picture) = source.next()? {
        count += 1;
        frames.truncate(2);
        frames.insert(0, Luma::of(&picture.upright_grey()?));
        let three = count.checked_sub(3).and_then(|k| shapes.get(k..count));
        let ([c, b, a], Some((shapes, scale))) = (&frames[..], three.and_then(triple)) else {
            continue;
        };
        moved.extend(as_in_picture(shapes, [a, b, c], scale));
    }
    ensure!(
        count == shapes.len(),
        "{clip} has {count} frames, but {} rows were written",
        shapes.len()
    );
    Ok(landmark_jitter(&moved))
}

/// The second difference of landmarks that move from the middle frame to both others as the picture
/// does.
fn as_in_picture([a, b, c]: [&Shape; 3], frames: [&Luma; 3], scale: f64) -> Option<Shape> {
    let rigid = |shape: &Shape| shape[RIGID].iter().map(|p| p.map(|v| v as f32)).collect();
    let [before, here, after]: [Vec<[f32; 2]>; 3] = [rigid(a), rigid(b), rigid(c)];
    let patch = around(&here);
    let to = |there: &[[f32; 2]], frame: &Luma| -> Option<Shape> {
        let initial = Similarity::fit(&here, there)?;
        let motion = register(frames[1], frame, &patch, initial)?;
        Some(b.map(|p| motion.apply(p.map(|v| v as f32)).map(f64::from)))
    };
    let (a, c) = (to(&before, frames[0])?, to(&after, frames[2])?);
    Some(second_difference([&a, b, &c], scale))
}

/// The patch as wide and high as these points lie around their mean.
fn around(points: &[[f32; 2]]) -> Patch {
    let n = points.len() as f32;
    let centre = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f32>() / n);
    let reach = |k: usize| {
        let far = points.iter().map(|p| (p[k] - centre[k]).abs());
        far.fold(1.0, f32::max)
    };
    Patch {
        centre,
        reach: [0, 1].map(reach),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_motion_does_not_tremble() {
        let shape = |frame: u32| -> Shape {
            std::array::from_fn(|i| {
                let x = if i == 45 { 40.0 } else { 0.0 } + 2.0 * f64::from(frame);
                [x, f64::from(frame % 2) * f64::from(u8::from(i > 30))]
            })
        };
        let shapes: Vec<Option<Shape>> = (0..6).map(|frame| Some(shape(frame))).collect();
        let jitter = jitter(&shapes)[0].expect("frames");
        assert!((jitter - 2.0).abs() < 0.05, "{jitter}");
    }
}
