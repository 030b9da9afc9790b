//! Real eyes, each seen alone and known to be open or shut: do the refiners' lids tell?
//!
//! In photographs of faces lids are hardly ever shut, and the annotator leaves half open those that
//! are; rendered lids are not real. The stages find the landmarks; where an eye is known to be shut
//! its lids are laid together. Each fifth picture is kept from training, to measure on.

use crate::faces::{Face, Picture, ratio};
use anyhow::{Context, Result, ensure};
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;
use posewise::track::Model;
use posewise_format::AlignedBytes;
use posewise_metrics::auc;
use posewise_metrics::landmarks::distance;
use rayon::prelude::*;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Settings of `posewise-train eyes`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Folder with pictures of single eyes in `open` and `closed`, left and right.
    #[arg(long, default_value = "../shared/data/eyes")]
    pub eyes: PathBuf,
    /// The model.
    #[arg(long, default_value = "models/default.posewise")]
    pub model: PathBuf,
    /// Write the numbers as JSON too.
    #[arg(long)]
    pub json: Option<PathBuf>,
}

/// Widths of an eye, and the height of its middle, in sides of the picture: where to begin.
const WIDTHS: [f32; 4] = [0.4, 0.5, 0.6, 0.72];
const MIDDLE: f32 = 0.54;
/// Attempts until the stages have settled, and how far the landmarks may still move in the last
/// one, in widths of the eye.
const ATTEMPTS: usize = 6;
const SETTLED: f32 = 0.03;
/// How wide an eye may be, and how far from where it was looked for, in sides.
const WIDE: std::ops::Range<f32> = 0.3..0.9;
const FAR: f32 = 0.2;
/// The subject's right eye with its brow, the eye alone, and its upper and lower lid.
const MARKS: std::ops::Range<usize> = 17..22;
const EYE: std::ops::Range<usize> = 36..42;
const LIDS: [[usize; 2]; 2] = [[37, 41], [38, 40]];

/// Where shut lids meet on the way from the upper to the lower one.
const MEET: f32 = 0.75;
/// Each so many-th picture is kept from training.
const HELD: usize = 5;

/// An eye to train on: a face of which only the subject's right eye is seen, and where the stages
/// found its landmarks.
pub struct Single {
    /// Labels; lids laid together where the eye is shut.
    pub face: Face,
    /// What the stages say.
    pub found: Shape,
}

/// Whether only the subject's right eye is known of a face.
pub fn is_single(face: &Face) -> bool {
    face.yaw_deg.is_none() && !face.visible[42]
}

/// The pictures to train on, and their mirror images, as far as this model finds the eye.
pub fn for_training(model: &AlignModel<'_>, folder: &Path) -> Result<Vec<Single>> {
    let mut all = vec![];
    for (name, shut) in [("open", false), ("closed", true)] {
        let paths = pictures(&folder.join(name), false)?;
        let found = find_all(model, &paths)?;
        println!("{name} eyes: {} of {} found", found.len(), 2 * paths.len());
        all.extend(found.into_iter().map(|(picture, found)| {
            let mut visible = [false; LANDMARKS];
            MARKS.chain(EYE).for_each(|k| visible[k] = true);
            Single {
                face: Face {
                    picture: Arc::new(picture),
                    landmarks: if shut { laid_together(found) } else { found },
                    person: u32::MAX,
                    yaw_deg: None,
                    weight: 1.0,
                    visible,
                },
                found,
            }
        }));
    }
    Ok(all)
}

fn laid_together(mut shape: Shape) -> Shape {
    for [upper, lower] in LIDS {
        let (u, l) = (shape[upper], shape[lower]);
        let meet = [0, 1].map(|k| u[k] + MEET * (l[k] - u[k]));
        shape[upper] = meet;
        shape[lower] = meet;
    }
    shape
}

/// Prints how well the lids' gap tells shut eyes from open ones.
pub fn run(args: &Args) -> Result<()> {
    let bytes = std::fs::read(&args.model).with_context(|| args.model.display().to_string())?;
    let bytes = AlignedBytes::new(&bytes);
    let model = Model::load(&bytes)?;
    let mut all = vec![];
    let mut value = json!({});
    for (name, open) in [("open", true), ("closed", false)] {
        let paths = pictures(&args.eyes.join(name), true)?;
        let found = find_all(model.align(), &paths)?;
        let mut found: Vec<f32> = found.iter().map(|(_, eye)| gap(eye)).collect();
        ensure!(!found.is_empty(), "no eye was found in {name}");
        found.sort_by(f32::total_cmp);
        println!(
            "{name}: {} of {} found (each also in the mirror), \
             median gap of the lids {:.3} of the eye's width",
            found.len(),
            2 * paths.len(),
            found[found.len() / 2]
        );
        value[name] = json!({"looked_at": 2 * paths.len(), "found": found.len(),
            "median_gap": found[found.len() / 2]});
        all.extend(found.into_iter().map(|gap| (f64::from(gap), open)));
    }
    let area = auc(&all).context("eyes of one kind only")?;
    println!("area under the ROC of the gap: {area:.3}");
    value["gap_auc"] = json!(area);
    if let Some(path) = &args.json {
        std::fs::write(path, value.to_string()).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// Those kept from training, or the others.
fn pictures(folder: &Path, held: bool) -> Result<Vec<PathBuf>> {
    let chosen = (Picture::list(folder)?.into_iter().enumerate())
        .filter(|(index, _)| (index % HELD == HELD - 1) == held)
        .map(|(_, path)| path);
    Ok(chosen.collect())
}

/// The eyes that are found in pictures and their mirror images.
fn find_all(model: &AlignModel<'_>, paths: &[PathBuf]) -> Result<Vec<(Picture, Shape)>> {
    let found = paths
        .par_iter()
        .map_init(
            || Box::new(Workspace::new()),
            |work, path| {
                let picture = Picture::read(path)?;
                let both = [picture.mirrored(), picture];
                Ok(both.map(|picture| {
                    let eye = find(model, &picture, work)?;
                    Some((picture, eye))
                }))
            },
        )
        .collect::<Result<Vec<_>>>()?;
    Ok(found.into_iter().flatten().flatten().collect())
}

/// Centre and width of the eye.
fn extent(shape: &Shape) -> ([f32; 2], f32) {
    let eye = &shape[EYE];
    let centre = [0, 1].map(|k| eye.iter().map(|p| p[k]).sum::<f32>() / eye.len() as f32);
    (centre, distance(eye[0], eye[3]))
}

/// Of the lids, over the eye's width.
fn gap(shape: &Shape) -> f32 {
    ratio(shape, [36, 39], &LIDS)
}

/// The eye in the middle of a picture, from the beginning after which it moves least; `None` where
/// it does not settle. The landmarks of the rest of the face are the mean face's around it.
fn find(model: &AlignModel<'_>, picture: &Picture, work: &mut Workspace) -> Option<Shape> {
    let begun = WIDTHS.iter();
    let settled = begun.filter_map(|width| settle(model, picture, *width, work));
    let (moved, shape) = settled.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (moved < SETTLED).then_some(shape)
}

/// Where the refiners end that begin with an eye of this width, and how far they moved last.
fn settle(
    model: &AlignModel<'_>,
    picture: &Picture,
    width: f32,
    work: &mut Workspace,
) -> Option<(f32, Shape)> {
    let mean = model.mean();
    let (centre, unit) = extent(mean);
    // An upright face whose eye has this centre and width.
    let face = |at: [f32; 2], width: f32| {
        let scale = width / unit;
        let seat = Similarity {
            a: scale,
            b: 0.0,
            tx: at[0] - scale * centre[0],
            ty: at[1] - scale * centre[1],
        };
        mean.map(|p| seat.apply(p))
    };
    let [w, h] = picture.size.map(|s| s as f32);
    let begin = [0.5 * w, MIDDLE * h];
    let mut shape = face(begin, width * w);
    let mut moved = f32::MAX;
    for _ in 0..ATTEMPTS {
        let before = shape;
        if !model.run(&picture.frame(), 0, &mut shape, work) {
            return None;
        }
        let (at, wide) = extent(&shape);
        if !WIDE.contains(&(wide / w)) || distance(at, begin) > FAR * w {
            return None;
        }
        let marks: Vec<usize> = MARKS.chain(EYE).collect();
        let moves = marks.iter().map(|k| distance(shape[*k], before[*k]));
        moved = moves.sum::<f32>() / marks.len() as f32 / wide;
        let mut next = face(at, wide);
        marks.iter().for_each(|k| next[*k] = shape[*k]);
        shape = next;
    }
    Some((moved, shape))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_is_a_share_of_the_eye() {
        let mut shape = [[0.0; 2]; 68];
        let eye = [
            [0.0, 0.0],
            [3.0, -1.0],
            [6.0, -1.0],
            [10.0, 0.0],
            [6.0, 2.0],
            [3.0, 2.0],
        ];
        shape[EYE].copy_from_slice(&eye);
        assert!((gap(&shape) - 0.3).abs() < 1e-6);
        assert_eq!(extent(&shape).1, 10.0);
    }
}
