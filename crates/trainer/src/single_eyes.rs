//! Pictures of single real eyes, labelled as open or shut: training samples for the lid refiner,
//! and a measure of how well its lids separate the two.
//!
//! Photographs of faces hardly ever show shut lids, and annotators place those half open; rendered
//! lids are not real. The refiners find the landmarks; where an eye is known to be shut, both lids
//! get the same landmarks. Every fifth picture is not trained on but measured.

use crate::eyes::{self, SingleEye};
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

/// Settings of `posewise-train eyes`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Folder with pictures of single eyes in `open` and `closed`, left and right.
    #[arg(long, default_value = "../shared/data/eyes")]
    pub eyes: PathBuf,
    /// The model.
    #[arg(long, default_value = "models/posewise.posewise")]
    pub model: PathBuf,
    /// Measure all pictures, of which no training saw any, in place of each fifth.
    #[arg(long)]
    pub all: bool,
    /// Width of an eye, in that of its picture.
    #[arg(long, default_value_t = eyes::WIDTH)]
    pub eye_width: f32,
    /// Write the numbers as JSON too.
    #[arg(long)]
    pub json: Option<PathBuf>,
}

/// Initial widths of an eye, and the initial height of its centre, in sides of the picture.
const WIDTHS: [f32; 4] = [0.4, 0.5, 0.6, 0.72];
const MIDDLE: f32 = 0.54;
/// Runs of the refiners, and how far the landmarks may still move in the last one, in widths of the
/// eye.
const RUNS: usize = 6;
const CONVERGED: f32 = 0.03;
/// Accepted widths of an eye, and its largest distance from the initial position, in sides.
const WIDE: std::ops::Range<f32> = 0.3..0.9;
const FAR: f32 = 0.2;
/// Landmarks of the person's right brow and right eye, and pairs of upper and lower lid.
const BROW: std::ops::Range<usize> = 17..22;
const EYE: std::ops::Range<usize> = 36..42;
const LIDS: [[usize; 2]; 2] = [[37, 41], [38, 40]];

/// Where shut lids meet, from the upper (0) to the lower lid (1).
const MEET: f32 = 0.75;
/// An eye to train on: a face of which only the person's right eye is seen, and the landmarks that
/// the refiners found.
pub struct Single {
    /// Labels; both lids at the same place where the eye is shut.
    pub face: Face,
    /// The refiners' result.
    pub found: Shape,
}

/// The pictures to train on and their mirror images, those in which this model finds the eye.
pub fn for_training(model: &AlignModel<'_>, folder: &Path) -> Result<Vec<Single>> {
    let mut all = vec![];
    for (name, shut) in [("open", false), ("closed", true)] {
        let paths = pictures(&folder.join(name), |index| !eyes::is_held_out(index))?;
        let found = find_all(model, &paths)?;
        println!("{name} eyes: {} of {} found", found.len(), 2 * paths.len());
        all.extend(found.into_iter().map(|(picture, found)| {
            let mut visible = [false; LANDMARKS];
            BROW.chain(EYE).for_each(|k| visible[k] = true);
            Single {
                face: Face {
                    person: u32::MAX,
                    visible,
                    known: visible,
                    is_single_eye: true,
                    has_exact_lids: true,
                    ..Face::new(picture, if shut { with_shut_lids(found) } else { found })
                },
                found,
            }
        }));
    }
    Ok(all)
}

fn with_shut_lids(mut shape: Shape) -> Shape {
    for [upper, lower] in LIDS {
        let (u, l) = (shape[upper], shape[lower]);
        let meet = [0, 1].map(|k| u[k] + MEET * (l[k] - u[k]));
        shape[upper] = meet;
        shape[lower] = meet;
    }
    shape
}

/// Prints how well the lids' gap and the network of single eyes separate shut eyes from open ones.
pub fn run(args: &Args) -> Result<()> {
    let bytes = std::fs::read(&args.model).with_context(|| args.model.display().to_string())?;
    let bytes = AlignedBytes::new(&bytes);
    let model = Model::load(&bytes)?;
    let (mut all, mut single) = (vec![], vec![]);
    let mut value = json!({});
    for (name, open) in [("open", true), ("closed", false)] {
        let measured = |index| args.all || eyes::is_held_out(index);
        let paths = pictures(&args.eyes.join(name), measured)?;
        for path in &paths {
            let picture = Picture::read(path)?;
            single.push(SingleEye { picture, open });
        }
        let found = find_all(model.align(), &paths)?;
        let wide = |(picture, eye): &(Picture, Shape)| extent(eye).1 / picture.size[0] as f32;
        let mut widths: Vec<f32> = found.iter().map(wide).collect();
        let mut found: Vec<f32> = found.iter().map(|(_, eye)| gap(eye)).collect();
        ensure!(!found.is_empty(), "no eye was found in {name}");
        found.sort_by(f32::total_cmp);
        widths.sort_by(f32::total_cmp);
        println!(
            "{name}: {} of {} found (each also in the mirror), \
             median width of the eye {:.3} of the picture's, gap of the lids {:.3} of the eye's",
            found.len(),
            2 * paths.len(),
            widths[widths.len() / 2],
            found[found.len() / 2]
        );
        value[name] = json!({"looked_at": 2 * paths.len(), "found": found.len(),
            "median_gap": found[found.len() / 2]});
        all.extend(found.into_iter().map(|gap| (f64::from(gap), open)));
    }
    let area = auc(&all).context("eyes of one kind only")?;
    println!("area under the ROC of the gap: {area:.3}");
    value["gap_auc"] = json!(area);
    let looked = eyes::look_single(model.eyes(), &single, args.eye_width);
    if let Some(area) = auc(&looked) {
        let share_right = |kinds: &[bool]| {
            let of = single
                .iter()
                .filter(|eye| kinds.contains(&eye.open))
                .count();
            let is_right = |(p, open): &&(f64, bool)| (*p > 0.5) == *open && kinds.contains(open);
            looked.iter().filter(is_right).count() as f32 / of as f32
        };
        let right = share_right(&[true, false]);
        println!(
            "network of single eyes: {} of {} seen, {:.1} % right (open {:.1}, shut {:.1}), \
             area under the ROC {area:.4}",
            looked.len(),
            single.len(),
            100.0 * right,
            100.0 * share_right(&[true]),
            100.0 * share_right(&[false])
        );
        value["network"] = json!({"right": right, "auc": area, "seen": looked.len()});
    }
    if let Some(path) = &args.json {
        std::fs::write(path, value.to_string()).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// Those of a folder whose numbers are wanted.
fn pictures(folder: &Path, wanted: impl Fn(usize) -> bool) -> Result<Vec<PathBuf>> {
    let chosen = (Picture::list(folder)?.into_iter().enumerate())
        .filter(|(index, _)| wanted(*index))
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

/// The lids' gap over the eye's width.
fn gap(shape: &Shape) -> f32 {
    ratio(shape, [36, 39], &LIDS)
}

/// The eye in the middle of a picture, by the initial width from which it converges best; `None`
/// where it does not converge. The other landmarks of the face are placed as in the mean face.
fn find(model: &AlignModel<'_>, picture: &Picture, work: &mut Workspace) -> Option<Shape> {
    let results = WIDTHS
        .iter()
        .filter_map(|width| converge(model, picture, *width, work));
    let (moved, shape) = results.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (moved < CONVERGED).then_some(shape)
}

/// The refiners' result from an eye of this initial width, after how far they moved last.
fn converge(
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
        let to_frame = Similarity {
            a: scale,
            b: 0.0,
            tx: at[0] - scale * centre[0],
            ty: at[1] - scale * centre[1],
        };
        mean.map(|p| to_frame.apply(p))
    };
    let [w, h] = picture.size.map(|s| s as f32);
    let initial = [0.5 * w, MIDDLE * h];
    let mut shape = face(initial, width * w);
    let mut moved = f32::MAX;
    for _ in 0..RUNS {
        let before = shape;
        if !model.run(&picture.frame(), 0, &mut shape, work) {
            return None;
        }
        let (at, wide) = extent(&shape);
        if !WIDE.contains(&(wide / w)) || distance(at, initial) > FAR * w {
            return None;
        }
        let landmarks: Vec<usize> = BROW.chain(EYE).collect();
        let moves = landmarks.iter().map(|k| distance(shape[*k], before[*k]));
        moved = moves.sum::<f32>() / landmarks.len() as f32 / wide;
        let mut next = face(at, wide);
        landmarks.iter().for_each(|k| next[*k] = shape[*k]);
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
